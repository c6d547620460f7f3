"""Meshes: `formats` to read, `load` for Coal, `hull`, `triangles` for the eye."""
