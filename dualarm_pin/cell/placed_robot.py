"""A robot in its place in the cell, and the names of its parts there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import pinocchio as pin

from dualarm_pin.cell.chains import Chains
from dualarm_pin.cell.joint_roles import Roles


@dataclass(frozen=True)
class PlacedRobot:
    """A URDF, the roles of its joints, and the pose of its root link in the cell."""

    chains: Chains
    roles: Roles
    base: pin.SE3

    def joint(self, name: str) -> str:
        """Return the full name of a joint."""
        return f"{self.chains.joint_owner[name]}/{name}"

    def link(self, name: str) -> str:
        """Return the full name of a link, as shown to users."""
        return f"{self.chains.owner[name]}/{name}"

    @cached_property
    def frames(self) -> dict[str, str]:
        """The name of each link in Pinocchio: another one where a joint has the same."""
        robot = self.chains.robot
        taken = {self.joint(joint) for joint in robot.joints} | {self.link(k) for k in robot.links}
        names = {}
        for link in robot.links:
            full = self.link(link)
            if link in robot.joints and self.joint(link) == full:
                while full in taken:
                    full += ":link"
                taken.add(full)
            names[link] = full
        return names

    @cached_property
    def heads(self) -> dict[str, str]:
        """For each link the first of its rigid body: links that no moving joint parts are one."""
        robot, moving = self.chains.robot, {*self.roles.columns, *self.roles.followers}
        return {
            link: next(
                (j.child for j in reversed(robot.chain(link)) if j.name in moving), robot.root
            )
            for link in robot.links
        }

    def links_without_inertia(self) -> list[str]:
        """Return the moving links whose inertia the URDF does not state.

        Plain frames, which have no shape either, are left out if the rigid body that they belong
        to has a mass.
        """
        links, root = self.chains.robot.links, self.heads[self.chains.robot.root]
        mass = dict.fromkeys(self.heads.values(), 0.0)
        for name, link in links.items():
            mass[self.heads[name]] += 0.0 if link.inertial is None else link.inertial.mass
        return [
            self.link(name)
            for name, link in links.items()
            if self.heads[name] != root
            and (link.inertial is None or not link.inertial.mass)
            and (link.visuals or link.collisions or (self.heads[name] == name and not mass[name]))
        ]
