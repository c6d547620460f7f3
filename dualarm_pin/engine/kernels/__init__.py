"""The table of index kernels: what an index named in `Index.kernel` is at one A, in closed form.

A kernel is one compiled function (A (6, 6), u (6,), wanted, model (22, 6)). It fills the value of
phi, and where `wanted` the rest of the index's second-order model at A:

    dphi  = sum_a g_a D_aa                                     with D_ab = f_a . dA f_b
    d2phi = sum_{a<=b} pair_ab D_ab^2 + sum_ab both_ab D_aa D_bb

by six vectors f_a of its own choice, in which dphi/dA and its derivative are diagonal: eigenvectors
of A, or those that make A the identity. Each kernel is compiled when a task first asks for it.
"""

from collections.abc import Callable
from typing import Any

from dualarm_pin.engine.kernels.determinant import yoshikawa
from dualarm_pin.engine.kernels.inverse import velocity
from dualarm_pin.engine.kernels.spectrum import inverse_condition_number, smallest_singular_value

KERNELS: dict[str, Callable[..., Any]] = {
    "velocity": velocity,
    "yoshikawa": yoshikawa,
    "inverse_condition_number": inverse_condition_number,
    "smallest_singular_value": smallest_singular_value,
}
"""By the name in `Index.kernel`; a new one is a function in a file of its own, and an entry."""
