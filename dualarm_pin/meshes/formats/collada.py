"""Read Collada (DAE) meshes: the triangles of the scene, in metres."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from dualarm_pin.arrays import Array, Integers
from dualarm_pin.robot.xml import parse_xml

Part = tuple[Array, Integers]
_MOST = 20_000_000  # corners of all instances together


def read_collada(raw: bytes, path: Path) -> Part:
    """Return corners (m, 3) [m] and triangles (k, 3).

    The up-axis is left alone, as all URDF tools do.

    Raises:
        ValueError: It is damaged (an `InputError` where it is not XML).
    """
    root = parse_xml(raw, path, huge=True)
    for element in root.iter():
        if isinstance(element.tag, str):
            element.tag = element.tag.rpartition("}")[2]
    if root.tag != "COLLADA":
        raise ValueError(f"<{root.tag}> is not the root of a Collada file")
    names = {element.get("id"): element for element in root.iter() if element.get("id")}
    unit = root.find("asset/unit")
    metre = float(unit.get("meter", "1")) if unit is not None else 1.0
    scene = root.find("scene/instance_visual_scene")
    if scene is None:
        raise ValueError("the Collada file has no scene")
    parts: list[Part] = []
    geometries: dict[str, list[Part]] = {}
    budget = _MOST
    for url, pose in _instances(names, _named(names, scene), np.diag([metre] * 3 + [1.0]), 0):
        if url not in geometries:
            geometries[url] = list(_parts(names, names[url])) if url in names else []
        for points, triangles in geometries[url]:
            budget -= len(points)
            if budget < 0:
                raise ValueError("the Collada scene is too large")
            parts.append((points @ pose[:3, :3].T + pose[:3, 3], triangles))
    if not parts:
        raise ValueError("the Collada scene shows no triangles")
    shifts = np.cumsum([0, *(len(points) for points, _ in parts)])
    corners = np.concatenate([points for points, _ in parts])
    faces = [part[1] + shift for part, shift in zip(parts, shifts, strict=False)]
    return corners, np.concatenate(faces)


def _named(names: dict[str, Any], element: Any) -> Any:
    target = names.get(element.get("url", "").removeprefix("#"))
    if target is None:
        raise ValueError(f"{element.get('url')!r} does not exist in the Collada file")
    return target


def _instances(
    names: dict[str, Any], node: Any, pose: Array, depth: int
) -> Iterator[tuple[str, Array]]:
    """Yield the geometry and pose of every instance at and below a node."""
    if depth > 50:
        raise ValueError("the nodes of the Collada scene are nested too deeply")
    for child in node:
        if child.tag in ("matrix", "translate", "rotate", "scale"):
            pose = pose @ _transform(child)
    for child in node:
        if child.tag == "instance_geometry":
            yield child.get("url", "").removeprefix("#"), pose
        elif child.tag == "node":
            yield from _instances(names, child, pose, depth + 1)
        elif child.tag == "instance_node":
            yield from _instances(names, _named(names, child), pose, depth + 1)


def _transform(element: Any) -> Array:
    values = _floats(element)
    pose = np.eye(4)
    if element.tag == "matrix":
        return values.reshape(4, 4)
    if element.tag == "translate":
        pose[:3, 3] = values
    elif element.tag == "scale":
        pose[:3, :3] = np.diag(values)
    else:
        x, y, z = values[:3] / max(float(np.linalg.norm(values[:3])), 1e-300)
        c, s = math.cos(math.radians(values[3])), math.sin(math.radians(values[3]))
        K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        pose[:3, :3] = np.eye(3) + s * K + (1 - c) * K @ K
    return pose


def _parts(names: dict[str, Any], geometry: Any) -> Iterator[Part]:
    """Yield the corners and triangles of a geometry, one pair for each primitive element."""
    for element in geometry.iterfind("mesh/*"):
        if element.tag not in ("triangles", "polylist", "polygons"):
            continue
        inputs = element.findall("input")
        stride = max((int(each.get("offset", "0")) for each in inputs), default=0) + 1
        corner = next((each for each in inputs if each.get("semantic") == "VERTEX"), None)
        if corner is None or not 0 < stride < 100:
            raise ValueError("a Collada mesh has no corners")
        points = _positions(names, corner)
        offset = int(corner.get("offset", "0"))
        lists = [_integers(p).reshape(-1, stride)[:, offset] for p in element.findall("p")]
        indices = np.concatenate(lists) if lists else np.zeros(0, dtype=np.int64)
        if element.tag == "triangles":
            triangles = indices.reshape(-1, 3)
        else:
            counts = element.find("vcount")
            sizes = [len(p) for p in lists] if counts is None else _integers(counts)
            triangles = _fans(indices, np.array(sizes, dtype=np.int64))
        if len(triangles) and not (triangles.min() >= 0 and triangles.max() < len(points)):
            raise ValueError("a triangle names a corner that does not exist")
        yield points, triangles


def _positions(names: dict[str, Any], corner: Any) -> Array:
    vertices = names.get(corner.get("source", "").removeprefix("#"))
    inputs = [] if vertices is None else vertices.findall("input")
    where = next((each for each in inputs if each.get("semantic") == "POSITION"), None)
    source = None if where is None else names.get(where.get("source", "").removeprefix("#"))
    values = None if source is None else source.find("float_array")
    if source is None or values is None:
        raise ValueError("a Collada mesh has no corners")
    accessor = source.find("technique_common/accessor")
    stride = 3 if accessor is None else int(accessor.get("stride", "3"))
    if not 3 <= stride < 100:
        raise ValueError(f"a Collada source has a stride of {stride}")
    return _floats(values).reshape(-1, stride)[:, :3]


def _fans(indices: Integers, sizes: Integers) -> Integers:
    """Return the triangles (k, 3) of polygons of these sizes, each as a fan."""
    if (sizes < 0).any() or sizes.sum() != len(indices):
        raise ValueError("the polygons of a Collada mesh do not add up")
    starts = np.cumsum(sizes) - sizes
    steps = np.maximum(sizes - 2, 0)
    first = np.repeat(starts, steps)
    step = np.arange(steps.sum()) - np.repeat(np.cumsum(steps) - steps, steps) + 1
    return np.column_stack([indices[first], indices[first + step], indices[first + step + 1]])


def _floats(element: Any) -> Array:
    return np.array((element.text or "").split(), dtype=float)


def _integers(element: Any) -> Integers:
    return np.array((element.text or "").split(), dtype=np.int64)
