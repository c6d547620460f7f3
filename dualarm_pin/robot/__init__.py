"""Robots from strangers: URDF, xacro and SRDF, found, read and checked."""
