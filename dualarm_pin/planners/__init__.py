"""The three verbs: plan the whole path, in the paper's two stages, or locally; and peers.

Each returns a `Trajectory` that was checked with Pinocchio on the full path. `methods` names them.
"""
