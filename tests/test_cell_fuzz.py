"""No text, however broken, does more than raise our own error: nothing crashes, nothing hangs."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from patience import LONG
from test_bad_robots import SOUND, pair
from test_cell_files import TORSO

from dualarm_pin.cell import Cell
from dualarm_pin.errors import DualArmError
from dualarm_pin.relative import Relative

NASTY = [
    "nan", "inf", "-1e308", "1e-320", "0", "", "1 2 3", "9" * 400, "${x}", "\x00", "\x01", "é",
    "&#0;", "&#10;", "&amp;", "<", ">", '"', "/", "%n", "../..", "a" * 5000, "floating", "planar",
    "continuous", "fixed", "base", "tip", "hand", "<!--", "-->", "<![CDATA[", "]]>", "<?", "cell",
    'xmlns="x"', "package://", "file:///dev/zero", "\n", "e1", "universe", "root_joint", "base1",
]  # fmt: skip
PLACE = st.integers(0, 10_000)
EDIT = st.one_of(
    st.tuples(st.just("cut"), PLACE, st.integers(1, 200)),
    st.tuples(st.just("insert"), PLACE, st.sampled_from(NASTY)),
    st.tuples(st.just("value"), PLACE, st.sampled_from(NASTY)),
    st.tuples(st.just("line twice"), PLACE, PLACE),
    st.tuples(st.just("line gone"), PLACE, PLACE),
)


def edited(text: str, edits: list[tuple]) -> str:
    for kind, place, what in edits:
        lines = text.split("\n")
        at = place % (len(text) + 1)
        if kind == "cut":
            text = text[:at] + text[at + what :]
        elif kind == "insert":
            text = text[:at] + what + text[at:]
        elif kind == "value":
            pieces = text.split('"')
            pieces[min(len(pieces) - 1, 2 * (place % len(pieces) // 2) + 1)] = what
            text = '"'.join(pieces)
        elif kind == "line twice":
            lines.insert(what % len(lines), lines[place % len(lines)])
            text = "\n".join(lines)
        else:
            del lines[place % len(lines)]
            text = "\n".join(lines)
    return text


def use(cell: Cell) -> None:
    q = (cell.lower + cell.upper) / 2
    at = Relative(cell, q)
    assert np.isfinite(at.J_r).all()
    assert np.isfinite(at.dJ_r).all()
    assert cell.model.nq == cell.model.nv
    clearance = cell.clearance(q)
    assert clearance is None or np.isfinite(clearance.distance)


@settings(max_examples=150, deadline=None, derandomize=True)
@given(st.sampled_from([SOUND, TORSO]), st.lists(EDIT, min_size=1, max_size=3))
def test_a_mutated_robot_works_or_is_refused(text: str, edits: list[tuple]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "small.urdf"
        file.write_bytes(edited(text, edits).encode())
        try:
            twin = "twin" in text
            use(Cell.from_urdf(file, tips=("l3", "r3")) if twin else pair(file))
        except DualArmError as error:
            assert str(error)


CELL = """\
arms:
  arm1: {urdf: small.urdf, tip: tip, limits_deg: {elbow: [-10, 20]}}
  arm2: {urdf: small.urdf, tip: tip, base: {xyz: [1, 0, 0], rpy_deg: [0, 0, 90]}}
lock: {slide: 0.1}
package_dirs: [.]
"""
YAML_NASTY = [*NASTY, "[", "{", "*x", "&x", "!!python/object:os.system", "- ", ": ", "? ", "|", "~"]


@settings(max_examples=100, deadline=None, derandomize=True)
@given(st.lists(st.tuples(PLACE, st.integers(0, 20), st.sampled_from(YAML_NASTY)), max_size=3))
def test_a_mutated_cell_file_works_or_is_refused(edits: list[tuple[int, int, str]]) -> None:
    text = CELL
    for place, gone, new in edits:
        at = place % (len(text) + 1)
        text = text[:at] + new + text[at + gone :]
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "small.urdf").write_text(SOUND)
        file = Path(folder) / "cell.yaml"
        file.write_bytes(text.encode())
        try:
            use(Cell.load(file))
        except DualArmError as error:
            assert str(error)


def deep_chain(links: int) -> str:
    rows = ['<robot name="deep">', '<link name="l0"/>']
    rows += [
        f'<link name="l{k}"/><joint name="j{k}" type="fixed"><parent link="l{k - 1}"/>'
        f'<child link="l{k}"/></joint>'
        for k in range(1, links)
    ]
    rows.append(
        '<link name="tip"/><joint name="turn" type="revolute"><axis xyz="0 0 1"/>'
        f'<parent link="l{links - 1}"/><child link="tip"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
    )
    return "\n".join(rows)


BOMB = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 10))
EXTREME = {
    "deep elements": "<robot name='a'>" + "<link>" * 100_000,
    "a million attributes": "<robot " + " ".join(f'a{k}="1"' for k in range(300_000)) + "/>",
    "one long name": SOUND.replace('"fore"', '"' + "f" * 1_000_000 + '"'),
    "a long chain": deep_chain(499),
    "a chain that overflows the stack": deep_chain(20_000),
    "entity bomb": f'<!DOCTYPE r [<!ENTITY e0 "aaaaaaaaaa">{BOMB}]>\n<robot name="&e9;"/>',
    "entity bomb in UTF-16": (
        f'<?xml version="1.0" encoding="utf-16"?><!DOCTYPE r [<!ENTITY e0 "aaaaaaaaaa">{BOMB}]>'
        '<robot name="&e9;"/>'
    ),
    "a hidden DTD": f'<?a <!-- ?><!DOCTYPE r [<!ENTITY e0 "aaaaaaaaaa">{BOMB}]><robot name="&e9;"/>'
    "<!-- -->",
    "UTF-7": '<?xml version="1.0" encoding="utf-7"?>+ADw-robot/+AD4-',
    "a device": SOUND.replace('<sphere radius="0.05"/>', '<mesh filename="/dev/zero"/>'),
    "a pipe path": SOUND.replace('<sphere radius="0.05"/>', '<mesh filename="|ls.stl"/>'),
    "a name of NULs": SOUND.replace('<sphere radius="0.05"/>', '<mesh filename="&#1;.stl"/>'),
}


READ_ALL = """
import resource, sys
resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
from dualarm_pin.cell import Cell
from dualarm_pin.errors import DualArmError
for file in sys.argv[1:]:
    try:
        cell = Cell.from_urdf(file, file, tips=('tip', 'tip'))
        cell.clearance((cell.lower + cell.upper) / 2)
        print('read', flush=True)
    except DualArmError as error:
        print(ascii(str(error)[:300]), flush=True)
"""


@pytest.fixture(scope="module")
def read_all(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[str], str]:
    """Read all extreme texts in one process; return a line for each that it survived."""
    folder, files = tmp_path_factory.mktemp("extreme"), []
    for k, (case, text) in enumerate(EXTREME.items()):
        files.append(folder / f"{k}.urdf")
        files[-1].write_bytes(text.encode("utf-16" if "UTF-16" in case else "utf-8"))
    done = subprocess.run(
        [sys.executable, "-c", READ_ALL, *map(str, files)],
        capture_output=True,
        text=True,
        timeout=LONG,
        check=False,
    )
    return done.stdout.splitlines(), done.stderr[-2000:]


@pytest.mark.parametrize("case", EXTREME)
def test_extreme_text_ends_in_time_with_our_own_error_or_none(
    case: str, read_all: tuple[list[str], str]
) -> None:
    lines, complaint = read_all
    assert len(lines) > list(EXTREME).index(case), complaint
