"""The paper's pair of NS16, its corner path, and motions to look at."""

import json
import pathlib
from functools import cache

import numpy as np
from paper_case import task

from dualarm_pin.cell import Cell
from dualarm_pin.path import Path
from dualarm_pin.relative import Relative


def pair() -> Cell:
    return task().cell


def corner(side=0.15, radius=0.01, counts=(13, 5, 13)) -> Path:
    a, b, c = counts
    straight, turn = side - radius, np.pi / 2 * np.arange(1, b + 1) / (b + 1)
    x = np.concatenate(
        [np.full(a, side), straight + radius * np.cos(turn), straight * np.linspace(1, 0, c)]
    )
    y = np.concatenate(
        [straight * np.linspace(0, 1, a), straight + radius * np.sin(turn), np.full(c, side)]
    )
    tangent = np.zeros((a + b + c, 3))
    tangent[:a, 1], tangent[a + b :, 0] = 1, -1
    tangent[a : a + b, 0], tangent[a : a + b, 1] = -np.sin(turn), np.cos(turn)
    position = np.column_stack([x, y, np.full(len(x), 0.3)])
    return Path(position, np.diag([1.0, -1, -1]), tangent=tangent, name="corner")


@cache
def motions():
    """Return three local optima of the corner (objectives 12.73, 14.54 and about 40).

    Each is q (31, 12), which meets the path to 1e-7, and its index (31,).
    """
    cell, path = pair(), corner()
    listed = json.loads((pathlib.Path(__file__).parent / "data" / "ns16_motions.json").read_text())
    return tuple(
        (q, np.array([_index(cell, x, t) for x, t in zip(q, path.tangent, strict=True)]))
        for q in np.array(listed)
    )


def _index(cell, q, tangent):
    return float(np.sum((Relative(cell, q).J_r[:3].T @ tangent) ** 2))
