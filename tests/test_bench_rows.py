"""The log of a batch and its tables."""

import csv
import json
import subprocess
import sys

import pytest

from dualarm_pin.bench.columns import flatten
from dualarm_pin.bench.log.rows import RowLog
from dualarm_pin.bench.log.table import write_tables
from dualarm_pin.errors import InputError


def test_rows_are_there_when_the_log_is_opened_again(tmp_path):
    file = tmp_path / "deep" / "rows.jsonl"
    with RowLog(file) as log:
        log.append([{"key": "a", "x": 1}, {"key": "b", "x": "ü\n"}])
        log.append([{"key": "a", "x": 2}])
    with RowLog(file) as log:
        assert "a" in log and "c" not in log and len(log) == 2
        assert list(log.rows(["b", "a"])) == [{"key": "b", "x": "ü\n"}, {"key": "a", "x": 1}]


@pytest.mark.parametrize("cut", range(1, 21))
def test_a_cut_last_line_is_removed_wherever_it_was_cut(tmp_path, cut):
    file = tmp_path / "rows.jsonl"
    whole = b'{"key":"a","x":1}\n'
    line = b'{"key":"b","x":12345}\n'
    file.write_bytes(whole + line[:cut])
    with RowLog(file) as log:
        assert "a" in log and "b" not in log
        log.append([{"key": "c"}])
    assert [json.loads(x)["key"] for x in file.read_bytes().splitlines()] == ["a", "c"]


def test_a_line_that_is_no_row_in_the_middle_is_refused(tmp_path):
    file = tmp_path / "rows.jsonl"
    file.write_bytes(b'{"key":"a"}\nnonsense\n{"key":"b"}\n')
    with pytest.raises(InputError, match=r"rows.jsonl:2: not a row of a batch"):
        RowLog(file)


def test_one_batch_at_a_time_writes_a_log(tmp_path):
    file = tmp_path / "rows.jsonl"
    code = f"""
import pathlib
from dualarm_pin.bench.log.rows import RowLog
try:
    RowLog(pathlib.Path({str(file)!r}))
except ValueError as error:
    print(error)
"""
    with RowLog(file):
        other = subprocess.run(
            [sys.executable, "-c", code], check=True, capture_output=True, text=True
        )
    assert "another batch is writing into this folder" in other.stdout
    with RowLog(file):
        pass


def test_tables_hold_every_row_and_column(tmp_path):
    pq = pytest.importorskip("pyarrow.parquet")
    rows = [
        {"key": "a", "found": True, "objective": 1, "timing": {"wall_s": 0.5}, "index": [1.0, 2.0]},
        {"key": "b", "found": False, "objective": 1.5, "evidence": {"details": {"x": 1}}},
        {"key": "c", "found": False, "reason": 'crashed, "twice"\n', "index": [None, 3]},
        {"key": "d", "odd": 1},
        {"key": "e", "odd": "text"},
    ]
    write_tables(tmp_path, lambda: iter(rows))
    table = pq.read_table(tmp_path / "results.parquet").to_pylist()
    assert [row["key"] for row in table] == list("abcde")
    assert table[0]["timing.wall_s"] == 0.5 and table[1]["timing.wall_s"] is None
    assert [row["objective"] for row in table[:2]] == [1.0, 1.5]
    assert table[0]["index"] == [1.0, 2.0] and table[2]["index"] == [None, 3.0]
    assert json.loads(table[1]["evidence.details"]) == {"x": 1}
    assert [row["odd"] for row in table[3:]] == ["1", "text"]
    with (tmp_path / "results.csv").open(newline="") as file:
        text = list(csv.DictReader(file))
    assert list(text[0]) == list(table[0])
    assert text[2]["reason"] == 'crashed, "twice"\n'
    assert json.loads(text[0]["index"]) == [1.0, 2.0] and text[1]["index"] == ""


def test_flat_columns_are_those_of_result_json():
    flat = flatten({"evidence": {"verdict": "x", "laws": {"anchored": {"starts": 3}}}, "extra": {}})
    assert flat == {"evidence.verdict": "x", "evidence.laws.anchored.starts": 3, "extra": "{}"}
