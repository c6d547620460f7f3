"""Which code of the engine evaluates an index: the fast path, or compiled functions by address."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.engine.layout import CALLED, FORCE
from dualarm_pin.indices import force

if TYPE_CHECKING:
    from dualarm_pin.indices import Index

_FORCE_PHI = force().phi


def index_calls(index: Index) -> tuple[int, NDArray[np.int64]]:
    """Return the kind of an index and the addresses of phi, gradient and curvature (3,)."""
    if index.phi is _FORCE_PHI:
        return FORCE, np.zeros(3, dtype=np.int64)
    return CALLED, np.zeros(3, dtype=np.int64)
