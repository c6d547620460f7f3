"""The one record of tolerances: what counts as zero, as equal, as found."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Tolerance:
    """Tolerances of a verified result.

    Attributes:
        position: Largest position error of a found result [m].
        rotation: Largest rotation error of a found result [rad].
        bound: Largest violation of a joint bound [rad or m].
        feasible: Largest pose residual of a solver's end that counts as on the path [m or rad];
            a tenth of what a found result may have, so that the check has room.
        near_path: A point of a solver nearer to the path than this is put onto it afterwards.
        nlopt_rows: Violation of rows that NLopt may leave; the projection takes it away.
        on_path: Pose residual at which joints count as put onto the path [m or rad].
        exact: The same for the last projection of an answer: near what rounding leaves.
        active: A joint nearer to its bound than this is held by it: the interior point leaves
            active joints mu / z inside, 1e-9 at z = 0.01 [rad or m].
        stationary: Largest slope of the Lagrangian at a minimum, times max(1, F).
        flat: A curvature below this in size counts as none.
        rank: A singular value of the active rows below this counts as 0.
        same_joint: Two paths are one minimum if no joint differs by more [rad or m].
        same_objective: ... and their objectives differ by less than this times max(1, F).
        singular: A singular value below this is reported as near-singular.
        search: Optimality error at which a start of the search counts as converged.
        polish: Optimality error of the final answer.
        unit: A quaternion or axis from a file may miss unit length by this much.
        orthonormal: Largest entry of R^T R - 1 of a rotation matrix that is still accepted.
        coincident: Points nearer than this are the same point [m].
        parallel: Unit vectors are parallel or opposite if their cross product or sum is shorter.
        no_length: A vector shorter than this has no direction.
        fixed_joint: Bounds closer than this hold a joint at their middle [rad or m].
        row: Largest violation of a constraint row of a found result, in the unit of the row.
        clearance: A distance that is asked for may be missed by this much [m]: rows follow flat
            faces of hulls, and end within it; contact is never accepted.
    """

    position: float = 1e-6
    rotation: float = 1e-6
    bound: float = 1e-9
    feasible: float = 1e-7
    near_path: float = 1e-4
    nlopt_rows: float = 1e-8
    on_path: float = 1e-10
    exact: float = 1e-12
    active: float = 1e-6
    stationary: float = 1e-6
    flat: float = 1e-7
    rank: float = 1e-9
    same_joint: float = 0.02
    same_objective: float = 1e-5
    singular: float = 1e-3
    search: float = 1e-7
    polish: float = 1e-10
    unit: float = 1e-3
    orthonormal: float = 1e-4
    coincident: float = 1e-9
    parallel: float = 1e-6
    no_length: float = 1e-12
    fixed_joint: float = 1e-9
    row: float = 1e-6
    clearance: float = 5e-4


TOLERANCE = Tolerance()
