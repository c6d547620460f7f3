"""The compiled functions that Python calls; all else is compiled into them."""

from __future__ import annotations

from dualarm_pin.engine.barrier import all_derivatives, objective
from dualarm_pin.engine.chain import Floats, Integers
from dualarm_pin.engine.compiled import entry, source_stamp
from dualarm_pin.engine.derivatives import point_value
from dualarm_pin.engine.interior_point import Settings, solve_one
from dualarm_pin.engine.kinematics import relative_jacobian
from dualarm_pin.engine.layout import Points, Problem, load_window
from dualarm_pin.engine.workspace import Workspace

_STAMP = source_stamp()


def _make_solve_items(stamp: int):  # type: ignore[no-untyped-def]
    def solve_items(
        problem: Problem,
        path: Points,
        work: Workspace,
        settings: Settings,
        keep_multipliers: bool,
        items: Integers,
        first: Integers,
        interrupt: Integers,
        q: Floats,
        y: Floats,
        z_l: Floats,
        z_u: Floats,
        codes: Integers,
        values: Floats,
    ) -> int:
        """Solve some items of a batch, one after the other, until done or interrupted.

        Args:
            problem: With room for the points of one item.
            path: All points.
            work: Room for one item.
            settings: For every item alike.
            keep_multipliers: Warm start.
            items: (s,) rows of the batch to solve.
            first: (batch,) first point of every item.
            interrupt: (1,) not 0: stop before the next item.
            q: (batch, k, n) starts, overwritten by the results.
            y: (batch, k, 6) multipliers.
            z_l: (batch, k, n).
            z_u: (batch, k, n).
            codes: (batch, 2) filled: status, iterations.
            values: (batch, 4) filled: objective, residual, stationarity, mu.
        """
        _ = stamp
        for item in items:
            if interrupt[0] != 0:
                break
            load_window(path, first[item], problem.points)
            report = solve_one(
                problem, settings, work, keep_multipliers, q[item], y[item], z_l[item], z_u[item]
            )
            codes[item, 0], codes[item, 1] = report.status, report.iterations
            values[item, 0], values[item, 1] = report.objective, report.residual
            values[item, 2], values[item, 3] = report.stationarity, report.mu
        return stamp

    return entry(solve_items)


def _make_evaluate(stamp: int):  # type: ignore[no-untyped-def]
    def evaluate(
        problem: Problem, work: Workspace, q: Floats, y: Floats, values: Floats, J_r: Floats
    ) -> float:
        """Fill values (k,), J_r (k, 6, n) and the derivatives in `work`; return the objective."""
        for i in range(q.shape[0]):
            values[i] = point_value(problem, i, q[i], work.scratch, work.residual[i], work.error[i])
            relative_jacobian(problem.chain, work.scratch.w, work.scratch.v, J_r[i])
        total = objective(problem, work, q, work.residual)
        all_derivatives(problem, work, q, y)
        return total + 0 * stamp

    return entry(evaluate)


solve_items = _make_solve_items(_STAMP)
evaluate = _make_evaluate(_STAMP)
