"""SRDF: pairs of links that need no collision check, and groups that name a tip."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.robot.robot import Robot
from dualarm_pin.robot.xml import Element, read_bytes, read_root


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
    root = read_root(read_bytes(file), file)
    if root.tag != "robot":
        raise root.error("this is not an SRDF: it starts with <robot name=...>")
    warnings = root.document.warnings
    pairs = root.children("disable_collisions", owner="disable_collisions")
    disabled: set[frozenset[str]] = set()
    for element in pairs:
        pair = [element.text(key) for key in ("link1", "link2")]
        strange = [link for link in pair if link not in robot.links]
        if strange:
            warnings.append(
                f"{file.name}:{element.line}: {robot.file.name} has no link {strange[0]!r}: "
                f"{nearest(strange[0], robot.links)}"
            )
        else:
            disabled.add(frozenset(pair))
    if pairs and not disabled:
        raise InputError(
            f"none of its {len(pairs)} pairs exists in {robot.file.name}: is it of another robot?",
            file=file,
        )
    return Srdf(file, frozenset(disabled), _tips(root, robot), tuple(warnings))


def _tips(root: Element, robot: Robot) -> dict[str, str]:
    """Return the last link of each group: of its chain, its links, or its joints."""
    tips: dict[str, str] = {}
    for group in root.children("group"):
        names = [chain.get("tip_link") or "" for chain in group.children("chain")]
        names += [link.get("name") or "" for link in group.children("link")]
        joints = [robot.joints.get(joint.get("name") or "") for joint in group.children("joint")]
        names += [joint.child for joint in joints if joint is not None]
        links = [name for name in names if name in robot.links]
        if links and (name := group.get("name")):
            tips[name] = max(links, key=lambda link: len(robot.chain(link)))
    return tips
