"""Small modules written for one compiled function each, so that numba keeps its machine code.

They lie in the user's cache folder under a name made from what they hold and depend on: a change of
either is another module, and nothing is ever overwritten by other contents.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
import tempfile
import threading
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import numba

_ONE_TIME = (1, 1)  # s: numba compares times, and two processes may write the same file
_MAKING = threading.RLock()  # a module that another thread still runs has no entry yet


def kept_module(text: str, depends_on: Iterable[bytes], **given: Any) -> Any:
    """Return the module of this text, written once.

    Args:
        text: Its source.
        depends_on: Whatever else makes it another module when it changes: sources it imports from.
        **given: What it finds among its globals when it is first run in this process.
    """
    digest = hashlib.sha256(text.encode())
    for part in depends_on:
        digest.update(hashlib.sha256(part).digest())
    name = f"function_{digest.hexdigest()[:20]}"
    with _MAKING:
        return _module(name, text, given)


def _module(name: str, text: str, given: dict[str, Any]) -> Any:
    if name in sys.modules:
        return sys.modules[name]
    file = _folder() / f"{name}.py"
    if not file.exists():
        # Written whole under another name first: another process may be reading it.
        with tempfile.NamedTemporaryFile("w", dir=file.parent, suffix=".tmp", delete=False) as new:
            new.write(text)
        os.utime(new.name, _ONE_TIME)
        Path(new.name).replace(file)
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    vars(module).update(given)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]  # the next call tries again
        raise
    return module


@cache
def _folder() -> Path:
    """Return a folder of the user's for compiled functions, or one of this process."""
    chosen = getattr(numba.config, "CACHE_DIR", "")
    folder = Path(chosen) if chosen else Path.home() / ".cache" / "dualarm_pin"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError:
        return Path(tempfile.mkdtemp(prefix="dualarm_pin"))
