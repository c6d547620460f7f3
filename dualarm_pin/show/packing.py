"""Pack arrays and a description of them into the bytes that a page carries."""

from __future__ import annotations

import base64
import gzip
import json
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

Reference = dict[str, Any]
_ALIGN = 4  # bytes of the numbers in the page; typed arrays begin at a multiple


class Blob:
    """Arrays one after the other, each found again by its reference.

    Layout of the whole: length of the JSON head (uint32, little-endian), the head padded with
    blanks to a multiple of 4, then the arrays.
    """

    def __init__(self) -> None:
        self._chunks: list[bytes] = []
        self._size = 0

    def add(self, array: ArrayLike, kind: str = "f4") -> Reference:
        """Store an array as `f4`, `u2` or `u4` and return where it is."""
        values = np.ascontiguousarray(np.asarray(array), dtype=np.dtype("<" + kind))
        data = values.tobytes()
        reference = {"at": self._size, "type": kind, "shape": list(values.shape)}
        padded = data + bytes(-len(data) % _ALIGN)
        self._chunks.append(padded)
        self._size += len(padded)
        return reference

    def pack(self, head: object) -> bytes:
        """Return head and arrays as one piece."""
        text = json.dumps(head, allow_nan=False, separators=(",", ":")).encode()
        text += b" " * (-len(text) % _ALIGN)
        return len(text).to_bytes(4, "little") + text + b"".join(self._chunks)


def squeeze(data: bytes) -> str:
    """Return data as base64 of gzip, the same for the same data."""
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode("ascii")
