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
# # 2. Your own cell
#
# A *cell* is two arms that share one task. This lesson builds one from two URDF files, writes the
# same one as a file, asks where the second robot should stand, and shows what happens when
# something is wrong: with your robots, most of your first hour will be spent there.

# %%
# %matplotlib inline
import tempfile
from pathlib import Path

import numpy as np
import pinocchio as pin

import dualarm_pin as dp
from dualarm_pin.errors import MissingExtraError

ns16 = dp.urdf_folder() / "ns16" / "ns16.urdf"
folder = Path(tempfile.mkdtemp())

# %% [markdown]
# ## Two URDFs and the pose between them
#
# What has to be said, and what follows from it:
#
# * **tips**: the link of each arm that carries its tool. The chain from the root to the tip moves;
#   every other joint of the URDF stands still.
# * **base2**: the pose of the second root in the first, $\mathbf T_{b_1 b_2}$ in eq. (10). Here
#   the robots do not face each other as in the paper: they stand around a corner.
# * **tools**: the pose of each tool frame in its tip. $e_1$ and $e_2$ are these frames.
# * **limits**: bounds that are tighter than those of the URDF, in radians.

# %%
limits = {
    name: tuple(np.radians(bounds))
    for name, bounds in {
        "joint_1": (-60, 60),
        "joint_2": (-45, 90),
        "joint_3": (-150, 45),
        "joint_4": (-90, 90),
        "joint_5": (-90, 90),
        "joint_6": (-90, 90),
    }.items()
}


def placed(x: float, y: float, yaw_deg: float) -> pin.SE3:
    """Return a pose on the floor."""
    return pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.0, np.radians(yaw_deg)), np.array([x, y, 0.0]))


spindle = pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.2]))  # a tool, 20 cm along z of the flange
cell = dp.Cell.from_urdf(
    ns16,
    ns16,
    base2=placed(1.6, 1.6, -90),
    tips=("flange", "flange"),
    tools=(None, spindle),
    limits=limits,
    name="around the corner",
)
for joint in cell.joints:
    lower, upper = np.degrees([joint.lower, joint.upper])
    print(f"{joint.name:14} {joint.kind:9} {lower:6.1f} to {upper:5.1f} deg")
assert cell.n == 12

# %% [markdown]
# **Never trust a cell that you have not checked.** The relative pose (10) is the product of three:
# out of the first arm backwards, across the floor, and up the second arm. Compute it by hand at
# some posture and compare.

# %%
q = np.random.default_rng(1).uniform(cell.lower, cell.upper)
data = cell.model.createData()
pin.framesForwardKinematics(cell.model, data, cell.model_q(q))
by_hand = data.oMf[cell.e1].inverse() * data.oMf[cell.e2]
assert by_hand.isApprox(dp.Relative(cell, q).T_e1_e2, 1e-12)

at_rest = dp.Relative(cell, np.zeros(cell.n)).T_e1_e2.translation
print("with all joints at zero, e2 is", np.round(at_rest, 3), "m from e1, in the axes of e1")

# %% [markdown]
# On the command line, `dualarm-pin check CELL.yaml` says all of this in words, with reach and
# collision pairs.
#
# ## A path on the part
#
# The path is drawn in $e_1$, so it moves with the part. A circle of 10 cm radius, 20 cm above the
# flange; by default the tools face each other, as in the paper. Then plan.

# %%
path = dp.paths.circle(0.1, height=0.2, points=21)
task = dp.Task(cell, path)
best = dp.plan_global(task, effort="quick", seed=0)

print(f"found {best.found}, mean c {best.mean_index:.3f} m^2, largest {best.max_index:.3f}")
print(f"distance between the arms {best.arm_clearance:.3f} m")
assert best.found
assert 0.3 < best.mean_index < 1.0

# %%
dp.show.Player(task, {"around the corner": best}, title=cell.name, at=0.3)

# %% [markdown]
# `found` is decided by a check with Pinocchio, not by the solver. It takes three lines to do so
# again, and it is a good habit:

# %%
worst = max(
    np.linalg.norm(dp.Relative(cell, row).T_e1_e2.translation - path.position[i])
    for i, row in enumerate(best.q)
)
print(f"largest distance from the path: {worst:.1e} m")
assert worst < 1e-6
assert np.all(best.q >= cell.lower - 1e-9) and np.all(best.q <= cell.upper + 1e-9)

# %% [markdown]
# ## The same as a file
#
# A file can be kept beside the URDF, reviewed, and solved from the command line. Angles are in
# degrees there, and say so in their names.

# %%
(folder / "cell.yaml").write_text(f"""\
arms:
  arm1:
    urdf: {ns16}
    tip: flange
    limits_deg: &limits
      joint_1: [-60, 60]
      joint_2: [-45, 90]
      joint_3: [-150, 45]
      joint_4: [-90, 90]
      joint_5: [-90, 90]
      joint_6: [-90, 90]
  arm2:
    urdf: {ns16}
    tip: flange
    base: {{xyz: [1.6, 1.6, 0], rpy_deg: [0, 0, -90]}}
    tool: {{xyz: [0, 0, 0.2]}}
    limits_deg: *limits
""")
(folder / "task.yaml").write_text("""\
cell: cell.yaml
path:
  circle: {radius: 0.1, height: 0.2, points: 21}
index: {force: {direction: tangent}}
smoothness: 3.0
""")

from_file = dp.Task.load(folder / "task.yaml")
again = dp.plan_global(from_file, effort="quick", seed=0)
print(f"mean c {again.mean_index:.4f}, from Python {best.mean_index:.4f}")
assert np.isclose(again.objective, best.objective, rtol=1e-6)

# %% [markdown]
# ## When something is wrong
#
# Every message names the file, the line and the field, says what was given, and what would be
# right. Misspell a joint:

# %%
text = (folder / "cell.yaml").read_text()
(folder / "typo.yaml").write_text(text.replace("joint_3:", "joint3:"))

try:
    dp.Cell.load(folder / "typo.yaml")
except dp.DualArmError as error:
    message = str(error).replace(str(folder), "...")
    print(message)
assert "joint_3" in message and "typo.yaml" in message

# %% [markdown]
# And a task may be out of reach. That is no error, it is an answer: `found` is False, and the
# message names the first point without a posture.

# %%
far = dp.Cell.from_urdf(ns16, ns16, base2=placed(4.5, 0.0, 180), limits=limits)
nothing = dp.plan_global(dp.Task(far, path), effort="quick", starts=20, seed=0)
print(nothing.message)
assert not nothing.found
assert "no solution" in nothing.message

# %% [markdown]
# ## Where should the second robot stand?
#
# Since a quick plan takes about a second, ask it. Slide the second robot along the diagonal and
# plan anew at each place.

# %%
distances = [1.4, 1.5, 1.6, 1.7]
plans = []
for d in distances:
    there = dp.Cell.from_urdf(
        ns16, ns16, base2=placed(d, d, -90), tools=(None, spindle), limits=limits
    )
    plans.append(dp.plan_global(dp.Task(there, path), effort="quick", seed=0))

print("base [m]  mean c [m^2]  between the arms [m]")
for d, plan in zip(distances, plans, strict=True):
    print(f"{d:8.2f}  {plan.mean_index:12.3f}  {plan.arm_clearance:20.3f}")
assert all(plan.found for plan in plans)

# %%
dp.show.plots.figure_index(
    {f"base at {d:.1f} m": plan for d, plan in zip(distances, plans, strict=True)},
    title="The same circle from four places",
    along="arc_length",
)

# %% [markdown]
# **Read both columns.** The index asks for short lever arms, and short lever arms bring the two
# robots close together. Distances are computed at every point and reported, but they are *not* a
# constraint of the search: an answer with a negative distance is a collision, however good its
# $c$. The distance is that of convex hulls, so it is never too optimistic. Lesson 5 makes a table
# of this kind with a suite file.
#
# ## Robots of others
#
# Robots of the package `example-robot-data` (extra `robots`) are found under their `package://`
# names. A Panda has seven joints and a UR5 six, so here are 13 joints and 6 equations. If the
# package is not installed, this part says so and is skipped.

# %%
robots = "package://example-robot-data/robots/"
try:
    mixed = dp.Cell.from_urdf(
        robots + "panda_description/urdf/panda.urdf",
        robots + "ur_description/urdf/ur5_robot.urdf",
        base2=placed(1.2, 0.0, 180),
        tips=("panda_hand_tcp", "tool0"),
        tools=(None, spindle),
        name="Panda and UR5",
    )
except MissingExtraError as error:
    mixed = None
    print(f"skipped: {error}")

shown = None
if mixed is not None:
    zigzag = dp.paths.raster(0.12, 0.06, 3, fillet=0.01, height=0.1, points=31)
    asked = dp.Task(mixed, zigzag)
    answer = dp.plan_global(asked, effort="quick", seed=0)
    print(f"{mixed.n} joints, found {answer.found}, mean c {answer.mean_index:.4f} m^2")
    print(f"between the arms {answer.arm_clearance:.3f} m")
    assert answer.found and mixed.n == 13 and answer.arm_clearance > 0
    shown = dp.show.Player(asked, {"zigzag": answer}, title=mixed.name, at=0.5)
shown

# %% [markdown]
# ## Exercises
#
# 1. Turn the second robot: `placed(1.6, 1.6, -110)`. Which of its joints reach a bound?
#    (`dp.show.plots.figure_joints(cell, {"": best})`)
# 2. A spindle may spin: `circle(0.1, height=0.2, points=21, free="spin")` leaves the rotation
#    about the tool axis open. How much does $c$ gain from one more free direction?
# 3. Write a cell file for your own robots and run `dualarm-pin check` on it. Do reach and bounds
#    look as in the data sheet?
