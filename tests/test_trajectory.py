"""Result folders: what is written is read back, whole and typed; what is broken is refused."""

from __future__ import annotations

import csv
import io
import json
import struct
import zipfile
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from answers import BOUND, EVIDENCE, answer, changed, task
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dualarm_pin.answer.evidence import Evidence
from dualarm_pin.answer.folder import load_result, load_trajectory, save_result, save_trajectory
from dualarm_pin.answer.notes import NOTES, TwoStageNotes
from dualarm_pin.answer.result_json import result_json
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.errors import InputError, MissingFileError, ShapeError

OLD = Path(__file__).parent / "data" / "result_0_1_0"
REQUIRED = (
    "found method solver objective mean_index arc_mean_index max_index index max_position_error "
    "max_rotation_error max_bound_violation max_joint_step min_clearance clearance evidence timing "
    "seed versions message joints units extra"
).split()
EVIDENCE_KEYS = (
    "verdict laws missed_share_95 stationarity curvature_min active_bounds lower_bound gap details"
).split()
DETAIL_KEYS = (
    "local objective feasibility min_multiplier free_directions sigma_min near_singular "
    "return_radius return_share adopted_from_nearby limit_cost costliest_joint laws_agree "
    "unseen_share expected_better stopping_rule stopping_rule_met bound_pieces bound_cuts "
    "bound_condition bound_seconds bound_complete bound_tried bound_found_better bound_replaced "
    "bound_without_clearance piece_starts piece_hits"
).split()


def same(a: Any, b: Any) -> bool:
    """Tell whether two records hold the same, arrays and all; NaN is NaN."""
    if is_dataclass(a):
        return type(a) is type(b) and all(
            same(getattr(a, f.name), getattr(b, f.name)) for f in fields(a)
        )
    if isinstance(a, np.ndarray):
        return np.array_equal(a, b, equal_nan=True)
    return bool(a == b)


@pytest.mark.parametrize(
    "trajectory",
    [
        answer(),
        changed(answer(), clearance=None, arm_clearance=None, found=False),
        replace(answer(), evidence=Evidence(), notes=None, seed=None),
        replace(answer(), evidence=replace(EVIDENCE, bound=None)),
        replace(
            answer(),
            evidence=replace(EVIDENCE, bound=replace(BOUND, found_better=True, replaced=12.9)),
            notes=TwoStageNotes((1, 7, 31), 8.5, 6, False),
            method="two-stage",
        ),
    ],
    ids=["full", "no geometry", "bare", "no bound", "two-stage"],
)
def test_what_is_saved_is_read_back_as_the_same_typed_record(
    tmp_path: Path, trajectory: Trajectory
) -> None:
    save_result(tmp_path, task(), trajectory)
    asked, read = load_result(tmp_path)
    assert asked.smoothness == task().smoothness
    for f in fields(trajectory):
        assert same(getattr(read, f.name), getattr(trajectory, f.name)), f.name


def test_every_method_has_notes_that_are_read_back(tmp_path: Path) -> None:
    values = {"bool": True, "bool | None": True, "int": 3, "float": 0.5, "str": "quick"}
    values |= {"tuple[int, ...]": (1, 2), "tuple[float, ...]": (0.5, 2.0)}
    values |= {"dict[str, float]": {"base x": 0.5}, "tuple[str, ...]": ("yaw",)}
    for method, record in NOTES.items():
        notes = record(**{f.name: values[str(f.type)] for f in fields(record)})
        save_trajectory(tmp_path, replace(answer(), method=method, notes=notes))
        assert load_trajectory(tmp_path).notes == notes


def test_result_json_holds_every_key_scripts_rely_on() -> None:
    result = result_json(answer())
    assert not [key for key in REQUIRED if key not in result]
    assert list(result["evidence"]) == EVIDENCE_KEYS
    assert not [key for key in DETAIL_KEYS if key not in result["evidence"]["details"]]
    details = result["evidence"]["details"]
    assert details["local"] == "strict_minimum"
    assert details["bound_cuts"] == [11, 21]
    assert details["bound_tried"] == [{"cuts": [11, 21], "bound": 12.7308}]
    assert details["bound_contradicted"] is False
    assert result["extra"]["evidence_text"] == "Best of\n 9 starts."
    assert result["extra"]["effort"] == "quick"
    assert len(result["extra"]["smallest_singular_value"]) == 31
    assert result["min_clearance"] == min(result["clearance"])
    assert result["min_arm_clearance"] == min(result["extra"]["arm_clearance"])
    worst = result["clearance"].index(result["min_clearance"])
    assert result["closest_pair"] == result["checked"]["clearance_pairs"][worst]
    assert result["max_position_error"] == max(result["checked"]["position_error"])


def test_a_wrong_bound_keeps_its_negative_gap(tmp_path: Path) -> None:
    wrong = replace(answer(), evidence=replace(EVIDENCE, bound=replace(BOUND, value=13.0)))
    save_trajectory(tmp_path, wrong)
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["evidence"]["gap"] == pytest.approx((12.7308877 - 13.0) / 12.7308877)
    assert result["evidence"]["details"]["bound_contradicted"] is True
    read = load_trajectory(tmp_path).evidence.bound
    assert read is not None
    assert read.contradicted


def test_a_folder_of_the_version_before_is_read_as_the_same_record(tmp_path: Path) -> None:
    """Written by 0.1.0 on the paper's task: `solve --effort thorough`, two arms of the NS16."""
    read = load_trajectory(OLD)
    before = json.loads((OLD / "result.json").read_text())
    after = result_json(read)
    for key in ("details", *EVIDENCE_KEYS):
        old = before["evidence"][key]
        new = after["evidence"][key]
        if key == "details":
            new = {name: new[name] for name in old}
        assert new == (pytest.approx(old) if key == "gap" else old), key
    assert after["arc_mean_index"] == pytest.approx(before["arc_mean_index"])
    for key in set(REQUIRED) - {"evidence", "arc_mean_index", "extra"}:
        assert after[key] == before[key], key
    assert before["extra"].items() <= after["extra"].items()
    assert read.evidence.bound is not None
    assert read.notes == NOTES["global"]("thorough", False)
    assert read.checked.clearance is not None
    assert read.checked.clearance.closest is None  # it did not keep the pairs
    save_trajectory(tmp_path, read)
    assert same(load_trajectory(tmp_path).checked, read.checked)


def test_what_is_not_finite_is_null_never_nan(tmp_path: Path) -> None:
    save_trajectory(tmp_path, changed(answer(), objective=float("nan")))
    text = (tmp_path / "result.json").read_text()
    assert "NaN" not in text
    assert json.loads(text)["objective"] is None
    assert np.isnan(load_trajectory(tmp_path).objective)


def test_the_csv_has_the_documented_header_and_exact_numbers(tmp_path: Path) -> None:
    trajectory = replace(answer(), joints=("arm2/b,c", *answer().joints[1:]))
    save_trajectory(tmp_path, trajectory)
    with (tmp_path / "trajectory.csv").open(newline="") as file:
        header, *rows = list(csv.reader(file))
    assert header == ["point", "arc_length", *trajectory.joints, "index"]
    np.testing.assert_array_equal(np.array(rows, float)[:, 2:-1], trajectory.q)
    assert [row[0] for row in rows[:3]] == ["1", "2", "3"]


def test_the_npz_holds_no_pickle(tmp_path: Path) -> None:
    save_trajectory(tmp_path, answer())
    with np.load(tmp_path / "trajectory.npz", allow_pickle=False) as arrays:
        assert set(arrays) == {"q", "index", "arc_length", "joints"}


def test_nothing_is_written_when_packing_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*args: object, **kwargs: object) -> None:
        raise RuntimeError("memory")

    monkeypatch.setattr(np, "savez", fail)
    with pytest.raises(RuntimeError):
        save_result(tmp_path, task(), answer())
    assert not list(tmp_path.iterdir())


def test_a_folder_without_a_result_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MissingFileError, match=r"result\.json: no such file: give the folder"):
        load_trajectory(tmp_path)


def test_a_result_of_another_task_is_refused(tmp_path: Path) -> None:
    joints = ("other", *answer().joints[1:])
    save_result(tmp_path, task(), replace(answer(), joints=joints))
    with pytest.raises(InputError, match=r"result\.json: it answers another task"):
        load_result(tmp_path)


def test_arrays_that_do_not_belong_together_are_refused() -> None:
    with pytest.raises(ShapeError, match=r"q: shape \(31, 12\) is expected; given \(31, 5\)"):
        replace(answer(), q=answer().q[:, :5])
    with pytest.raises(ShapeError, match=r"index: \(31,\) is expected; given \(30,\)"):
        changed(answer(), index=np.zeros(30))
    with pytest.raises(InputError, match="q: point 3 is not finite"):
        q = answer().q.copy()
        q[2, 1] = np.nan
        replace(answer(), q=q)


# ---- damaged and strange results: one InputError each, never a traceback


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("result")
    save_trajectory(folder, replace(answer(), evidence=EVIDENCE))
    return folder


def refused_or_read(folder: Path) -> str:
    """Return the message of the one error that loading, writing and reading may raise."""
    try:
        result_json(load_trajectory(folder))
    except InputError as error:
        return str(error)
    return ""


def places(value: Any, keys: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return where every value inside JSON stands; of a list the first alone."""
    found = [keys]
    inside: Any = value if isinstance(value, dict) else ()
    if isinstance(value, list):
        inside = range(min(1, len(value)))
    for key in inside:
        found += places(value[key], (*keys, key))
    return found


STRANGE = [
    None, True, -1, 10**4000, 0.5, "3", [], [[]], {"a": {"b": []}}, ["a"] * 31, [0.0] * 31,
]  # fmt: skip


def test_any_value_of_another_type_is_one_message(folder: Path) -> None:
    """Every place of result.json times every kind of value; a missing key too."""
    file = folder / "result.json"
    whole = file.read_text()
    refused = 0
    try:
        for keys in places(json.loads(whole))[1:]:
            for value in (*STRANGE, "delete"):
                content = json.loads(whole)
                node = content
                for key in keys[:-1]:
                    node = node[key]
                if value == "delete":
                    del node[keys[-1]]
                else:
                    node[keys[-1]] = value
                file.write_text(json.dumps(content))
                message = refused_or_read(folder)
                assert not message or message.startswith(str(file)), (keys, value)
                refused += bool(message)
    finally:
        file.write_text(whole)
    assert refused > 300


@pytest.mark.parametrize(
    "text",
    [b"", b"{", b"[]", b"{}", b'{"evidence": 3}', b"\xff\xfe", b'{"found": "\\ud800"}',
     b"[" * 100_000, b'{"a": ' * 5000, b"nan", b"1" * 100_000],
)  # fmt: skip
def test_what_is_no_result_is_refused_with_its_name(folder: Path, text: bytes) -> None:
    file = folder / "result.json"
    whole = file.read_bytes()
    try:
        file.write_bytes(text)
        assert refused_or_read(folder).startswith(f"{file}: ")
    finally:
        file.write_bytes(whole)


def archive(**arrays: Any) -> bytes:
    data = io.BytesIO()
    np.savez(data, **arrays)
    return data.getvalue()


def lying(text: str) -> bytes:
    """Return an archive whose q claims the shape or type `text`."""
    data = io.BytesIO()
    header = text.encode().ljust(117) + b"\n"
    with zipfile.ZipFile(data, "w") as file:
        file.writestr("q.npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header)
    return data.getvalue()


Q, S = np.zeros((31, 12)), np.zeros(31)


@pytest.mark.parametrize(
    "data",
    [
        b"", b"PK not an archive", archive(q=Q), archive(q=Q, index=S),
        archive(q=np.float64(3), index=S, arc_length=S),
        archive(q=Q.astype(str), index=S, arc_length=S),
        archive(q=Q.astype(complex), index=S, arc_length=S),
        archive(q=Q[:, :3], index=S, arc_length=S), archive(q=Q, index=S[:30], arc_length=S),
        archive(q=Q[:0], index=S[:0], arc_length=S[:0]),
        archive(q=np.full_like(Q, np.nan), index=S, arc_length=S),
        archive(q=Q, index=S, arc_length=S * np.nan),
        lying("{'descr': '<f8', 'fortran_order': False, 'shape': (10**11, 12), }"),
        lying("{'descr': '<f8', 'fortran_order': False, 'shape': (100000000000, 12), }"),
        lying("{'descr': '|O', 'fortran_order': False, 'shape': (31, 12), }"), lying("((((("),
    ],
)  # fmt: skip
def test_strange_arrays_are_one_message(folder: Path, data: bytes) -> None:
    file = folder / "trajectory.npz"
    whole = file.read_bytes()
    try:
        file.write_bytes(data)
        assert refused_or_read(folder).startswith(str(folder))
    finally:
        file.write_bytes(whole)


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.sampled_from(["result.json", "trajectory.npz"]), st.data())
def test_a_byte_flipped_or_an_end_cut_is_no_traceback(
    folder: Path, name: str, data: st.DataObject
) -> None:
    file = folder / name
    whole = file.read_bytes()
    at = data.draw(st.integers(0, len(whole) - 1))
    damaged = bytearray(whole)
    damaged[at] = data.draw(st.integers(0, 255))
    try:
        file.write_bytes(bytes(damaged) if data.draw(st.booleans()) else whole[:at])
        refused_or_read(folder)
    finally:
        file.write_bytes(whole)
