"""Broken inputs by seed: sound files of every kind, and what may happen to them.

`benchmarks/fuzz.py` feeds them to the program; the same seed makes the same files.
"""

from __future__ import annotations

import io
import json
import random
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

NUMBERS: list[Any] = [
    0, -1, 1, 2, 3, 0.5, 1e12, -1e12, 10**12, 10**30, 10**400, 1e-300, 1e-9, 1e308, 1e5, 1e6, 2e6,
    float("nan"), float("inf"), -float("inf"), 2**31, 2**53, 2**63, 2**64, 360, 1e-4, 7, 100_000,
]  # fmt: skip
WORDS = [
    "", " ", "a" * 300, "a" * 5000, "\x00", "\ud800", "\udfff/x", "../../..", "..", ".", "/", "~",
    "<script>alert(1)</script>", "é", "%n", "{0}", "package://", "package://../x", "package://a/../..",
    "file:///dev/zero", "/dev/zero", "/dev/stdin", "/proc/self/mem", "null", "1e999", "arm1/tip",
    "none", "spin", "small.urdf", "tip", "\n", "\u202e", "9" * 5000, "0x10", "1_000", "1:30",
    "2001-01-01", "**", "[", "a:b", "os:system", "local", "global", "free", "nan",
]  # fmt: skip
THINGS: list[Any] = [
    None, True, False, [], {}, [[]], [1, 2], [1, 2, 3], {"a": 1}, {"": {}}, ["a"] * 40,
    [[[[[[[[]]]]]]]], [0.0] * 1000, {"call": "os:system"}, {"file": "task.yaml"}, [None], [True],
    {str(k): k for k in range(200)},
]  # fmt: skip
TEXT = [
    "[", "{", "}", "]", "*x", "&x ", "*a", "&a ", "!!python/object:os.system ", "!!binary ", "!a ",
    "- ", ": ", "? ", "|", ">", "~", "<<: *a\n", "{[a]: 1}", "{{a: 1}: 2}", "? [a, b]\n: 1\n",
    "? {a: 1}\n: 1\n", "\t", "\x00", "\x85", "\u2028", "---\n", "...\n", "%YAML 1.1\n", "#", "'",
    '"', '"\\ud800"', "1e999", "0o17", ".nan", "9" * 5000, "[" * 2000, "{a: " * 600, "- " * 500,
    "a" * 4096, "<", ">", "&#0;", "&amp;", "${x}", "$(find a)", "-->", "<!--", "]]>", "]]", "<?",
    "/", "1 2 3", "nan", "inf", "-1e308", "1e-320", "G2 X1e9", "G91 ", "X99999999 ", ",", ";", "(",
]  # fmt: skip
BOMB = "a: &a [x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"{b}: &{b} [{','.join([f'*{a}'] * 9)}]\n"
    for a, b in zip("abcdefghijk", "bcdefghijkl", strict=True)
)
KEY_BOMB = "".join(
    f"? &{b} [{','.join([f'*{a}'] * 9)}]\n: {b}\n" if a else f"? &{b} [x,x,x]\n: {b}\n"
    for a, b in zip(["", *"abcdefghijk"], "abcdefghijkl", strict=True)
)
MERGE_BOMB = "a: &a {x: 1, y: 2}\n" + "".join(
    f"{b}: &{b} {{<<: [{','.join([f'*{a}'] * 9)}], {b}1: *{a}, {b}2: *{a}}}\n"
    for a, b in zip("abcdefghijk", "bcdefghijkl", strict=True)
)

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
    {"csv": {"file": "path.csv", "points": 7}}, {"gcode": {"file": "path.nc", "step": 0.05}},
    {"apt": {"file": "path.apt", "points": 9}}, {"csv": "path.csv"},
]  # fmt: skip
INDICES: list[Any] = [
    "force", {"force": {"direction": "tangent", "joint_weights": [1, 1, 1, 1]}},
    {"force": {"direction": [1, 0, 0], "task_weights": [1, 1, 1, 2, 2, 2]}, "joint_centre": 0.1},
    "yoshikawa", {"inverse_condition_number": {}}, "smallest_singular_value", "velocity",
]  # fmt: skip
TASK: dict[str, Any] = {
    "cell": CELL,
    "smoothness": {"weight": 3.0, "metric": "velocity", "per_arc_length": True},
    "two_stage": {"Gamma": 2, "smoothness": 1.5},
    "constraints": [{"above": {"frame": "arm1/tip", "z": -5}, "points": [1, 2]},
                    {"half_space": {"frame": "arm2/tip", "normal": [0, 1, 0], "offset": -3}}],
    "method": "local", "solver": "free", "module_dirs": ["."],
}  # fmt: skip
SUITE: dict[str, Any] = {
    "title": "many", "tasks": ["task.yaml", {"file": "task.yaml", "name": "again", "overrides": {
        "grid": {"smoothness.weight": [1, 2]}}}],
    "methods": ["local", {"method": "global", "effort": "quick", "starts": 3, "seeds": [1, 2]},
                {"method": "two-stage", "time_limit": 5, "name": "slow"}],
    "seeds": 2, "time_limit": 10.0,
    "overrides": {"grid": {"two_stage.smoothness": {"first": 1, "last": 2, "count": 3}},
                  "variants": [{"cell.arms.arm2.base.xyz": [1.1, 0, 0]}]},
    "gates": ["mean_index <= 5", {"gate": "objective < 9", "of": "best", "task": "*"}],
    "maps": [], "keep": "best", "limitations": ["none"],
}  # fmt: skip
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


TIMES = [1, 1, 1, 2, 4]
"""How often a file is changed: many times over it is refused for the first change it meets."""
Chance = random.Random
Maker = Callable[[Chance, Path], None]


def sound(folder: Path) -> None:
    """Write every file that another may name."""
    for name, text in {
        "small.urdf": URDF, "small.srdf": SRDF, "path.csv": CSV, "path.nc": GCODE,
        "path.apt": APT, "part.obj": OBJ, "part.dae": DAE, "flat.stl": FLAT,
        "cell.yaml": json.dumps(CELL),
        "task.yaml": json.dumps(TASK | {"path": PATHS[0], "index": "force"}),
        "suite.yaml": json.dumps(SUITE),
    }.items():  # fmt: skip
        (folder / name).write_text(text)
    (folder / "part.stl").write_bytes(binary_stl())


def places(value: Any, keys: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return where every value inside plain data stands, the whole first."""
    inside: Any = value if isinstance(value, dict) else ()
    if isinstance(value, list):
        inside = range(len(value))
    return [keys, *(place for key in inside for place in places(value[key], (*keys, key)))]


def changed(chance: Chance, data: Any, pool: list[Any], *, leaves: bool = False) -> Any:
    """Return data with one value replaced, gone, doubled, or under another key."""
    data = json.loads(json.dumps(data))
    where = places(data)[1:]
    if leaves:
        where = [p for p in where if isinstance(_at(data, p), int | float)] or where
    if not where:
        return data
    *keys, last = chance.choice(where)
    node = _at(data, keys)
    how = chance.random()
    if how < 0.1 and not leaves:
        del node[last]
    elif how < 0.2 and isinstance(node, dict) and not leaves:
        node[chance.choice(WORDS)] = node.pop(last)
    elif how < 0.25 and isinstance(node, list) and not leaves:
        node.insert(0, node[last])
    elif how < 0.5 and isinstance(node[last], int | float):
        node[last] *= chance.choice([-1, 0.5, 2, 10, 1000, 1.001])
    else:
        node[last] = chance.choice(pool)
    return data


def _at(data: Any, keys: Any) -> Any:
    for key in keys:
        data = data[key]
    return data


def edited(chance: Chance, text: str, bits: list[str] = TEXT) -> str:
    """Return text that was cut, doubled, or into which something was put."""
    for _ in range(chance.choice(TIMES)):
        lines = text.split("\n")
        at, how = chance.randint(0, len(text)), chance.randrange(6)
        if how == 0:
            text = text[:at] + text[at + chance.randint(1, 200) :]
        elif how == 1:
            text = text[:at] + chance.choice(bits) + text[at:]
        elif how == 2:
            lines.insert(chance.randrange(len(lines)), chance.choice(lines))
            text = "\n".join(lines)
        elif how == 3:
            del lines[chance.randrange(len(lines))]
            text = "\n".join(lines)
        elif how == 4 and '"' in text:
            pieces = text.split('"')
            pieces[chance.randrange(len(pieces))] = chance.choice(WORDS + bits)
            text = '"'.join(pieces)
        else:
            words = text.split(" ")
            words[chance.randrange(len(words))] = str(chance.choice(NUMBERS + WORDS))[:5000]
            text = " ".join(words)
    return text


def damaged(chance: Chance, data: bytes) -> bytes:
    """Return bytes with some flipped, cut, or filled in."""
    data = bytearray(data)
    for _ in range(chance.choice(TIMES)):
        at, how = chance.randrange(len(data) + 1), chance.randrange(4)
        if how == 0:
            data[at : at + 1] = bytes([chance.randrange(256)])
        elif how == 1:
            del data[at:]
        elif how == 2:
            data[at:at] = chance.randbytes(chance.randint(1, 50))
        else:
            data[at : at + 4] = chance.choice([b"\xff" * 4, b"\0" * 4, b"\x7f\xff\xff\xff"])
    return bytes(data)


def put(file: Path, text: str) -> None:
    """Write text; lone surrogates as the bytes that other programs leave."""
    file.write_bytes(text.encode("utf-8", "surrogatepass"))


def yaml(chance: Chance, file: Path, data: Any, pool: list[Any] | None = None) -> None:
    """Write broken YAML."""
    how = chance.random()
    if pool is not None:
        for _ in range(chance.choice(TIMES)):
            data = changed(chance, data, pool, leaves=True)
        put(file, json.dumps(data))
    elif how < 0.01:
        put(file, chance.choice([BOMB, KEY_BOMB, MERGE_BOMB]) + json.dumps(data))
    elif how < 0.65:
        for _ in range(chance.choice(TIMES)):
            data = changed(chance, data, NUMBERS + WORDS + THINGS)
        put(file, json.dumps(data, ensure_ascii=chance.random() < 0.8))
    else:
        put(file, edited(chance, json.dumps(data, indent=chance.choice([None, 1]))))


def task(chance: Chance) -> dict[str, Any]:
    """Return a sound task."""
    return TASK | {"path": chance.choice(PATHS), "index": chance.choice(INDICES)}


def make_cell(chance: Chance, folder: Path) -> None:
    """Break a cell."""
    yaml(chance, folder / "cell.yaml", CELL)


def make_task(chance: Chance, folder: Path) -> None:
    """Break a task."""
    yaml(chance, folder / "task.yaml", task(chance))


def make_number(chance: Chance, folder: Path) -> None:
    """Put absurd numbers into a task."""
    yaml(chance, folder / "task.yaml", task(chance), NUMBERS)


def make_suite(chance: Chance, folder: Path) -> None:
    """Break a suite."""
    yaml(chance, folder / "suite.yaml", SUITE, NUMBERS if chance.random() < 0.3 else None)


def make_robot(chance: Chance, folder: Path) -> None:
    """Break a URDF or an SRDF."""
    name, text = chance.choice([("small.urdf", URDF)] * 4 + [("small.srdf", SRDF)])
    if chance.random() < 0.1:
        (folder / name).write_bytes(damaged(chance, text.encode()))
    else:
        put(folder / name, edited(chance, text))


def make_mesh(chance: Chance, folder: Path) -> None:
    """Break a mesh, and let the robot use it."""
    name = chance.choice(["part.stl", "part.obj", "part.dae", "flat.stl"])
    file = folder / name
    if name == "part.stl" or chance.random() < 0.3:
        file.write_bytes(damaged(chance, file.read_bytes()))
    else:
        put(file, edited(chance, file.read_text()))
    put(folder / "small.urdf", URDF.replace("part.stl", name))


def make_path(chance: Chance, folder: Path) -> None:
    """Break a file of points, and let the task follow it."""
    kind, name = chance.choice([("csv", "path.csv"), ("gcode", "path.nc"), ("apt", "path.apt")])
    file = folder / name
    if chance.random() < 0.2:
        file.write_bytes(damaged(chance, file.read_bytes()))
    else:
        put(file, edited(chance, file.read_text()))
    given: dict[str, Any] = {"file": name}
    given |= chance.choice([{}, {"points": 9}, {"step": 0.01}]) if kind == "csv" else {"points": 9}
    put(folder / "task.yaml", json.dumps(task(chance) | {"path": {kind: given}}))


def make_result(chance: Chance, folder: Path) -> None:
    """Break a result folder; `folder / "result"` holds a sound one."""
    name = chance.choice(["result.json"] * 3 + ["trajectory.npz"] * 3 + ["task.yaml"])
    file = folder / "result" / name
    if name == "trajectory.npz":
        file.write_bytes(_arrays(chance, file.read_bytes()))
        return
    if name == "result.json" and chance.random() < 0.7:
        data = json.loads(file.read_text())
        for _ in range(chance.choice(TIMES)):
            data = changed(chance, data, NUMBERS + WORDS + THINGS)
        put(file, json.dumps(data))
    elif chance.random() < 0.5:
        file.write_bytes(damaged(chance, file.read_bytes()))
    else:
        put(file, edited(chance, file.read_text()))


def _arrays(chance: Chance, data: bytes) -> bytes:
    if chance.random() < 0.5:
        return damaged(chance, data)
    with np.load(io.BytesIO(data)) as held:
        arrays = dict(held)
    name = chance.choice(list(arrays))
    old = arrays[name]
    shape = chance.choice([(), (0,), (1,), old.shape[::-1], (*old.shape, 1), (3, 2**20), (10**6,)])
    kinds = ["f4", "i8", "U3", "S2", "c16", "M8[s]", "V4", "?", "u1", "f2", ">f8"]
    made: Any = {
        "shape": lambda: np.zeros(shape),
        "kind": lambda: np.zeros(old.shape, chance.choice(kinds)),
        "record": lambda: np.zeros(old.shape, [("a", "f8"), ("b", "U2")]),
        "bad": lambda: np.full(old.shape, chance.choice([np.nan, np.inf, 1e308, -1e308, 1e300])),
        "order": lambda: np.asfortranarray(old),
        "pickle": lambda: np.array([{"a": 1}, print], dtype=object),
    }[chance.choice(["shape", "kind", "record", "bad", "order", "pickle"])]()
    out = io.BytesIO()
    arrays[name] = made
    if chance.random() < 0.3:
        arrays.pop(chance.choice(list(arrays)))
    chance.choice([np.savez, np.savez_compressed])(out, **arrays)
    if chance.random() < 0.1:
        with zipfile.ZipFile(out, "a", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("q.npy" if chance.random() < 0.5 else "more.npy", zero_bomb(chance))
    return out.getvalue()


def zero_bomb(chance: Chance) -> bytes:
    """Return an array of zeros that a zip makes tiny."""
    head = b"\x93NUMPY\x01\x00"
    size = chance.choice([10**6, 10**7])
    text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({size}, 1), }}".ljust(117)
    return head + struct.pack("<H", len(text) + 1) + text.encode() + b"\n" + bytes(8 * size)


KINDS: dict[str, Maker] = {
    "cell": make_cell,
    "task": make_task,
    "number": make_number,
    "suite": make_suite,
    "robot": make_robot,
    "mesh": make_mesh,
    "path": make_path,
    "result": make_result,
}


def make(kind: str, seed: int, folder: Path) -> None:
    """Write the broken files of a case into a folder that `sound` has filled."""
    KINDS[kind](Chance(zlib.crc32(f"{kind} {seed}".encode())), folder)
