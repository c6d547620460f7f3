"""Nodes as the bytes of a GLB file; colours are those of the page."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import trimesh
from numpy.typing import ArrayLike

from dualarm_pin.arrays import Array
from dualarm_pin.exports.glb.animation import animate
from dualarm_pin.exports.glb.nodes import ROOT, UP, Nodes
from dualarm_pin.meshes.triangles import triangles_of
from dualarm_pin.show.scene import colour_of

_LINEAR, _DARK = 12.92, 0.04045  # the curve of sRGB (IEC 61966-2-1)


def glb_bytes(nodes: Nodes, q: Array, time: Array | None) -> bytes:
    """Return the file.

    Args:
        nodes: The cell.
        q: Joints (m, n) [rad or m]; the first row is how the scene stands.
        time: When each is reached (m,) [s]; None for a posture.
    """
    scene = _scene(nodes, q[0])
    local = [nodes.local_poses(row) for row in q] if time is not None else []

    def add(buffers: dict[Any, bytes], tree: dict[str, Any]) -> None:
        _colours(tree)
        if time is not None:
            animate(buffers, tree, nodes, time, local)

    glb: bytes = trimesh.exchange.gltf.export_glb(
        scene, include_normals=True, buffer_postprocessor=add
    )
    return glb


def linear_colour(colour: ArrayLike) -> list[float]:
    """Return red, green, blue and opacity as glTF counts them, from those of a screen."""
    rgba = np.asarray(colour, dtype=float)
    bright = ((rgba[:3] + 0.055) / 1.055) ** 2.4
    return [*np.where(rgba[:3] <= _DARK, rgba[:3] / _LINEAR, bright).tolist(), float(rgba[3])]


def _scene(nodes: Nodes, q: Array) -> trimesh.Scene:
    scene = trimesh.Scene()
    scene.graph.update(frame_to=ROOT, matrix=UP.homogeneous)
    parents, known = nodes.cell.model.parents, set[str]()
    for joint, pose in enumerate(nodes.local_poses(q)):
        if joint:
            _put(scene, nodes.joints[joint], nodes.joints[parents[joint]], pose)
    for body in nodes.bodies:
        mesh = None if body.shape is None else _mesh_of(scene, body.shape, known)
        _put(scene, body.name, nodes.joints[body.joint], body.placement, mesh)
    return scene


def _put(
    scene: trimesh.Scene, name: str, parent: str, pose: pin.SE3, mesh: str | None = None
) -> None:
    scene.graph.update(frame_to=name, frame_from=parent, matrix=pose.homogeneous, geometry=mesh)


def _mesh_of(scene: trimesh.Scene, shape: pin.GeometryObject, known: set[str]) -> str | None:
    """Return the mesh of a shape by name; bodies of one file and colour share it."""
    colour = colour_of(shape)
    key = repr([shape.meshPath or shape.name, *map(float, shape.meshScale), *colour])
    if key not in known:
        surface = triangles_of(shape.geometry)
        if surface is None:
            return None
        known.add(key)
        corners = surface.origin + surface.step * surface.corners
        material = trimesh.visual.material.PBRMaterial(
            name=" ".join(map(str, colour)), baseColorFactor=linear_colour(colour)
        )
        scene.geometry[key] = trimesh.Trimesh(
            corners,
            surface.faces,
            process=False,
            visual=trimesh.visual.TextureVisuals(material=material),
        )
    return key


def _colours(tree: dict[str, Any]) -> None:
    """Write the colours into the materials; trimesh would round them to 255 steps."""
    for material in tree["materials"]:
        rgba = linear_colour([float(value) for value in material["name"].split()])
        material["pbrMetallicRoughness"] = {
            "baseColorFactor": rgba, "metallicFactor": 0.0, "roughnessFactor": 0.7,
        }  # fmt: skip
        material["doubleSided"] = True  # as on the page: URDFs hold open and inverted meshes
        material["alphaMode"] = "OPAQUE" if rgba[3] == 1.0 else "BLEND"
