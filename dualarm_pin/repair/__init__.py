"""Answers that do not collide: the lowest minima of a search, moved apart by rows of pairs.

A search without rows of pairs is fast and its minima are many. Each of the lowest is measured with
convex hulls; where bodies are too near, rows hold them apart and the path is solved again from
there (`basin`), at the points and then between them. Where none of the lowest is nearly apart, a
search with capsules around the bodies (`covered`), and walks, lead near paths that are. `pool` goes
through all of them.
"""
