"""Distances of meshes as they are, which Coal knows as surfaces: what is inside one has met it.

A point is inside a closed mesh where the mesh is all around it: its winding number, the sum of the
solid angles of the triangles over that of the sphere, is 1 there and 0 outside.
"""

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array

_AROUND = 0.99  # of the sphere; an open bin leaves more of it free wherever a part lies in it
_NO_ANGLE = 1e-300  # keeps a triangle through the point out of 0 / 0
_FREE = 2  # of the six rays along the axes: so many that meet no triangle end outside


class Solids:
    """The bodies of a model with meshes as they are.

    Args:
        bodies: They and their pairs.
    """

    def __init__(self, bodies: pin.GeometryModel) -> None:
        self._shapes = [thing.geometry for thing in bodies.geometryObjects]
        self._pairs = [(pair.first, pair.second) for pair in bodies.collisionPairs]
        self._corners: dict[int, Array] = {}
        self._triangles: dict[int, Array] = {}
        self._boxes: dict[int, tuple[Array, Array]] = {}
        self._extents: dict[int, tuple[Array, Array]] = {}

    def distance(
        self, pair: int, scene: pin.GeometryData, hulls: float, most: float = np.inf
    ) -> coal.DistanceResult:
        """Return the distance of a pair, 0 or less where the two meet.

        Args:
            pair: Which.
            scene: Where the bodies are.
            hulls: The distance of their hulls [m]: bodies whose hulls are apart are not inside.
            most: A distance of `most` or more is given as `most`, without points; that is faster.
        """
        ends = self._pairs[pair]
        shapes, poses = [self._shapes[k] for k in ends], [scene.oMg[k] for k in ends]
        placed = [coal.Transform3s(pose.rotation, pose.translation) for pose in poses]
        result = coal.DistanceResult()
        if most < np.inf:
            result.min_distance = most
        coal.distance(shapes[0], placed[0], shapes[1], placed[1], coal.DistanceRequest(), result)
        if result.min_distance > 0.0 >= hulls and (
            self._holds(ends, poses) or self._holds(ends[::-1], poses[::-1])
        ):
            result.min_distance = 0.0
        return result

    def triangles(self, pair: int) -> int:
        """Return how many triangles the meshes of a pair have together."""
        shapes = [self._shapes[k] for k in self._pairs[pair]]
        return sum(int(shape.num_tris) for shape in shapes if _is_mesh(shape))

    def _holds(self, ends: tuple[int, int], poses: list[pin.SE3]) -> bool:
        """Tell whether a point of the second body is inside the mesh of the first."""
        outer, inner = ends
        if not _is_mesh(self._shapes[outer]):
            return False  # Coal knows these as solids
        point = np.zeros(3)  # the middle of a shape that is no mesh
        if _is_mesh(self._shapes[inner]):
            point = self._corners_of(inner)[0]
        point = poses[0].actInv(poses[1].act(point))
        low, high = self._extent_of(outer)
        if np.any(point < low) or np.any(point > high):
            return False
        if self._free(outer, point) >= _FREE:
            return False
        return abs(winding(self._triangles_of(outer), point)) > _AROUND

    def _free(self, body: int, point: Array) -> int:
        """Return how many of the six rays along the axes surely meet no triangle of a mesh.

        By the boxes of the triangles: a few comparisons, where the winding number is dear.
        """
        if body not in self._boxes:
            triangles = self._triangles_of(body)
            self._boxes[body] = triangles.min(axis=1).T.copy(), triangles.max(axis=1).T.copy()
        low, high = self._boxes[body]
        within = [(low[k] <= point[k]) & (point[k] <= high[k]) for k in range(3)]
        free = 0
        for k in range(3):
            on_line = within[k - 2] & within[k - 1]
            free += not np.any(high[k][on_line] >= point[k])
            free += not np.any(low[k][on_line] <= point[k])
        return free

    def _extent_of(self, body: int) -> tuple[Array, Array]:
        if body not in self._extents:
            corners = self._corners_of(body)
            self._extents[body] = corners.min(axis=0), corners.max(axis=0)
        return self._extents[body]

    def _corners_of(self, body: int) -> Array:
        if body not in self._corners:
            self._corners[body] = np.array(self._shapes[body].vertices())
        return self._corners[body]

    def _triangles_of(self, body: int) -> Array:
        if body not in self._triangles:
            shape = self._shapes[body]
            triangles = [shape.tri_indices(k) for k in range(shape.num_tris)]
            self._triangles[body] = self._corners_of(body)[[[t[0], t[1], t[2]] for t in triangles]]
        return self._triangles[body]


def winding(triangles: Array, point: Array) -> float:
    """Return how often a mesh of triangles (t, 3, 3) goes around a point (3,).

    The solid angle of each as of van Oosterom and Strackee (1983).
    """
    a, b, c = (triangles[:, corner] - point for corner in range(3))
    la, lb, lc = (np.sqrt(np.einsum("ij,ij->i", one, one)) for one in (a, b, c))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    flat = la * lb * lc + _NO_ANGLE
    for one, two, length in ((a, b, lc), (b, c, la), (c, a, lb)):
        flat += np.einsum("ij,ij->i", one, two) * length
    return float(np.sum(np.arctan2(volume, flat)) / (2.0 * np.pi))


def _is_mesh(shape: coal.CollisionGeometry) -> bool:
    return isinstance(shape, coal.BVHModelOBBRSS)
