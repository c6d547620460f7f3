"""Read XML from strangers: no DTD, no entities, no network, and the line of every mistake."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from lxml import etree

from dualarm_pin.errors import InputError
from dualarm_pin.files.read import read_file

_LARGEST = 50_000_000  # bytes; the largest URDF of example-robot-data has 0.3 MB
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
_XACRO = ("http://www.ros.org/wiki/xacro", "http://wiki.ros.org/xacro", "http://ros.org/wiki/xacro")
_DTD = "has a DTD (<!DOCTYPE>), which may define entities; remove it"
_EXPAND = "is xacro, not URDF: name the file .xacro, or expand it with `xacro in.xacro -o out.urdf`"
HUGE = 1e6  # beyond this no length, angle or speed of a robot is meant seriously


def read_bytes(file: Path) -> bytes:
    """Return what `file` holds.

    Raises:
        MissingFileError: It does not exist or cannot be read.
        InputError: It is empty or far too large.
    """
    raw = read_file(file, _LARGEST, "a robot description is expected")
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
        raise InputError(_DTD, file=file, line=line)
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
        raise InputError(_DTD, file=file)
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


@dataclass(frozen=True)
class Document:
    """What all elements of a file share.

    Attributes:
        file: The file in messages.
        namespace: That of the root, or None.
        colours: Materials that the robot names: red, green, blue, alpha.
        warnings: What is odd, though legal.
    """

    file: Path
    namespace: str | None
    colours: dict[str, tuple[float, ...]] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Element:
    """Typed access to an element, with messages that name file, line and owner.

    Attributes:
        document: The file that it stands in.
        node: The element of lxml; None for one that is not there, which has no attributes.
        owner: The link or joint that it belongs to, in messages.
    """

    document: Document
    node: Any
    owner: str = ""

    def __bool__(self) -> bool:
        return self.node is not None

    @property
    def line(self) -> int:
        """Its line, from 1."""
        return int(self.node.sourceline)

    @property
    def tag(self) -> str:
        """The plain tag; empty for comments and for elements of another namespace."""
        if not isinstance(self.node.tag, str):
            return ""
        uri, _, name = self.node.tag.rpartition("}")
        namespace = uri.removeprefix("{") or None
        prefix, _, plain = name.rpartition(":")  # a prefix that is not declared stays in the tag
        if namespace in _XACRO or "xacro" in (prefix, self.node.prefix):
            raise replace(self, owner="").error(f"<xacro:{plain}> {_EXPAND}")
        return name if namespace in (None, self.document.namespace) and not prefix else ""

    def error(self, message: str) -> InputError:
        """Return an error at this element."""
        file, field = self.document.file, self.owner or None
        return InputError(message, file=file, line=self.line, field=field)

    def children(self, tag: str = "", owner: str = "") -> list[Element]:
        """Return the children with this tag, or with any that is known."""
        nodes = () if self.node is None else self.node
        every = [Element(self.document, node, owner or self.owner) for node in nodes]
        return [child for child in every if (child.tag == tag if tag else child.tag)]

    def child(self, tag: str) -> Element:
        """Return the first child with this tag; its node is None if there is none."""
        return next(iter(self.children(tag)), replace(self, node=None))

    def get(self, key: str) -> str | None:
        """Return an attribute as it is written, or None."""
        return None if self.node is None else self.node.get(key)

    def text(self, key: str) -> str:
        """Return an attribute that must be there and not be empty."""
        value = self.get(key)
        if value is None or not value.strip():
            what = "is missing" if value is None else "is empty"
            raise self.error(f"the attribute {key!r} of <{self.tag}> {what}")
        self._no_xacro(value)
        return value

    def numbers(self, key: str, default: tuple[float, ...]) -> tuple[float, ...]:
        """Return as many numbers as `default` has; `default` if the attribute is missing."""
        text = self.get(key)
        if text is None:
            return default
        words, count = text.split(), len(default)
        if len(words) != count:
            self._no_xacro(text)
            wanted = f"{count} number{'s are' if count > 1 else ' is'} expected"
            raise self.error(f"{key}={text!r} holds {len(words)} values, {wanted}")
        return tuple(self._number(word, key) for word in words)

    def triple(self, key: str, default: tuple[float, float, float]) -> tuple[float, float, float]:
        """Return three numbers; `default` if the attribute is missing."""
        x, y, z = self.numbers(key, default)
        return x, y, z

    def number(self, key: str) -> float | None:
        """Return one number, or None if the attribute is missing."""
        return None if self.get(key) is None else self.numbers(key, (0.0,))[0]

    def _number(self, word: str, key: str) -> float:
        if _NUMBER.fullmatch(word):
            value = float(word)
            if math.isfinite(value):
                return 0.0 if abs(value) < 1e-200 else value
        self._no_xacro(word)
        hint = ""
        if word.lstrip("+-").lower() in ("nan", "inf", "infinity") or _NUMBER.fullmatch(word):
            hint = ": a finite number is needed"
        elif _NUMBER.fullmatch(word.replace(",", ".")):
            hint = ": write a decimal point, not a comma"
        raise self.error(f"{key}={word!r} is not a number{hint}")

    def _no_xacro(self, text: str) -> None:
        if "${" in text or "$(" in text:
            raise self.error(f"{text!r} {_EXPAND}")


def read_root(raw: bytes, file: Path) -> Element:
    """Return the root element of what `file` holds.

    Raises:
        InputError: As for `parse_xml`.
    """
    root = parse_xml(raw, file)
    return Element(Document(file, root.nsmap.get(root.prefix)), root)
