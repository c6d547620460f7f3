"""Sound files of every kind: what `mutations` breaks. Together they use every key of every file."""

from __future__ import annotations

import json
import re
import struct
from pathlib import Path
from typing import Any

import numpy as np

URDF = """\
<?xml version="1.0" encoding="utf-8"?>
<robot name="small">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <link name="base"/>
  <link name="upper">
    <inertial><origin xyz="0 0 0.1" rpy="0 0 0"/><mass value="2.0"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <visual><geometry><mesh filename="part.stl" scale="1 1 1"/></geometry></visual>
    <collision><origin xyz="0 0 0.2"/><geometry><mesh filename="part.stl"/></geometry></collision>
  </link>
  <link name="fore">
    <collision><origin xyz="0 0 0.2"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision>
  </link>
  <link name="hand">
    <visual><geometry><cylinder radius="0.02" length="0.1"/></geometry>
      <material name="red"/></visual>
    <collision><geometry><cylinder radius="0.02" length="0.1"/></geometry></collision>
  </link>
  <link name="tip"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/>
    <origin xyz="0 0 0.1" rpy="0 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="10" velocity="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="fore"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="10" velocity="1"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="fore"/><child link="hand"/><origin xyz="0 0 0.4"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.2" effort="10" velocity="1"/><mimic joint="elbow" multiplier="0.1"/>
  </joint>
  <joint name="flange" type="fixed">
    <parent link="hand"/><child link="tip"/><origin xyz="0 0 0.1"/>
  </joint>
</robot>
"""
_ARM = URDF[URDF.index('  <link name="base"/>') : URDF.index("</robot>")]
_NAMES = re.compile('="(base|upper|fore|hand|tip|shoulder|elbow|slide|flange)"')
_LEFT, _RIGHT = (_NAMES.sub(rf'="{side}_\1"', _ARM) for side in "lr")
BOTH = f"""\
<robot name="both">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <link name="ground"/><link name="torso"/>
  <joint name="lift" type="prismatic">
    <parent link="ground"/><child link="torso"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.3" effort="10" velocity="1"/>
  </joint>
  {_LEFT}{_RIGHT}
  <joint name="left" type="fixed"><parent link="torso"/><child link="l_base"/></joint>
  <joint name="right" type="fixed">
    <parent link="torso"/><child link="r_base"/><origin xyz="1 0 0"/></joint>
</robot>
"""
SRDF = """\
<?xml version="1.0"?>
<robot name="small">
  <group name="arm"><chain base_link="base" tip_link="tip"/></group>
  <group name="hand"><link name="hand"/><joint name="flange"/></group>
  <disable_collisions link1="base" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="upper" link2="fore" reason="Adjacent"/>
</robot>
"""
CELL: dict[str, Any] = {
    "name": "two", "package_dirs": ["."], "lock": {}, "free": [],
    "arms": {
        "arm1": {"urdf": "small.urdf", "srdf": "small.srdf", "group": "arm",
                 "limits_deg": {"elbow": [-100, 20]}, "velocity": {"shoulder": 2.0},
                 "tool": {"xyz": [0, 0, 0.1], "rpy_deg": [0, 0, 10]}, "tool_axis": [0, 0, 1]},
        "arm2": {"urdf": "small.urdf", "tip": "tip", "acceleration_deg_s2": {"elbow": 90},
                 "base": {"xyz": [1, 0, 0], "rotation": [[0, -1, 0], [1, 0, 0], [0, 0, 1]]}},
    },
}  # fmt: skip
_FAST = dict.fromkeys(["shoulder", "elbow"], 90)
CELLS: list[dict[str, Any]] = [
    CELL,
    CELL | {"objects": {
        "table": {"box": [0.6, 1.2, 0.05], "at": {"xyz": [0.5, 0, -1], "rpy_deg": [0, 0, 9]}},
        "ball": {"sphere": 0.1, "at": {"xyz": [0, 3, 0], "rpy": [0, 0.1, 0]}},
        "post": {"cylinder": {"radius": 0.03, "length": 0.2}, "at": {"xyz": [0, -3, 0]}},
        "rod": {"capsule": {"radius": 0.03, "length": 0.2}, "on": "arm2/hand",
                "at": {"xyz": [0.3, 0, 0]}},
        "part": {"mesh": "part.stl", "scale": 0.1, "on": "arm1", "allow": ["arm1/hand", "rod"]},
    }},
    CELL | {
        "velocity_deg": _FAST, "acceleration": {"shoulder": 8.0},
        "jerk": {"shoulder": 80.0}, "torque": {"elbow": 300},
        "arms": {
            "arm1": CELL["arms"]["arm1"] | {
                "velocity": {}, "jerk_deg_s3": {"elbow": 4000}, "xacro": {"reach": 0.5},
                "controller": {"signs": {"elbow": -1}, "offsets_deg": {"shoulder": 90},
                               "coupling": {"elbow": {"shoulder": -1}}, "prefix": "left_"}},
            "arm2": CELL["arms"]["arm2"] | {
                "limits": {"shoulder": [-1, 1], "velocity_deg_s": {"shoulder": 100},
                           "jerk_deg_s3": _FAST, "torque": {"shoulder": 5}}}},
    },
    {"urdf": "both.urdf", "srdf": "both.srdf", "xacro": {"reach": True}, "free": ["lift"],
     "lock_deg": {"r_shoulder": 30}, "arms": {"arm1": {"tip": "l_tip"}, "arm2": {"tip": "r_tip"}}},
]  # fmt: skip
"""Cells that together use every key."""
PATHS: list[dict[str, Any]] = [
    {"circle": {"radius": 0.1, "points": 5, "start_deg": 10}, "free": "rotation"},
    {"corner": {"side": 0.15, "fillet": 0.01, "height": 0.3, "points": [3, 3, 3]},
     "rotation": [[1, 0, 0], [0, -1, 0], [0, 0, -1]]},
    {"corner": {"side": 0.15, "fillet": 0.01, "height": 0.3, "step": 0.05}, "rpy_deg": [0, 9, 0]},
    {"arc": {"radius": 0.1, "start_deg": 0, "stop_deg": 90, "points": 4}, "free": "spin",
     "spin_axis": [0, 0, 1]},
    {"helix": {"radius": 0.1, "turns": 2, "pitch": 0.02, "points": 9}},
    {"raster": {"width": 0.1, "depth": 0.1, "rows": 3, "step": 0.05}},
    {"sine": {"length": 0.2, "amplitude": 0.02, "periods": 2, "points": 9}},
    {"figure_eight": {"radius": 0.2, "points": 9}, "orientation": "tangent"},
    {"dome_spiral": {"radius": 0.3, "turns": 3, "points": 9}, "orientation": "normal"},
    {"tube_seam": {"radius": 0.05, "tube_radius": 0.1, "tilt_deg": 40, "points": 9}},
    {"polyline": {"vertices": [[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0]], "step": 0.02}},
    {"spline": {"through": [[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0]], "points": 7}},
    {"csv": {"file": "path.csv", "points": 7, "smooth": True}}, {"csv": "path.csv"},
    {"gcode": {"file": "path.nc", "step": 0.05, "work_offset": [0, 0, 1], "rapids": True}},
    {"apt": {"file": "path.apt", "points": 9, "stretch": 1}},
    {"circle": {"radius": 0.1, "points": 5, "center": [0, 0.1]}, "frame": {"rpy": [0, 0, 1]}},
    {"dome_spiral": {"radius": 0.3, "turns": 1, "points": 9, "inner_deg": 5, "outer_deg": 40}},
    {"polyline": {"vertices": [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]], "points": 9, "closed": True}},
]  # fmt: skip
INDICES: list[Any] = [
    "force", {"force": {"direction": "tangent", "joint_weights": [1, 1, 1, 1]}},
    {"force": {"direction": [1, 0, 0], "task_weights": [1, 1, 1, 2, 2, 2]}, "joint_centre": 0.1},
    "yoshikawa", {"inverse_condition_number": {}}, "smallest_singular_value", "velocity",
    "torque", {"call": "own:index", "direction": "path", "weight": 2},
]  # fmt: skip
TASK: dict[str, Any] = {
    "cell": CELL,
    "smoothness": {"weight": 3.0, "metric": "velocity", "per_arc_length": True},
    "two_stage": {"Gamma": 2, "smoothness": 1.5},
    "constraints": [{"above": {"frame": "arm1/tip", "z": -5}, "points": [1, 2]},
                    {"half_space": {"frame": "arm2/tip", "normal": [0, 1, 0], "offset": -3}}],
    "method": "local", "solver": "free", "module_dirs": ["."],
}  # fmt: skip
_CIRCLE = {"circle": {"radius": 0.1, "points": 5}, "free": "rotation"}
SECTIONS: list[dict[str, Any]] = [
    {
        "clearance": {
            "required": 0.02,
            "between_points": False,
            "pairs": {"arm1/fore arm2/fore": 0.05, "arm1/hand arm2/hand": "off"},
        }
    },
    {"clearance": "off"},
    {"clearance": 0.01},
    {"cell": CELLS[1], "clearance": 0.0},
    {
        "motion": {
            "law": "constant_feed",
            "feed": 0.02,
            "chord": {"mm": 0.05, "deg": 0.01},
            "rate": 0.004,
            "tool_force": 50,
            "limits": ["velocity", "torque"],
        }
    },
    {"motion": {"law": "time_optimal"}, "aim": "feed", "cell": CELLS[2]},
    {
        "placement": {
            "base2": {"x": [1.4, 3.0], "y": [-0.8, 0.8], "z": [-0.5, 0.5], "yaw_deg": [90, 270]},
            "workpiece": {"x": [-0.1, 0.1]},
            "tool2": {"length": [0, 0.1]},
            "keep_out": [{"x": [1.8, 2.2], "y": [-0.3, 0.3]}],
            "weights": {"base2.y": 0.1},
        }
    },
    {"from_posture": [0, 0, 0, 0], "to_posture": {"deg": [0, 10, 20, 30]}, "path": _CIRCLE},
    {"from_posture": {"result": "moving", "point": 2}, "path": _CIRCLE},
    {
        "constraints": [
            {"below": {"frame": "arm1/tip", "z": 5}},
            {"inside": {"frame": "arm2/tip", "box": {"x": [-5, 5], "z": [-5, None]}}},
            {
                "axis_within": {
                    "frame": "arm2/tip",
                    "axis": [0, 0, 1],
                    "of": [0, 0, -1],
                    "deg": 179,
                    "seen_from": "arm1/tip",
                }
            },
            {"joint_range": {"joint": "arm1/elbow", "deg": [-80, 10]}, "points": [1]},
        ]
    },
    {
        "smoothness": {"weight": 1, "metric": [1, 1, 1, 1]},
        "method": "two-stage",
        "two_stage": {"Gamma": [1, 3, 5]},
        "path": _CIRCLE,
    },
    {"solver": {"call": "own:descend", "steps": 60}},
]
"""What else a task may hold: together with TASK, every key."""
REFUSED = {"own:": "allow-code", "_posture": "does not lie on the path"}
"""What is rightly refused of them, and why: none of these can be sound on every path."""
SUITE: dict[str, Any] = {
    "title": "many", "tasks": ["task.yaml", {"file": "task.yaml", "name": "again", "overrides": {
        "grid": {"smoothness.weight": [1, 2]}}}],
    "methods": ["local", {"method": "global", "effort": "quick", "starts": 3, "seeds": [1, 2]},
                {"method": "two-stage", "time_limit": 5, "name": "slow", "solver": "engine"}],
    "seeds": 2, "time_limit": 10.0,
    "overrides": {"grid": {"two_stage.smoothness": {"first": 1, "last": 2, "count": 3},
                           "cell.arms.arm2.base.xyz.1": [0, 0.1]},
                  "variants": [{"cell.arms.arm2.base.xyz": [1.1, 0, 0]}]},
    "gates": ["mean_index <= 5", {"gate": "objective < 9", "of": "best", "task": "*"}],
    "maps": [{"x": "two_stage.smoothness", "y": "cell.arms.arm2.base.xyz.1", "of": "objective",
              "label_x": "x", "label_y": "y"}],
    "keep": "best", "limitations": ["none"],
}  # fmt: skip
RATED = {"acceleration_deg_s2": dict.fromkeys(["shoulder", "elbow"], 90)}
EASY: dict[str, Any] = TASK | {
    "constraints": [], "solver": "clamped",
    "cell": CELL | {"arms": {arm: CELL["arms"][arm] | RATED for arm in ("arm1", "arm2")}},
    "motion": {"limits": ["velocity", "acceleration"]},
}  # fmt: skip
"""A task that can be met, given a path of five points around the middle of the bounds."""
FEW: dict[str, Any] = {"tasks": ["easy.yaml"], "methods": ["local"], "seeds": 2, "time_limit": 60}
REQUESTS: list[dict[str, Any]] = [
    {"page": 1},
    {"page": 1, "search": True, "motion": 3, "state": {
        "smoothness": 3.0, "clearance": 0.01, "limits": {"arm1/elbow": [-1.0, 0.1]},
        "change": {"base2.x": 0.01, "base2.yaw": 0.02, "workpiece.x": 0.001}}},
]  # fmt: skip
CALLING: dict[str, Any] = {"tasks": ["task.yaml"], "methods": [{"call": "own:plan", "options": {}}]}
"""A suite that is refused unless its code may run."""
CSV = "x,y,z,qw,qx,qy,qz,ux,uy,uz\n" + "".join(
    f"{0.05 * k},{0.01 * k * k},0.3,1,0,0,0,1,0,0\n" for k in range(6)
)
GCODE = (
    "%\nO1\nG21 G90 G17\nG0 X0 Y0 Z5\nG1 X10 F100\nG2 X20 Y10 I0 J10\nG3 X30 Y20 R10\nG1 Z9\nM30\n"
)
APT = "UNITS/MM\nMULTAX/ON\nGOTO/0,0,0,0,0,1\nGOTO/10,0,0,0,0,1\nGOTO/10,10,5,0,1,0\nFINI\n"
FLAT = "solid a\n" + "".join(
    "facet normal 0 0 1\nouter loop\n"
    + "".join(f"vertex {' '.join(map(str, p))}\n" for p in face)
    + "endloop\nendfacet\n"
    for face in (
        [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0)], [(0, 0, 0), (0.1, 0, 0), (0, 0, 0.1)],
        [(0, 0, 0), (0, 0.1, 0), (0, 0, 0.1)], [(0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)],
    )
) + "endsolid a\n"  # fmt: skip
OBJ = (
    "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\n"
    "f 1 2 3\nf 1/1 2/2 4/4\nf 1//1 3//1 4//1\nf -1 -2 -3\n"
)
DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 1 2 0 1 3 0 2 3 1 2 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n">
<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


def binary_stl() -> bytes:
    """Return a tetrahedron."""
    corners = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
    faces = [corners[list(face)] for face in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))]
    rows = [np.append(np.zeros(3), face).astype("<f4").tobytes() + b"\0\0" for face in faces]
    return bytes(80) + struct.pack("<I", 4) + b"".join(rows)


def sound(folder: Path) -> None:
    """Write every file that another may name."""
    for name, text in {
        "small.urdf": URDF, "small.srdf": SRDF, "both.urdf": BOTH,
        "both.srdf": '<robot name="both"/>', "path.csv": CSV, "path.nc": GCODE,
        "path.apt": APT, "part.obj": OBJ, "part.dae": DAE, "flat.stl": FLAT,
        "cell.yaml": json.dumps(CELL),
        "task.yaml": json.dumps(TASK | {"path": PATHS[0], "index": "force"}),
        "suite.yaml": json.dumps(SUITE),
    }.items():  # fmt: skip
        (folder / name).write_text(text)
    (folder / "part.stl").write_bytes(binary_stl())
