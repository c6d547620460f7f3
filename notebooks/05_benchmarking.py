# ---
# jupyter:
#   jupytext:
#     cell_metadata_filter: -all
#     formats: ipynb,py:percent
#     notebook_metadata_filter: kernelspec,jupytext,-jupytext.text_representation.jupytext_version
#     text_representation:
#       extension: .py
#       format_name: percent
#       format_version: '1.3'
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # 5. Benchmarking
#
# One run of one method with one seed is an anecdote. A *suite* is a file that says which tasks,
# methods, seeds and variants to run; the runs are spread over the processors, every one becomes a
# row of one table, failed ones included, and gates turn the table into a yes or a no. This lesson
# makes a tiny one: three methods, then a small map of where to put the second robot.
#
# It needs the extra `bench` (`pip install 'dualarm-pin[bench]'`).

# %%
# %matplotlib inline
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import dualarm_pin as dp
from dualarm_pin.bench.batch import run_suite
from dualarm_pin.bench.suite import Suite

folder = Path(tempfile.mkdtemp())
corner = dp.urdf_folder() / "tasks" / "paper_corner.yaml"

# %% [markdown]
# ## A suite
#
# Each combination of task, variant, method and seed is a run. Every run has a budget in seconds
# and its own process: one that hangs or dies costs its row, not the batch.
#
# `gates` are what you *expect*, written down before you look. A gate names a column of the table,
# a comparison and a number, and may be meant for one method only.

# %%
(folder / "methods.yaml").write_text(f"""\
title: Three methods on the paper's corner
tasks: [{corner}]
methods:
  - {{method: global, effort: quick}}
  - {{method: local, solver: qp}}
  - {{method: local, solver: free}}
seeds: 2
time_limit: 120
gates:
  - {{gate: mean_index <= 0.41, method: "global*"}}
  - {{gate: max_bound_violation <= 1e-9, method: "global*"}}
  - {{gate: mean_index > 0.8, method: "local*", of: best}}
limitations:
  - Two seeds are enough for a lesson, not for a claim.
""")
suite = Suite.load(folder / "methods.yaml")
print(f"{suite.title}: {len(suite.runs)} runs, {len(suite.gates)} gates")
assert len(suite.runs) == 6

# %%
batch = run_suite(suite, folder / "methods", jobs=2)
print(dict(batch.counts))

print(f"{'method':18} seed  found  mean c  objective  bounds [deg]  seconds")
for row in batch.rows:
    print(
        f"{row['method']:18} {row['seed']:4}  {row['found']!s:5}  {row['mean_index']:6.3f}  "
        f"{row['objective']:9.3f}  {np.degrees(row['max_bound_violation']):12.1f}  "
        f"{row['timing.wall_s']:7.2f}"
    )
assert batch.counts == {"ok": 4, "not_found": 2}

# %% [markdown]
# **Three habits of an honest table.**
#
# * *Compare like with like.* `local free` ignores the joint bounds, so its mean counts only
#   together with the column beside it. `found` is False there, its status is `not_found`, and the
#   row stays.
# * *Every seed counts.* `local` depends on where it starts, and a single seed would have told half
#   the story; `global` gives the same answer for both seeds, which is the point of it.
# * *Judge what the method was asked for.* Means of $c$ may be compared between all rows;
#   objectives too, since (19) is computed by the same code for each of them.
#
# And the gates:

# %%
for gate, failure in batch.gates:
    print(f"{'holds' if failure is None else 'FAILED':6}  {gate.text}")
assert batch.passed

# %% [markdown]
# `dualarm-pin bench SUITE.yaml` prints the same and exits with 1 if a gate fails, which is all
# that a CI needs. The rows are on disk: `rows.jsonl` as they ended, `results.csv` and
# `results.parquet` for your tools, and the best trajectory of each task as a result folder, ready
# for `dualarm-pin view`.

# %%
print(sorted(str(f.relative_to(folder)) for f in (folder / "methods").glob("*")))
task, best = dp.load_result(next((folder / "methods" / "best").iterdir()))
print(f"best: mean c {best.mean_index:.4f} by {best.method}")
assert abs(best.mean_index - 0.4063) < 1e-3

# %% [markdown]
# ## Stop and go on
#
# A batch may be interrupted at any time. Running it again with `resume=True` (`--resume`) does
# only what has no row yet: here nothing, so it takes no time. Runs are recognised by their
# content: change the task and they are new runs; rename it and they are not.

# %%
again = run_suite(suite, folder / "methods", resume=True)
print(f"{again.done_before} of {len(again.rows)} runs were there already")
assert again.done_before == 6

# %% [markdown]
# ## A map: where should the second robot stand?
#
# `overrides` change any field of the task; keys that begin with `cell.` reach into the cell. A
# `grid` makes every combination. Base distance times $\lambda$, nine quick plans:

# %%
(folder / "placement.yaml").write_text(f"""\
title: Base distance and smoothness
tasks: [{corner}]
methods:
  - {{method: global, effort: quick}}
time_limit: 120
overrides:
  grid:
    cell.arms.arm2.base.xyz.0: {{first: 2.3, last: 2.7, count: 3}}
    smoothness: [0.3, 3.0, 30.0]
""")
placement = run_suite(Suite.load(folder / "placement.yaml"), folder / "placement", jobs=2)
print(dict(placement.counts))
assert placement.counts["ok"] == 9

# %%
distances, weights = [2.3, 2.5, 2.7], [0.3, 3.0, 30.0]
mean = np.full((3, 3), np.nan)
step = np.full((3, 3), np.nan)
for row in placement.rows:
    k = distances.index(row["set"]["cell.arms.arm2.base.xyz.0"])
    m = weights.index(row["set"]["smoothness"])
    mean[k, m], step[k, m] = row["mean_index"], np.degrees(row["max_joint_step"])

figure = Figure(figsize=(6.4, 3.6), layout="constrained")
ax = figure.add_subplot()
for k, d in enumerate(distances):
    ax.plot(step[k], mean[k], "o-", color=dp.show.plots.COLOURS[k], label=f"base at {d:.1f} m")
    for m, weight in enumerate(weights):
        ax.annotate(f"{weight:g}", (step[k, m], mean[k, m]), (5, 5), textcoords="offset points")
ax.margins(0.08)
ax.set_xlabel("largest joint step [deg]")
ax.set_ylabel("mean index $c$ [m²]")
ax.legend(frameon=False, title="λ at the points")
figure

# %% [markdown]
# **Read it** from right to left: with larger $\lambda$ the steps get smaller and $c$ gets worse,
# and the place of the second robot shifts the whole curve. Nearer is better for $c$, but lesson 2
# has seen what that does to the distance between the arms: the column `min_clearance` is in the
# table too. Which point is best is a decision, not a computation: the table lays out what it
# costs.

# %%
at_paper = mean[distances.index(2.5), weights.index(3.0)]
print(f"the paper's place and smoothness: mean c {at_paper:.4f}")
assert abs(at_paper - 0.4063) < 1e-3
assert np.all(mean[:, 0] < mean[:, 2])  # a hundred times the weight costs something
assert np.all(mean > 0)

# %% [markdown]
# The best runs are kept as trajectories, so what looks odd in a table can be looked at:

# %%
by_weight = {}
for place in sorted((folder / "placement" / "best").iterdir()):
    placed_task, plan = dp.load_result(place)
    base = placed_task.record["cell"]["arms"]["arm2"]["base"]["xyz"][0]
    if base == 2.5:
        by_weight[placed_task.smoothness] = plan
assert len(by_weight) == 3
shown = {f"λ = {weight:g}": by_weight[weight] for weight in sorted(by_weight)}
dp.show.Player(task, shown, title="The same place, three weights", layout="overlay", at=1.0)

# %% [markdown]
# ## Exercises
#
# 1. Add `two-stage` with `starts: 10` to the first suite. What does a gate `found == true` say
#    with `of: every`?
# 2. Your own planner can take part: a method `call: module:function` is called as `function(task,
#    seed=...)` and returns a `Trajectory`. Let one return `plan_local(task, substeps=1)`.
# 3. `urdf/suites/` holds larger suites. Run one with `dualarm-pin bench`, stop it with Ctrl-C in
#    the middle, and go on with `--resume`.
