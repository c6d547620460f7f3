"""SRDF: pairs of links that need no collision check, and groups that name a tip."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.robot.robot import Robot
from dualarm_pin.robot.xml import Reader, parse_xml, read_bytes


@dataclass(frozen=True)
class Srdf:
    """What a cell takes from an SRDF.

    Attributes:
        file: Where it was read from.
        disabled: Pairs of links that are not checked.
        tips: Group to the last link of its chain.
        warnings: What was ignored, and why.
    """

    file: Path
    disabled: frozenset[frozenset[str]]
    tips: dict[str, str]
    warnings: tuple[str, ...]

    def tip(self, group: str) -> str:
        """Return the last link of a group.

        Raises:
            UnknownNameError: There is no such group, or it has no chain.
        """
        if group not in self.tips:
            message = f"no group {group!r} with a chain of links: {nearest(group, self.tips)}"
            raise UnknownNameError(message, file=self.file)
        return self.tips[group]


def read_srdf(file: Path, robot: Robot) -> Srdf:
    """Read an SRDF that belongs to `robot`.

    Links that the robot lacks are a warning, not an error: robots share SRDFs in the field.

    Raises:
        MissingFileError: There is no such file.
        InputError: It is not an SRDF, or names not one link of the robot.
    """
    root = parse_xml(read_bytes(file), file)
    read = Reader(file, root)
    if read.tag(root) != "robot":
        raise read.error("this is not an SRDF: it starts with <robot name=...>", root, "")
    warnings: list[str] = []
    named = 0
    disabled: set[frozenset[str]] = set()
    for element in read.children(root, "disable_collisions"):
        pair = [read.text(element, key, "disable_collisions") for key in ("link1", "link2")]
        strange = [link for link in pair if link not in robot.links]
        named += 1
        if strange:
            warnings.append(
                f"{file.name}:{element.sourceline}: {robot.file.name} has no link {strange[0]!r}: "
                f"{nearest(strange[0], robot.links)}"
            )
        else:
            disabled.add(frozenset(pair))
    if named and not disabled:
        raise InputError(
            f"none of its {named} pairs exists in {robot.file.name}: is it of another robot?",
            file=file,
        )
    tips = _tips(read, root, robot)
    return Srdf(file, frozenset(disabled), tips, tuple(warnings))


def _tips(read: Reader, root: Any, robot: Robot) -> dict[str, str]:
    """Return the last link of each group: of its chain, its links, or its joints."""
    tips: dict[str, str] = {}
    for group in read.children(root, "group"):
        names = [chain.get("tip_link", "") for chain in read.children(group, "chain")]
        names += [link.get("name", "") for link in read.children(group, "link")]
        names += [
            robot.joints[joint.get("name")].child
            for joint in read.children(group, "joint")
            if joint.get("name") in robot.joints
        ]
        links = [name for name in names if name in robot.links]
        if links and group.get("name"):
            tips[group.get("name")] = max(links, key=lambda link: len(robot.chain(link)))
    return tips
