"""Where a kernel puts what: the rows of its model (22, 6)."""

from __future__ import annotations

BASIS = 0  # six rows: f_a
SLOPE = 6  # one row: g_a
PAIR = 7  # six rows: pair_ab, upper triangle
BOTH = 13  # six rows: both_ab
VALUE = 19  # one row: phi first
ROOM = 20  # two rows for the kernel's own use
ROWS = 22  # all of them
