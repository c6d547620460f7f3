"""Generators: functions that return a `Path` from a few numbers; `path.paths` lists them."""
