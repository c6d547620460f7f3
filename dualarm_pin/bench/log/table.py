"""The tables of a batch: `results.parquet` and `results.csv`, written at the end, whole."""

from __future__ import annotations

import csv
import itertools
import json
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

from dualarm_pin.bench.columns import Row, flatten
from dualarm_pin.files.write import replacing

_CHUNK = 1000  # rows in memory at a time


def write_tables(folder: Path, rows: Callable[[], Iterable[Row]]) -> None:
    """Write both tables.

    Args:
        folder: Where to.
        rows: Reads the rows from the beginning; they are read twice and never all at once.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    kinds: dict[str, str] = {}
    for row in rows():
        for name, value in flatten(row).items():
            kinds[name] = _joined(kinds.get(name, "null"), _kind(value))
    types = {
        "null": pa.string(),
        "bool": pa.bool_(),
        "int": pa.int64(),
        "float": pa.float64(),
        "text": pa.string(),
        "floats": pa.list_(pa.float64()),
        "texts": pa.list_(pa.string()),
    }
    schema = pa.schema([(name, types[kind]) for name, kind in kinds.items()])
    with (
        replacing(folder / "results.parquet") as parquet,
        replacing(folder / "results.csv") as text,
        pq.ParquetWriter(parquet, schema, compression="zstd") as writer,
        text.open("w", encoding="utf-8", newline="") as file,
    ):
        lines = csv.writer(file, lineterminator="\n")
        lines.writerow(kinds)
        for chunk in _chunks(rows()):
            columns = {
                name: [_converted(row.get(name), kind) for row in chunk]
                for name, kind in kinds.items()
            }
            writer.write_table(pa.table(columns, schema=schema))
            lines.writerows([_cell(row.get(name)) for name in kinds] for row in chunk)


def _chunks(rows: Iterable[Row]) -> Iterator[list[Row]]:
    flat = (flatten(row) for row in rows)
    while chunk := list(itertools.islice(flat, _CHUNK)):
        yield chunk


def _kind(value: Any) -> str:
    if value is None:
        return "null"
    for kind in (bool, int, float):  # in this order: a bool is an int too
        if isinstance(value, kind):
            return kind.__name__
    if isinstance(value, list):
        if all(x is None or isinstance(x, int | float) for x in value):
            return "floats"
        if all(isinstance(x, str) for x in value):
            return "texts"
    return "text"


def _joined(a: str, b: str) -> str:
    """Return the kind that holds both; whatever does not fit together is text."""
    if b in (a, "null"):
        return a
    if a == "null":
        return b
    return "float" if {a, b} == {"int", "float"} else "text"


def _converted(value: Any, kind: str) -> Any:
    if kind == "text" and value is not None and not isinstance(value, str):
        return json.dumps(value)
    return float(value) if kind == "float" and value is not None else value


def _cell(value: Any) -> Any:
    return json.dumps(value) if isinstance(value, list | bool) else value
