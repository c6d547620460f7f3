"""CasADi with IPOPT or fatrop: the referee that solves the same whole-path problem.

Values and exact derivatives come from CasADi's automatic differentiation, so nothing is shared
with the engine but the chain of joints; the end is judged with Pinocchio like every other.
"""

from __future__ import annotations

import time
import weakref
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.chain import quaternion_of
from dualarm_pin.errors import UnknownNameError, nearest
from dualarm_pin.solution import Solution
from dualarm_pin.solvers.casadi_model import (
    import_casadi,
    index_expression,
    kinematics,
    pose_rows,
    row_expression,
)
from dualarm_pin.solvers.solver import judged

if TYPE_CHECKING:
    from dualarm_pin.problem import Problem

Plugin = Literal["ipopt", "fatrop"]
PLUGINS: tuple[Plugin, ...] = get_args(Plugin)
_OPTIONS: dict[str, dict[str, Any]] = {
    "ipopt": {"ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-8, "max_iter": 1000}},
    "fatrop": {
        "structure_detection": "manual",
        # At 1e-8 it often stops short of its own tolerance, at the same objective to 1e-6.
        "fatrop": {"print_level": 0, "tol": 1e-6, "max_iter": 1000},
    },
}
_BUILT: weakref.WeakKeyDictionary[Problem, dict[str, Programme]] = weakref.WeakKeyDictionary()


def solve(problem: Problem, start: Array, plugin: str = "ipopt") -> Solution:
    """Minimise `problem` from `start` (k, n).

    The programme is built at the first call for a problem and kept as long as the problem;
    building is not part of `wall_s`.

    Raises:
        MissingExtraError: CasADi is not installed.
        UnknownNameError: There is no such plugin.
        InputError: CasADi has no expression for the index.
    """
    return build(problem, plugin).solve(start)


def build(problem: Problem, plugin: str = "ipopt", *, expand: bool = True) -> Programme:
    """Return the programme of a problem, built once; the errors are those of `solve`.

    Args:
        problem: The problem.
        plugin: `ipopt` or `fatrop`.
        expand: Expand it to scalar operations: seconds more to build, then about four times
            faster an iteration. Without it every point is a call of one function.
    """
    if plugin not in PLUGINS:
        raise UnknownNameError(f"no such plugin: {nearest(plugin, PLUGINS)}", field=plugin)
    built = _BUILT.setdefault(problem, {})
    name = f"{plugin} {expand}"
    if name not in built:
        built[name] = Programme(problem, plugin, expand)
    return built[name]


class Programme:
    """A problem as CasADi's `nlpsol` takes it.

    IPOPT gets the joints x_i alone. fatrop gets the same as an optimal control problem, which is
    the form its recursion needs: states x_i, controls s_i = x_{i+1} - x_i, stage by stage.
    """

    def __init__(self, problem: Problem, plugin: str, expand: bool = True) -> None:
        ca = import_casadi()
        begun = time.perf_counter()
        # A strong reference would keep the problem, and with it this programme, for good.
        self._problem = weakref.ref(problem)
        self.plugin = plugin
        options: dict[str, Any] = {"print_time": False, "error_on_fail": False, "expand": expand}
        options |= _OPTIONS[plugin]
        k, n = problem.k, problem.n
        terms, staged, endless = _Terms(ca, problem), plugin == "fatrop", np.full(n, np.inf)
        x = [ca.MX.sym(f"x{i}", n) for i in range(k)]
        s = [ca.MX.sym(f"s{i}", n) if staged else x[i + 1] - x[i] for i in range(k - 1)]
        cost = sum(terms.point(i, x[i]) for i in range(k))
        cost += sum(terms.link(i, s[i]) for i in range(k - 1))
        variables, rows, lower, upper, most = [], [], [], [], []
        for i in range(k):
            variables.append(x[i])
            lower.append(problem.lower)
            upper.append(problem.upper)
            if staged and i < k - 1:
                variables.append(s[i])
                lower.append(-endless)
                upper.append(endless)
                rows.append(x[i + 1] - (x[i] + s[i]))
                most.append(np.zeros(n))
            rows.append(terms.rows(i, x[i]))
            most.append(terms.most(i))
        self._lower, self._upper = np.concatenate(lower), np.concatenate(upper)
        self._most = np.concatenate(most)
        if staged:
            options |= {"N": k - 1, "nx": [n] * k, "nu": [n] * (k - 1) + [0]}
            options |= {"ng": [len(terms.most(i)) for i in range(k)]}
            options |= {"equality": (self._most == 0.0).tolist()}
        nlp = {"x": ca.vertcat(*variables), "f": cost, "g": ca.vertcat(*rows)}
        self._solver = ca.nlpsol("solver", plugin, nlp, options)
        self.build_s = time.perf_counter() - begun

    def solve(self, start: Array) -> Solution:
        """Minimise from `start` (k, n)."""
        problem = self._problem()
        assert problem is not None  # the caller found this programme by it
        k, n = problem.k, problem.n
        first = np.clip(start, problem.lower, problem.upper)
        if self.plugin == "fatrop":
            steps = np.vstack([np.diff(first, axis=0), np.zeros((1, n))])
            x0 = np.hstack([first, steps]).ravel()[: (2 * k - 1) * n]
        else:
            x0 = first.ravel()
        begun = time.perf_counter()
        answer = self._solver(x0=x0, lbx=self._lower, ubx=self._upper, lbg=0, ubg=self._most)
        wall = time.perf_counter() - begun
        x = np.asarray(answer["x"], dtype=float).ravel()
        if self.plugin == "fatrop":
            x = np.append(x, np.zeros(n)).reshape(k, 2 * n)[:, :n]
        stats = self._solver.stats()
        return judged(
            problem,
            x.reshape(k, n),
            converged=bool(stats["success"]),
            message=str(stats.get("return_status", stats.get("unified_return_status", ""))),
            iterations=int(stats.get("iter_count", 0)),
            wall_s=wall,
        )


class _Terms:
    """Cost and rows of one point and one link, as CasADi functions used at every point."""

    def __init__(self, ca: Any, problem: Problem) -> None:
        self.ca, self.problem = ca, problem
        n = problem.n
        q, u = ca.SX.sym("q", n), ca.SX.sym("u", 6)
        position, quaternion = ca.SX.sym("p", 3), ca.SX.sym("e", 4)
        pose = kinematics(problem.cell, q)
        half = np.maximum((problem.upper - problem.lower) / 2.0, 1e-12)
        offset = (q - (problem.lower + problem.upper) / 2.0) / half
        cost = index_expression(problem.index, pose.jacobian, u)
        cost += problem.index.joint_centre * ca.sumsqr(offset)
        self._cost = ca.Function("cost", [q, u], [cost])
        self._rows = {
            int(count): ca.Function(
                f"rows{count}",
                [q, position, quaternion],
                [pose_rows(pose, position, quaternion, int(count), problem.spin_axis)],
            )
            for count in np.unique(problem.points.pose_rows)
        }
        self._further = [
            ca.Function("row", [q], [row_expression(row, problem.cell, pose)])
            for row in problem.rows
        ]
        step, metric = ca.SX.sym("s", n), ca.SX.sym("m", n)
        self._link = ca.Function("link", [step, metric], [ca.dot(metric, step**2) ** 2])

    def point(self, i: int, q: Any) -> Any:
        """Return what point i costs, its links to fixed neighbours included."""
        points, ends = self.problem.points, self.problem.neighbours
        cost = float(points.index_weight[i]) * self._cost(q, points.u[i])
        if points.linear[i].any():
            cost += self.ca.dot(self.ca.DM(points.linear[i]), q)
        for end, at, link in ((0, 0, -1), (1, self.problem.k - 1, self.problem.k - 1)):
            if i == at and ends.weight[end] != 0.0:
                metric = self.problem.links.metric_of(link)
                cost += float(ends.weight[end]) * self._link(q - ends.posture[end], metric)
        return cost

    def link(self, i: int, step: Any) -> Any:
        """Return what the link from point i to the next costs."""
        links = self.problem.links
        return float(links.weight[i]) * self._link(step, links.metric_of(i))

    def rows(self, i: int, q: Any) -> Any:
        """Return the rows of point i: pose, further equalities, inequalities."""
        points = self.problem.points
        wanted = points.position[i], quaternion_of(points.rotation[i])
        found = [self._rows[int(points.pose_rows[i])](q, *wanted)]
        found += [self._further[row](q) for row in self._sources(i)]
        return self.ca.vertcat(*found)

    def most(self, i: int) -> Array:
        """Return the largest value allowed for each row of point i; the least is 0 for all."""
        equal, unequal = self.problem.row_count[i], self.problem.inequalities.size[i]
        return np.concatenate([np.zeros(equal), np.full(unequal, np.inf)])

    def _sources(self, i: int) -> list[int]:
        tables = (self.problem.equalities, self.problem.inequalities)
        return [int(row) for table in tables for row in table.source[i, : table.size[i]]]
