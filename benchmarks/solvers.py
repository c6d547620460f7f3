"""The engine against other solvers: the paper's whole path from the same starts, in one run.

    python benchmarks/solvers.py [--starts 10] [--out benchmarks/results] [--update-baseline]

Solvers whose extra is not installed are skipped with a line. Ratios of medians and objectives are
compared with `baseline.json`; exit code 1 when a gate fails. Seconds are printed, never gated.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.answer.provenance import versions
from dualarm_pin.bench.columns import machine
from dualarm_pin.errors import MissingExtraError
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.files.write import write_text
from dualarm_pin.problem import Problem
from dualarm_pin.search.starts import common_postures, generator
from dualarm_pin.solution import Solution, distinct
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.solvers import slsqp as nlopt_slsqp
from dualarm_pin.task import Task

Array = NDArray[np.float64]
Solver = Callable[[Problem, Array], Solution]
HERE = Path(__file__).parent
REPEATS = 5  # of the engine alone: its milliseconds are near what a busy machine adds


@dataclass
class Column:
    """One solver on one set of starts."""

    name: str
    solve: Solver
    seconds: list[float] = field(default_factory=list)
    objectives: list[float] = field(default_factory=list)

    def run(self, problem: Problem, start: Array) -> None:
        """Solve once and note what came of it; infinite for an end that is not feasible."""
        end = self.solve(problem, start)
        self.seconds.append(end.wall_s)
        self.objectives.append(end.objective if end.feasible else float("inf"))

    @property
    def median(self) -> float:
        """Median seconds a start, those that failed included."""
        return float(np.median(self.seconds))

    @property
    def successes(self) -> int:
        """Starts that ended feasible."""
        return int(np.isfinite(self.objectives).sum())


def main() -> int:
    """Run, print, draw, compare; return the exit code."""
    arguments = parse()
    task = Task.load(urdf_folder() / "tasks" / "paper_corner.yaml")
    engine.ensure_compiled(print)
    groups = {
        "P31 anchored": (task.problem(), anchored_starts(task.problem(), arguments.starts)),
        "P31 random": (task.problem(), random_starts(task.problem(), arguments.starts)),
        "P6 random": (first_stage(task), random_starts(first_stage(task), arguments.starts)),
    }
    report: dict[str, dict[str, dict[str, float]]] = {}
    for name, (problem, starts) in groups.items():
        columns = solvers(problem, whole=name.startswith("P31"))
        for number, start in enumerate(starts):  # interleaved, so that all see the same machine
            for column in columns:
                for _ in range(REPEATS if column.name == "engine" else 1):
                    column.run(problem, start)
            show_progress(name, number + 1, len(starts))
        report[name] = summarise(columns)
        print_table(name, columns)
    record = {
        "groups": report,
        "versions": versions() | peer_versions(),
        "machine": machine() | {"host": ""},
    }
    print("versions:", ", ".join(f"{k} {v}" for k, v in record["versions"].items()))
    print("machine:", ", ".join(str(v) for v in record["machine"].values() if v))
    write_text(arguments.out / "solvers.json", json.dumps(record, indent=1) + "\n")
    draw(report, arguments.out / "solvers.svg")
    return compare(report, arguments.baseline, record if arguments.update_baseline else None)


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=10)
    parser.add_argument("--out", type=Path, default=HERE / "results")
    parser.add_argument("--baseline", type=Path, default=HERE / "baseline.json")
    parser.add_argument("--update-baseline", action="store_true")
    return parser.parse_args()


def anchored_starts(problem: Problem, count: int) -> Array:
    """Distinct minima of the middle point alone, best first, copied to all points."""
    middle = problem.k // 2
    drawn = common_postures(problem.lower, problem.upper, 1, 300, generator(0, 1))
    alone = engine.solve_many(problem, drawn, points=[middle] * len(drawn))
    return np.repeat(distinct(alone).ends.q[:count], problem.k, axis=1)


def random_starts(problem: Problem, count: int) -> Array:
    """One random posture for all points of a start."""
    return common_postures(problem.lower, problem.upper, problem.k, count, generator(0, 2))


def first_stage(task: Task) -> Problem:
    """The paper's first stage: 6 points."""
    links = task.link_weights(task.Gamma, task.stage_1_smoothness)
    return task.problem().subset(task.Gamma, links)


def solvers(problem: Problem, whole: bool) -> list[Column]:
    """The engine, and the peers that are installed."""
    if not whole:
        return [Column("engine", engine.solve), Column("NLopt SLSQP", nlopt_slsqp.solve)]
    found = [Column("engine", engine.solve)]
    from casadi_columns import casadi_solver
    from drake_snopt import snopt_solver

    for name, make in (
        ("CasADi + IPOPT", lambda: casadi_solver(problem, "ipopt", expand=False)),
        ("IPOPT, expanded", lambda: casadi_solver(problem, "ipopt", expand=True)),
        ("CasADi + fatrop", lambda: casadi_solver(problem, "fatrop", expand=False)),
        ("fatrop, expanded", lambda: casadi_solver(problem, "fatrop", expand=True)),
        ("Drake SNOPT", lambda: snopt_solver(problem)),
    ):
        try:
            found.append(Column(name, make()))
        except MissingExtraError as error:
            print(f"SKIPPED {name}: {error}")
    return found


def summarise(columns: list[Column]) -> dict[str, dict[str, float]]:
    reference = columns[0].median
    return {
        column.name: {
            "median_s": column.median,
            "ratio": column.median / reference,
            "success": column.successes / len(column.objectives),
            "best": min(column.objectives),
        }
        for column in columns
    }


def print_table(name: str, columns: list[Column]) -> None:
    print(f"\n{name}: {len(columns[-1].seconds)} starts")
    print(f"{'solver':18}{'median ms':>11}{'engine is faster':>18}{'success':>9}{'best':>11}")
    for solver, row in summarise(columns).items():
        print(
            f"{solver:18}{1e3 * row['median_s']:11.2f}{row['ratio']:17.1f}x"
            f"{row['success']:9.0%}{row['best']:11.5f}"
        )
    sys.stdout.flush()


def show_progress(name: str, done: int, total: int) -> None:
    if sys.stderr.isatty():
        print(f"\r{name}: start {done} of {total} ", end="", file=sys.stderr, flush=True)


def peer_versions() -> dict[str, str]:
    from importlib.metadata import PackageNotFoundError, version

    found = {}
    for name in ("casadi", "drake"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def draw(report: dict[str, dict[str, dict[str, float]]], file: Path) -> None:
    """Medians as bars on a logarithmic axis."""
    import matplotlib as mpl

    mpl.use("svg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(
        len(report),
        1,
        figsize=(7.0, 1.1 + 0.42 * sum(map(len, report.values()))),
        sharex=True,
        gridspec_kw={"height_ratios": [len(rows) for rows in report.values()]},
    )
    for axis, (group, rows) in zip(axes, report.items(), strict=True):
        names = list(rows)[::-1]
        values = [1e3 * rows[name]["median_s"] for name in names]
        colours = ["#0072B2" if name == "engine" else "#8a8f98" for name in names]
        axis.barh(names, values, color=colours)
        for place, (name, value) in enumerate(zip(names, values, strict=True)):
            text = f" {value:.3g} ms, {rows[name]['success']:.0%} of the starts"
            axis.text(value, place, text, va="center", fontsize=8)
        axis.set_xscale("log")
        axis.set_xlim(0.3, max([*values, 100.0]) * 30)
        axis.set_title(group, loc="left", fontsize=9)
        axis.spines[["top", "right"]].set_visible(False)
    axes[-1].set_xlabel("median time of a start [ms]")
    figure.tight_layout()
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file)
    plt.close(figure)


def compare(
    report: dict[str, dict[str, dict[str, float]]], file: Path, update: dict[str, object] | None
) -> int:
    """Hold the run against the gates of the baseline; return 1 if one fails."""
    baseline = json.loads(file.read_text(encoding="utf-8"))
    failed = 0
    print()
    for gate in baseline["gates"]:
        row = report[gate["group"]].get(gate["solver"])
        what = f"{gate['group']}, {gate['solver']}: {gate['figure']}"
        if row is None:
            print(f"gate skipped: {what} ({gate['solver']} is not installed)")
            continue
        value = row[gate["figure"]]
        low, high = gate.get("at_least", -np.inf), gate.get("at_most", np.inf)
        holds = low <= value <= high
        failed += not holds
        limit = f"at least {low:g}" if "at_least" in gate else f"at most {high:g}"
        before = baseline["measured"]["groups"].get(gate["group"], {}).get(gate["solver"], {})
        was = f", baseline {before[gate['figure']]:.6g}" if gate["figure"] in before else ""
        print(f"gate {'holds' if holds else 'FAILED'}: {what} = {value:.6g} ({limit}{was})")
    if update is not None:
        baseline["measured"] = update
        write_text(file, json.dumps(baseline, indent=1) + "\n")
        print(f"written to {file}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
