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
from sound_files import CALLING, CELLS, INDICES, PATHS, REQUESTS, SECTIONS, SRDF, SUITE, TASK, URDF

HUGE = 10**300  # whole numbers beyond it become no fractions
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


TIMES = [1, 1, 1, 2, 4]
"""How often a file is changed: many times over it is refused for the first change it meets."""
Chance = random.Random
Maker = Callable[[Chance, Path], None]


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
        factor = chance.choice([-1, 0.5, 2, 10, 1000, 1.001])
        huge = isinstance(node[last], int) and abs(node[last]) > HUGE
        node[last] *= (int(factor) or 2) if huge else factor
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
    common = TASK | {"path": chance.choice(PATHS), "index": chance.choice(INDICES)}
    return common | chance.choice([{}, *SECTIONS])


def make_cell(chance: Chance, folder: Path) -> None:
    """Break a cell."""
    yaml(chance, folder / "cell.yaml", chance.choice(CELLS))


def make_task(chance: Chance, folder: Path) -> None:
    """Break a task."""
    yaml(chance, folder / "task.yaml", task(chance))


def make_number(chance: Chance, folder: Path) -> None:
    """Put absurd numbers into a task."""
    yaml(chance, folder / "task.yaml", task(chance), NUMBERS)


def make_suite(chance: Chance, folder: Path) -> None:
    """Break a suite."""
    suite = chance.choice([SUITE] * 9 + [CALLING])
    yaml(chance, folder / "suite.yaml", suite, NUMBERS if chance.random() < 0.3 else None)


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
    names = ["result.json"] * 3 + ["trajectory.npz"] * 3 + ["task.yaml"]
    break_one(chance, folder / "result", names)


def make_motion(chance: Chance, folder: Path) -> None:
    """Break a result with a motion, alternatives and costs; `folder / "moving"` holds one."""
    names = ["motion.npz"] * 3 + ["result.json"] * 2 + ["sensitivity.json", "trajectory.npz"]
    names += [f"alternatives/2/{name}" for name in ("result.json", "trajectory.npz", "task.yaml")]
    if chance.random() < 0.2:
        file = folder / "moving" / "result.json"
        data = json.loads(file.read_text())
        data["motion"] = changed(chance, data["motion"], NUMBERS + WORDS + THINGS)
        put(file, json.dumps(data))
    else:
        break_one(chance, folder / "moving", names)
    (folder / "to").write_text(chance.choice(["ros2", "moveit", "csv", "glb"]))


def make_batch(chance: Chance, folder: Path) -> None:
    """Break the rows of a batch; `folder / "batch"` holds sound ones."""
    file = folder / "batch" / "rows.jsonl"
    rows = [json.loads(line) for line in file.read_text().splitlines()]
    if chance.random() < 0.7:
        at = chance.randrange(len(rows))
        key = rows[at]["key"]
        rows[at] = changed(chance, rows[at], NUMBERS + WORDS + THINGS)
        rows[at] |= {"key": key} if chance.random() < 0.8 else {}
        put(file, "".join(json.dumps(row) + "\n" for row in rows))
    else:
        put(file, edited(chance, file.read_text()))


def make_request(chance: Chance, folder: Path) -> None:
    """Write broken requests of a design page."""
    texts = []
    for _ in range(3):
        data = changed(chance, chance.choice(REQUESTS), NUMBERS + WORDS + THINGS)
        texts.append(
            json.dumps(data) if chance.random() < 0.8 else edited(chance, json.dumps(data))
        )
    put(folder / "requests", "\n".join(text.replace("\n", " ") for text in texts))


def break_one(chance: Chance, folder: Path, names: list[str]) -> None:
    """Break one of the files  of a result."""
    name = chance.choice(names)
    file = folder / name
    if name.endswith(".npz"):
        file.write_bytes(_arrays(chance, file.read_bytes()))
        return
    if name.endswith(".json") and chance.random() < 0.7:
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
    "motion": make_motion,
    "export": make_motion,
    "batch": make_batch,
    "request": make_request,
}


def make(kind: str, seed: int, folder: Path) -> None:
    """Write the broken files of a case into a folder that `sound` has filled."""
    KINDS[kind](Chance(zlib.crc32(f"{kind} {seed}".encode())), folder)
