"""Texts of users inside programs: names and comments in letters that no syntax minds."""

from __future__ import annotations

import re
import textwrap

_PREFIX = "da_"  # no reserved word of any of these languages begins like this


def identifier(text: str, longest: int) -> str:
    """Return a name of ASCII letters, digits and underscores for any text.

    Args:
        text: What the user calls it.
        longest: Most letters that the controller takes.
    """
    plain = re.sub(r"[^A-Za-z0-9]+", "_", text).strip("_") or "motion"
    return (_PREFIX + plain)[:longest].rstrip("_")


def comment(text: str, width: int = 200) -> list[str]:
    """Return a text as lines of letters, digits and harmless signs, none longer than `width`."""
    plain = re.sub(r"[^A-Za-z0-9 _.,:/+=-]", "?", text).replace("--", "- -")
    return textwrap.wrap(plain, width) or [""]
