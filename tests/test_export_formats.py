"""Formats by themselves: what is written, what is read back, and that no name breaks a syntax."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dualarm_pin.exports import FORMATS, Format, Points, Program, fanuc, pdl2, rapid
from dualarm_pin.exports.names import comment, identifier

GOLDEN = Path(__file__).parent / "data" / "programs"
JOINTS = tuple(f"arm{a}/joint_{k}" for a in (1, 2) for k in range(1, 7))
ARMS = {"arm1": slice(0, 6), "arm2": slice(6, 12)}
BOTH = pytest.mark.parametrize("target", FORMATS.values(), ids=list(FORMATS))


def program(
    values: np.ndarray, time: np.ndarray, name: str = "corner", joints: tuple[str, ...] = JOINTS
) -> Program:
    n = values.shape[1]
    arms = {"arm1": ARMS["arm1"]} if n == 6 else ARMS
    rest = np.vstack([np.linspace(0.1, 0.2, n)] * (len(values) - 1) + [np.zeros(n)])
    return Program(
        name,
        tuple(comment(f"task {name}")),
        joints[:n],
        tuple(joint.replace("/", "_") for joint in joints[:n]),
        arms,
        Points(values, time, rest, -rest),
    )


def times_of(target: Format, count: int) -> np.ndarray:
    step = 0.12 if target.period is None else target.period
    return step * np.arange(count)


def written_points(target: Format, values: np.ndarray, **more: object) -> tuple[Program, Points]:
    made = program(values, times_of(target, len(values)), **more)
    return made, target.read(target.write(made))


@BOTH
def test_a_small_program_looks_as_it_always_did(target: Format) -> None:
    values = np.arange(36.0).reshape(3, 12) / 8.0 - 2.0
    files = target.write(program(values, times_of(target, 3)))
    golden = {file.name: file.read_text() for file in (GOLDEN / target.name).iterdir()}
    golden |= {name: text for name, text in files.items() if name.endswith(".py")}
    assert files == golden


@BOTH
@settings(max_examples=25, deadline=None)
@given(
    values=st.lists(
        st.lists(st.floats(-400.0, 400.0), min_size=12, max_size=12), min_size=2, max_size=5
    ),
    name=st.text(max_size=60),
    joint=st.text(max_size=20),
)
def test_what_is_written_reads_back_whatever_things_are_called(
    target: Format, values: list[list[float]], name: str, joint: str
) -> None:
    joints = tuple(f"{each}{joint}" for each in JOINTS)
    q = np.array(values)
    made, read = written_points(target, q, name=name, joints=joints)
    assert np.abs(read.values - q).max() < 6e-5
    if target.name != "pdl2":
        assert np.abs(read.time - made.time).max() < 1e-4
    if target.between == "quintic":
        assert np.abs(read.velocity - made.points.velocity).max() < 1e-9
        assert np.abs(read.acceleration - made.points.acceleration).max() < 1e-9
    for file in target.write(made):
        assert re.fullmatch(r"[\w.]+", file, re.ASCII)


@BOTH
def test_a_name_cannot_leave_its_comment(target: Format) -> None:
    q = np.zeros((2, 12))
    plain = target.write(program(q, times_of(target, 2), "corner")).values()
    evil = 'corner\nMOVE "everything"; END # ! -- }} \u2028 &REL /END'
    files = target.write(program(q, times_of(target, 2), evil)).values()
    for before, after in zip(plain, files, strict=True):
        code = [
            [line for line in re.sub(r"da_\w+", "X", text, flags=re.IGNORECASE).splitlines()
             if "task corner" not in line and not re.match(r" *\d+:!", line)]
            for text in (before, after)
        ]  # fmt: skip
        numbered = [[re.sub(r"^ *\d+:", "", line) for line in lines] for lines in code]
        assert numbered[0] == numbered[1]
        assert after.isascii()


@BOTH
def test_one_arm_alone_needs_no_handshake(target: Format) -> None:
    q = np.linspace(0.0, 1.0, 18).reshape(3, 6)
    _, read = written_points(target, q)
    assert np.abs(read.values - q).max() < 6e-5
    text = "".join(target.write(program(q, times_of(target, 3))).values())
    for word in ("SyncMove", "SYNCCMD", "SYNCMOVE", "digital_in", "GP2", "arm2"):
        assert word not in text


@pytest.mark.parametrize(
    ("name", "module", "limit", "suffix"),
    [
        ("rapid", rapid, "_MOVES", ".mod"),
        ("fanuc", fanuc, "_LINES", ".ls"),
        ("pdl2", pdl2, "_LINES", ".pdl"),
    ],
)
def test_a_long_program_is_split_and_runs_in_order(
    name: str, module: object, limit: str, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    target, q = FORMATS[name], np.random.default_rng(0).uniform(-180.0, 180.0, (50, 12))
    whole = target.write(program(q, times_of(target, 50)))
    monkeypatch.setattr(module, limit, 9)
    made, read = written_points(target, q)
    files = target.write(made)
    assert len(files) > 5 * len(whole)
    assert max(text.count("\n") for name, text in files.items() if name not in whole) < 400
    assert np.abs(read.values - q).max() < 6e-5
    assert all(file.endswith(suffix) for file in files)


def test_rapid_waits_at_the_same_moves_and_reads_the_order_of_the_calls() -> None:
    target, q = FORMATS["rapid"], np.random.default_rng(0).uniform(-180.0, 180.0, (5, 12))
    files = dict(target.write(program(q, times_of(target, 5))))
    name = "da_corner_T_ROB2.mod"
    files[name] = files[name].replace("\\ID:=20", "\\ID:=25")
    with pytest.raises(ValueError, match="wait for each other"):
        target.read(files)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("rapid", "z1,tool0", "z2,tool0"),
        ("fanuc", "msec CNT100", "sec CNT100"),
        ("fanuc", "J3 = ", "J4 = "),
        ("krl", "A3 ", "A4 "),
        ("urscript", "gain=300)", "gain=30)"),
        ("pdl2", "  JNT(b", "  JNT(a"),
    ],
)
def test_a_move_that_cannot_be_read_is_not_passed_over(name: str, old: str, new: str) -> None:
    target, q = FORMATS[name], np.random.default_rng(0).uniform(-180.0, 180.0, (5, 12))
    files = target.write(program(q, times_of(target, 5)))
    broken = {file: text.replace(old, new, 1) for file, text in files.items()}
    assert broken != files
    with pytest.raises(ValueError, match="cannot be read"):
        target.read(broken)


def test_milliseconds_do_not_add_up() -> None:
    target, time = FORMATS["fanuc"], np.cumsum([0.0] + [0.0104] * 500)
    read = target.read(target.write(program(np.random.default_rng(0).random((501, 12)), time)))
    assert np.abs(read.time - time).max() <= 0.00051


@given(st.text(), st.integers(6, 40))
def test_an_identifier_is_one_in_every_language(text: str, longest: int) -> None:
    assert re.fullmatch(r"da_[A-Za-z0-9_]*[A-Za-z0-9]", identifier(text, longest), re.ASCII)
    assert len(identifier(text, longest)) <= longest
