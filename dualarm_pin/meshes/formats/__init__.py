"""Mesh formats: how each is read."""
