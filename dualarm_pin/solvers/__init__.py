"""Solvers, one file each: a solver takes a `Problem` and a start and returns a `Solution`."""
