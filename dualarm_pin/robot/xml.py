"""Read XML from strangers: no DTD, no entities, no network, and the line of every mistake."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

from lxml import etree

from dualarm_pin.errors import InputError, MissingFileError

_LARGEST = 50_000_000  # bytes; the largest URDF of example-robot-data has 0.3 MB
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
_XACRO = ("http://www.ros.org/wiki/xacro", "http://wiki.ros.org/xacro", "http://ros.org/wiki/xacro")
HUGE = 1e6  # beyond this no length, angle or speed of a robot is meant seriously


def read_bytes(file: Path) -> bytes:
    """Return what `file` holds.

    Raises:
        MissingFileError: It does not exist or cannot be read.
        InputError: It is empty or far too large.
    """
    try:
        size = file.stat().st_size
        raw = file.read_bytes() if size <= _LARGEST else b""
    except FileNotFoundError as error:
        raise MissingFileError("no such file", file=file) from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise MissingFileError(f"cannot be read: {reason}", file=file) from error
    if size > _LARGEST:
        raise InputError(f"{size} bytes is too large for a robot description", file=file)
    if not raw.strip():
        raise InputError("the file is empty", file=file)
    return raw


def parse_xml(raw: bytes, file: Path, huge: bool = False) -> Any:
    """Return the root element.

    Args:
        raw: What the file holds.
        file: The file in messages.
        huge: Let text of more than 10 MB pass, as meshes have it.

    Raises:
        InputError: It is not XML, or it has a DTD or entities.
    """
    # lxml never loads or fetches anything here, but a DTD could still expand attributes.
    if b"<!DOCTYPE" in _COMMENT.sub(b"", raw.replace(b"\0", b"")):
        line = raw[: raw.find(b"<!DOCTYPE")].count(b"\n") + 1
        raise InputError(
            "has a DTD (<!DOCTYPE>), which may define entities; remove it", file=file, line=line
        )
    parser = _parser(False, huge)
    try:
        root = etree.fromstring(raw, parser)
    except etree.XMLSyntaxError as error:
        # An undeclared prefix (<controller:gazebo ...>) is common in the field and harmless.
        # (The log of the exception also holds the errors of earlier files.)
        domains = {entry.domain_name for entry in parser.error_log}
        if domains != {"NAMESPACE"}:
            reason = (error.msg or "not XML").split(", line ")[0]
            if "encoding" in reason or "UTF-8" in reason:
                reason += "; save the file as UTF-8"
            raise InputError(f"not valid XML: {reason}", file=file, line=error.lineno) from error
        root = etree.fromstring(raw, _parser(True, huge))
    except (ValueError, LookupError) as error:
        raise InputError(f"not valid XML: {error}", file=file) from error
    if root is None:
        raise InputError("not valid XML: it holds no element", file=file)
    if root.getroottree().docinfo.internalDTD is not None:
        raise InputError("has a DTD (<!DOCTYPE>), which may define entities; remove it", file=file)
    return root


def _parser(recover: bool, huge: bool) -> etree.XMLParser:
    return etree.XMLParser(
        resolve_entities=False,
        load_dtd=False,
        dtd_validation=False,
        no_network=True,
        huge_tree=huge,
        remove_comments=True,
        remove_pis=True,
        recover=recover,
    )


class Reader:
    """Typed access to the attributes of elements, with messages that name file, line and owner."""

    def __init__(self, file: Path, root: Any) -> None:
        self.file = file
        self.namespace = root.nsmap.get(root.prefix)
        self.colours: dict[str, tuple[float, ...]] = {}  # materials that the robot names

    def error(self, message: str, element: Any, owner: str) -> InputError:
        """Return an error at `element`."""
        return InputError(message, file=self.file, line=element.sourceline, field=owner or None)

    def tag(self, element: Any) -> str:
        """Return the plain tag; empty for comments and for elements of another namespace."""
        if not isinstance(element.tag, str):
            return ""
        uri, _, name = element.tag.rpartition("}")
        namespace = uri.removeprefix("{") or None
        prefix, _, plain = name.rpartition(":")  # a prefix that is not declared stays in the tag
        if namespace in _XACRO or "xacro" in (prefix, element.prefix):
            raise self.error(
                f"<xacro:{plain}> is xacro, not URDF: name the file .xacro, or expand it with "
                "`xacro in.xacro -o out.urdf`",
                element,
                "",
            )
        return name if namespace in (None, self.namespace) and not prefix else ""

    def children(self, element: Any, tag: str) -> list[Any]:
        """Return the children with this tag."""
        return [child for child in element if self.tag(child) == tag]

    def child(self, element: Any, tag: str) -> Any:
        """Return the first child with this tag, or None."""
        return next(iter(self.children(element, tag)), None)

    def text(self, element: Any, key: str, owner: str) -> str:
        """Return an attribute that must be there and not be empty."""
        value = element.get(key)
        if value is None or not value.strip():
            what = "is missing" if value is None else "is empty"
            message = f"the attribute {key!r} of <{self.tag(element)}> {what}"
            raise self.error(message, element, owner)
        self._no_xacro(value, element, owner)
        return str(value)

    def numbers(
        self, element: Any, key: str, default: tuple[float, ...], owner: str
    ) -> tuple[float, ...]:
        """Return as many numbers as `default` has; `default` if the attribute is missing."""
        text = None if element is None else element.get(key)
        if text is None:
            return default
        words = text.split()
        if len(words) != len(default):
            self._no_xacro(text, element, owner)
            count = len(default)
            raise self.error(
                f"{key}={text!r} holds {len(words)} values, {count} "
                f"number{'s are' if count > 1 else ' is'} expected",
                element,
                owner,
            )
        return tuple(self._number(word, key, element, owner) for word in words)

    def number(self, element: Any, key: str, owner: str) -> float | None:
        """Return one number, or None if the attribute is missing."""
        if element is None or element.get(key) is None:
            return None
        return self.numbers(element, key, (0.0,), owner)[0]

    def _number(self, word: str, key: str, element: Any, owner: str) -> float:
        if _NUMBER.fullmatch(word):
            value = float(word)
            if math.isfinite(value):
                return 0.0 if abs(value) < 1e-200 else value
        self._no_xacro(word, element, owner)
        hint = ""
        if word.lstrip("+-").lower() in ("nan", "inf", "infinity") or _NUMBER.fullmatch(word):
            hint = ": a finite number is needed"
        elif _NUMBER.fullmatch(word.replace(",", ".")):
            hint = ": write a decimal point, not a comma"
        raise self.error(f"{key}={word!r} is not a number{hint}", element, owner)

    def _no_xacro(self, text: str, element: Any, owner: str) -> None:
        if "${" in text or "$(" in text:
            raise self.error(
                f"{text!r} is xacro, not URDF: name the file .xacro, or expand it with "
                "`xacro in.xacro -o out.urdf`",
                element,
                owner,
            )
