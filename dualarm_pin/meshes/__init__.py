"""Meshes: load, hull, triangles."""
