"""Compilation is announced once, and a second process loads from disk."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

CODE = """
from dualarm_pin.engine.jit.compilation import ensure_compiled
report = ensure_compiled(print)
print(report.from_cache, report.folder, ensure_compiled(print).from_cache)
"""


@pytest.mark.slow
def test_notice_is_printed_when_compiling_and_only_then(tmp_path):
    env = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    runs = [
        subprocess.run(
            [sys.executable, "-c", CODE], env=env, capture_output=True, text=True, check=True
        )
        for _ in range(2)
    ]
    first, second = (run.stdout.splitlines() for run in runs)
    assert first[0].startswith("compiling the engine, once"), runs[0].stderr
    assert first[1].startswith("compiled in ")
    assert first[2].startswith("False ")
    assert str(tmp_path) in first[2]
    assert first[2].endswith(" True")
    assert len(first) == 3
    assert second == [first[2].replace("False", "True", 1)]
