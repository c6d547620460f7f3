"""The compiled functions that Python calls; all else is compiled into them."""

from __future__ import annotations

from dualarm_pin.chain import Floats, Integers
from dualarm_pin.engine.arrow_problem import ArrowProblem
from dualarm_pin.engine.chain.derivatives import point_value
from dualarm_pin.engine.chain.kinematics import place_segments, relative_jacobian
from dualarm_pin.engine.chain.row_terms import row_values
from dualarm_pin.engine.interior_point import arrow
from dualarm_pin.engine.interior_point.barrier import add_barrier, start_slacks
from dualarm_pin.engine.interior_point.line_search import merit_of
from dualarm_pin.engine.interior_point.objective import all_derivatives, objective
from dualarm_pin.engine.interior_point.solve_one import CONVERGED, Settings, solve_one
from dualarm_pin.engine.interior_point.walk import LOST, take_step, take_window, visited
from dualarm_pin.engine.jit import records  # noqa: F401  registers what compiled code reads
from dualarm_pin.engine.jit.compiled import copy_rows, entry, source_stamp
from dualarm_pin.engine.workspace import Scratch, Workspace
from dualarm_pin.problem import Problem

_STAMP = source_stamp()


def _make_solve_items(stamp: int, name: str):  # type: ignore[no-untyped-def]
    def solve_items(
        problem: Problem,
        work: Workspace,
        settings: Settings,
        keep_multipliers: bool,
        items: Integers,
        neighbours: Floats,
        interrupt: Integers,
        q: Floats,
        codes: Integers,
        values: Floats,
        limit: Floats,
        path: Problem,
        first: Integers,
        anchor: Integers,
        scale: Floats,
    ) -> int:
        """Solve some items of a batch, one after the other, until done or interrupted.

        Where anchors are given an item is a walk: its posture at the anchor is kept, every other
        point is solved alone, linked to the one before it. Where only first points are given an
        item is a window of the path. All have one loop, so that the solve is compiled once.

        Args:
            problem: The problem; its fixed neighbours are overwritten. For a walk, one point with
                arrays of its own; for windows, one of them with arrays of its own.
            work: Room for one item, with the multipliers of a warm start.
            settings: For every item alike.
            keep_multipliers: Warm start.
            items: (s,) rows of the batch to solve.
            neighbours: (batch, 2, n) fixed neighbours of every item, or (1, 2, n) of all.
            interrupt: (1,) not 0: stop before the next item.
            q: (batch, k, n) starts, overwritten by the results.
            codes: (batch, 3) filled: status, iterations, whether it is a saddle; of a walk the
                iterations of all its points, and whether the last reached its rows.
            values: (batch, 4) filled: objective, residual, stationarity, mu; of a walk those of
                the last point.
            limit: (batch,) objectives above which an item is dropped, or (1,) for all.
            path: The problem of all points, for walks and windows.
            first: (batch,) point of the path that the first point of an item stands for, or (0,):
                all items are of `problem` as it is.
            anchor: (batch,) point of an item whose posture is given, or (0,): no walk.
            scale: (batch,) factors on the weight of the links while walking; of windows, on that
                of the links that lead out of them, 0 or 1.
        """
        _ = stamp
        walking = anchor.shape[0] > 0
        windows = not walking and first.shape[0] > 0
        solves = q.shape[1] - 1 if walking else 1
        for item in items:
            if interrupt[0] != 0:
                break
            codes[item, 0], codes[item, 1], values[item, 1] = CONVERGED, 0, 0.0
            mine = Settings(
                settings.tolerance,
                settings.iterations,
                settings.mu,
                settings.push,
                limit[item if limit.shape[0] > 1 else 0],
            )
            for number in range(solves):
                i = 0
                if walking:
                    i = visited(number, anchor[item], q.shape[1])
                    take_step(path, first[item], anchor[item], i, scale[item], q[item], problem)
                else:
                    if windows:
                        take_window(path, first[item], scale[item], problem)
                    own = item if neighbours.shape[0] > 1 else 0
                    copy_rows(neighbours[own], problem.neighbours.posture)
                copy_rows(q[item, i : i + work.at.q.shape[0]], work.at.q)
                report = solve_one(problem, mine, work, keep_multipliers)
                copy_rows(work.at.q, q[item, i : i + work.at.q.shape[0]])
                codes[item, 0] = report.status
                codes[item, 1] += report.iterations
                codes[item, 2] = 1 if report.saddle else 0
                values[item, 0], values[item, 1] = report.objective, report.residual
                values[item, 2], values[item, 3] = report.stationarity, report.mu
                if walking and report.residual > LOST:
                    break
        return stamp

    solve_items.__qualname__ = name
    return entry(solve_items)


def _make_evaluate(stamp: int):  # type: ignore[no-untyped-def]
    def evaluate(problem: Problem, work: Workspace, values: Floats, J_r: Floats) -> float:
        """Fill values (k,), J_r (k, 6, n) and the derivatives in `work` at `work.at`."""
        at = work.at
        for i in range(at.q.shape[0]):
            values[i] = point_value(
                problem, i, at.q[i], work.scratch, work.residual[i], work.error[i], work.gap[i]
            )
            relative_jacobian(problem.chain, work.scratch.w, work.scratch.v, J_r[i])
        total = objective(problem, work, at.q, work.residual, work.gap)
        all_derivatives(problem, work, at)
        return total + 0 * stamp

    return entry(evaluate)


def _make_gaps(stamp: int):  # type: ignore[no-untyped-def]
    def gaps(problem: Problem, scratch: Scratch, q: Floats, values: Floats) -> int:
        """Fill values (k, r) with the inequality rows at q (k, n)."""
        for i in range(q.shape[0]):
            place_segments(problem.chain, q[i], scratch.place)
            row_values(problem.inequalities, i, scratch, values[i])
        return stamp

    return entry(gaps)


def _make_differentiate(stamp: int):  # type: ignore[no-untyped-def]
    def differentiate(problem: ArrowProblem, work: Workspace, least_slack: float) -> bool:
        """Fill the derivatives and the border of `work.at` by the shared columns.

        Args:
            problem: A problem with shared columns.
            work: Room, with the postures and multipliers of a minimum over the joints.
            least_slack: Smallest slack of an inequality row.

        Returns:
            Whether it is a strict one.
        """
        at = work.at
        merit_of(problem, work, at.q, work.residual, work.gap, at.slack)
        start_slacks(problem, work.gap, least_slack, at.slack)
        arrow.derivatives(problem, work, at)
        add_barrier(problem, work, at, 0.0 * stamp)
        return arrow.differentiate(problem, work)

    return entry(differentiate)


solve_items = _make_solve_items(_STAMP, "solve_items")
solve_arrow_items = _make_solve_items(_STAMP, "solve_arrow_items")
evaluate = _make_evaluate(_STAMP)
gaps = _make_gaps(_STAMP)
differentiate = _make_differentiate(_STAMP)
