"""Laws of starts, each one file with the face of `law.Law`, and the workers that run starts."""
