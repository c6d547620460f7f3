"""Write files so that a reader never sees half of one, nor some of an old result and some new."""

from __future__ import annotations

import fcntl
import os
import signal
import tempfile
import threading
from collections.abc import Iterable, Iterator, Mapping, Set
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from types import FrameType

from dualarm_pin.errors import InputError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary path beside `path`, and rename it over `path` when the block ends well.

    Raises:
        InputError: The folder cannot be made or written, or the disk is full.
    """
    with _temporary(path) as temporary:
        yield temporary
        _to_disk(temporary)
        temporary.replace(path)


def write_text(path: Path, text: str) -> None:
    """Write `text` as UTF-8 to `path`, whole or not at all."""
    write_bytes(path, text.encode("utf-8"))


def write_bytes(path: Path, data: bytes) -> None:
    """Write `data` to `path`, whole or not at all."""
    write_files(path.parent, {path.name: data})


def write_files(folder: Path, files: Mapping[str, bytes], stale: Iterable[str] = ()) -> None:
    """Write files that belong together: all of them, or none.

    Each is complete on the disk before the first takes its place. Ctrl-C and SIGTERM wait until
    the last has: so a folder holds the old files or the new ones.

    Args:
        folder: Where to.
        files: Content by name; a name may lie in a subfolder, `folder/file`.
        stale: Files and subfolders that belong to the old ones, by name: gone with them, but for
            those that are written.

    Raises:
        InputError: The folder cannot be made or written, or the disk is full.
    """
    with uninterrupted(), ExitStack() as stack:
        for part in sorted({(folder / name).parent for name in files}):
            stack.enter_context(_made(part))
        places = {name: stack.enter_context(_temporary(folder / name)) for name in files}
        for name, data in files.items():
            places[name].write_bytes(data)
            _to_disk(places[name])
        for name in files:
            places[name].replace(folder / name)
        written = {folder / name for name in files}
        for name in stale:
            _remove(folder / name, written)


def _remove(place: Path, but: Set[Path]) -> None:
    """Remove a file, or what a folder holds and the folder if it is then empty.

    What cannot be removed stays: the new files stand, and none of them names it.
    """
    with suppress(OSError):
        if place.is_dir() and not place.is_symlink():
            for each in place.iterdir():
                _remove(each, but)
            place.rmdir()
        elif place not in but:
            place.unlink(missing_ok=True)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Let Ctrl-C and SIGTERM wait until the block ends."""
    received: list[int] = []

    def later(number: int, _frame: FrameType | None) -> None:
        received.append(number)

    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread may set handlers, and only it is interrupted
        return
    before = {kind: signal.signal(kind, later) for kind in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for kind, handler in before.items():
            signal.signal(kind, handler)
        for number in received:
            signal.raise_signal(number)


@contextmanager
def reserved(folder: Path) -> Iterator[None]:
    """Make a folder and keep it for this process while the block runs; the kernel gives it back.

    What was made is removed again where nothing was written into it.

    Raises:
        InputError: It cannot be made or written, or another process has it.
    """
    with _made(folder):
        try:
            handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        except OSError as error:
            raise InputError(f"cannot write here: {error.strerror}", file=folder) from error
        try:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                raise InputError(
                    "another run is writing into this folder: wait for it or give another --out",
                    file=folder,
                ) from error
            if not os.access(folder, os.W_OK | os.X_OK):
                raise InputError("cannot write here: permission denied", file=folder)
            yield
        finally:
            os.close(handle)


@contextmanager
def _made(folder: Path) -> Iterator[None]:
    """Make a folder; after the block what was made is removed again where nothing is in it."""
    made: list[Path] = []
    try:
        try:
            made = [each for each in (folder, *folder.parents) if not each.exists()]
            folder.mkdir(parents=True, exist_ok=True)
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise InputError(f"cannot write here: {reason}", file=folder) from error
        yield
    finally:
        with suppress(OSError):  # it is not empty
            for each in made:
                each.rmdir()


@contextmanager
def _temporary(path: Path) -> Iterator[Path]:
    """Give an empty file beside `path` that is gone after the block, unless it was renamed."""
    temporary = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(
            prefix=f".{path.stem[:40]}-", suffix=path.suffix[:40], dir=path.parent
        )
        temporary = Path(name)
        os.close(handle)
        temporary.chmod(0o644 & ~_umask())
        yield temporary
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(f"cannot write here: {reason}", file=path) from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def _to_disk(file: Path) -> None:
    with file.open("rb") as written:
        os.fsync(written.fileno())


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
