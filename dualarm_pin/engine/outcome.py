"""What a solve takes and gives: options, one outcome, a batch of them, an evaluation."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.engine.chain import Floats, Integers
from dualarm_pin.engine.interior_point import CONVERGED, NOT_RUN, Settings
from dualarm_pin.errors import InputError

STATUS = ("converged", "iteration limit", "infeasible", "stalled", "not run")


@dataclass(frozen=True)
class Options:
    """How one start is solved.

    Attributes:
        tolerance: On stationarity, pose residual and complementarity.
        iterations: Cap on Newton steps.
        mu0: First barrier parameter.
        push: Share of every range to which the start is moved away from its bounds.
    """

    tolerance: float = 1e-7
    iterations: int = 150
    mu0: float = 0.1
    push: float = 1e-2

    @classmethod
    def warm(cls, tolerance: float = 1e-7, iterations: int = 150) -> Options:
        """Return options for a start that is nearly the answer, multipliers kept."""
        return cls(tolerance, iterations, 1e-6, 1e-6)

    def settings(self) -> Settings:
        """Return the numbers as the compiled code takes them, checked.

        Raises:
            InputError: A number is out of its range.
        """
        for name in ("tolerance", "mu0", "push"):
            value = getattr(self, name)
            if not 0.0 < value < np.inf:
                raise InputError(f"is {value}, must be above 0", field=name)
        if self.push >= 0.5:
            raise InputError(f"is {self.push}, must be below 0.5", field="push")
        return Settings(
            float(self.tolerance), int(self.iterations), float(self.mu0), float(self.push)
        )


@dataclass(frozen=True, eq=False)
class Outcome:
    """One local solve; everything is evaluated at the q returned.

    Attributes:
        q: (k, n) rad or m, always within the bounds.
        status: Index into `STATUS`.
        objective: The problem's objective at q.
        residual: Largest absolute pose residual at q [m, or 2 sin(angle / 2)].
        stationarity: Largest absolute entry of the Lagrangian's gradient.
        iterations: Newton steps and restorations.
        pose_multipliers: (k, 6), 0 beyond a point's rows. The sign of the last three follows the
            sign of the running quaternion of the chain.
        lower_multipliers: (k, n), at least 0.
        upper_multipliers: (k, n), at least 0.
        mu: Last barrier parameter.
    """

    q: Floats
    status: int
    objective: float
    residual: float
    stationarity: float
    iterations: int
    pose_multipliers: Floats
    lower_multipliers: Floats
    upper_multipliers: Floats
    mu: float

    @property
    def converged(self) -> bool:
        """Whether the solver met its tolerance."""
        return self.status == CONVERGED

    @property
    def message(self) -> str:
        """The status in words."""
        return STATUS[self.status]


@dataclass(frozen=True, eq=False)
class Batch:
    """Many solves, row by row as `Outcome`.

    Attributes:
        q: (s, k, n) rad or m.
        status: (s,) index into `STATUS`; NOT_RUN where the batch was stopped before.
        objective: (s,).
        residual: (s,).
        stationarity: (s,).
        iterations: (s,).
        pose_multipliers: (s, k, 6).
        lower_multipliers: (s, k, n).
        upper_multipliers: (s, k, n).
        mu: (s,).
        interrupted: Whether it was stopped before every start was run.
    """

    q: Floats
    status: Integers
    objective: Floats
    residual: Floats
    stationarity: Floats
    iterations: Integers
    pose_multipliers: Floats
    lower_multipliers: Floats
    upper_multipliers: Floats
    mu: Floats
    interrupted: bool

    def __len__(self) -> int:
        return len(self.q)

    def __getitem__(self, item: int) -> Outcome:
        """Return one solve."""
        values = {
            field.name: getattr(self, field.name)[item] for field in dataclasses.fields(Outcome)
        }
        scalars = ("objective", "residual", "stationarity", "mu")
        values |= {name: float(values[name]) for name in scalars}
        values |= {name: int(values[name]) for name in ("status", "iterations")}
        return Outcome(**values)

    def feasible(self, tolerance: float = 1e-6) -> NDArray[np.bool_]:
        """Return which starts (s,) were run and ended on the path, by the residual at their q."""
        return np.asarray((self.status != NOT_RUN) & (self.residual <= tolerance))


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Values and derivatives at q (k, n), as the engine computes them.

    Attributes:
        objective: The problem's objective.
        values: (k,) per point: weighted index and linear term, no links.
        residual: (k, 6).
        jacobian: (k, 6, n) of the residual.
        gradient: (k, n) of the objective.
        hessian: (k, n, n) diagonal blocks of the Hessian of objective + y . residual.
        link: (k, n) diag(metric) dq of the link after each point.
        stiffness: (k,) of that link: the block (i+1, i) of the Hessian is
            -(stiffness_i diag(metric) + 8 link_weight_i link_i link_i^T).
        J_r: (k, 6, n) relative Jacobian [linear; angular] of e2 with respect to e1, in e1.
    """

    objective: float
    values: Floats
    residual: Floats
    jacobian: Floats
    gradient: Floats
    hessian: Floats
    link: Floats
    stiffness: Floats
    J_r: Floats
