"""Starts by two laws, the workers that run them, and what they came to."""
