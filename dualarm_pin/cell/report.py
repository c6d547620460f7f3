"""What was understood of a cell, as records: see `describe`."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from dualarm_pin.cell.parts import Joint


@dataclass(frozen=True)
class ArmReport:
    """One arm as understood.

    Attributes:
        name: `arm1` or `arm2`.
        urdf: Its file, or None for a frame that stands still.
        root: Root link.
        tip: Link that carries the tool.
        joints: Number of its own joints in q.
        base_xyz: Position of the root link in the cell [m].
        base_rpy_deg: Its roll, pitch and yaw [deg].
        tool_xyz: Position of the tool frame in the tip [m].
        tool_rpy_deg: Its roll, pitch and yaw [deg].
        tool_axis: Direction of the tool in the axes of the tip.
        reach: Largest distance of the tool frame from the origin of the first joint [m], over
            random postures; None without joints.
    """

    name: str
    urdf: str | None
    root: str
    tip: str
    joints: int
    base_xyz: tuple[float, ...]
    base_rpy_deg: tuple[float, ...]
    tool_xyz: tuple[float, ...]
    tool_rpy_deg: tuple[float, ...]
    tool_axis: tuple[float, ...]
    reach: float | None


@dataclass(frozen=True)
class ObjectReport:
    """Something that stands in the cell or is carried, as understood.

    Attributes:
        name: Its name.
        what: Its shape, for people.
        on: What carries it.
        xyz: Position of its middle in that frame [m].
        rpy_deg: Its roll, pitch and yaw there [deg].
        size: Extent along its own axes [m].
        pairs: Number of pairs of bodies that it is checked in.
        allowed: Bodies that it may touch.
    """

    name: str
    what: str
    on: str
    xyz: tuple[float, ...]
    rpy_deg: tuple[float, ...]
    size: tuple[float, ...]
    pairs: int
    allowed: tuple[str, ...]


@dataclass(frozen=True)
class CollisionReport:
    """The bodies as understood.

    Attributes:
        known: Whether clearance can be computed.
        bodies: Number of convex bodies.
        pairs: Number of pairs that are checked.
        dropped: Pairs that are not, because they touch in nearly every posture.
        missing: Bodies that could not be loaded.
        free_share: Share of random postures without collision, or None.
    """

    known: bool
    bodies: int
    pairs: int
    dropped: tuple[str, ...]
    missing: tuple[str, ...]
    free_share: float | None


@dataclass(frozen=True)
class CellReport:
    """A cell as understood.

    Attributes:
        name: Name of the cell.
        arms: The two arms.
        joints: The columns of q.
        locked: Joints that stand still: `arm1/<name>` to value [rad or m].
        ranks: Rank of J_r to the share of random postures that have it.
        smallest_singular_value: Median of the sixth singular value of J_r over them.
        postures: Number of random postures.
        objects: What stands in the cell or is carried.
        collision: The bodies and their pairs.
        links_without_inertia: Moving links whose mass no URDF states.
        warnings: What is odd, though it works.
        sources: File to SHA-256.
    """

    name: str
    arms: tuple[ArmReport, ArmReport]
    joints: tuple[Joint, ...]
    locked: dict[str, float]
    ranks: dict[int, float]
    smallest_singular_value: float
    postures: int
    objects: tuple[ObjectReport, ...]
    collision: CollisionReport
    links_without_inertia: tuple[str, ...]
    warnings: tuple[str, ...]
    sources: dict[str, str]

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for JSON; angles of joints in rad, poses as the names say."""
        data = asdict(self)
        data["ranks"] = {str(rank): share for rank, share in self.ranks.items()}
        return data
