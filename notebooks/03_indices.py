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
# # 3. Indices and what they mean
#
# Which posture is good depends on what you are going to do with it. Milling pushes: then the arms
# should turn joint torques into force. Deburring or painting runs: then they should turn joint
# speed into tool speed. Both are read off the same ellipsoid, and they want opposite things. This
# lesson looks at the ellipsoids, checks what the package computes against first principles, plans
# one path with several indices, and ends with an index of your own.

# %%
# %matplotlib inline
from dataclasses import replace

import numpy as np

import dualarm_pin as dp

task = dp.Task.load(dp.urdf_folder() / "tasks" / "paper_corner.yaml")
cell, path = task.cell, task.path
best = dp.plan_global(task, effort="quick", seed=0)
assert abs(best.mean_index - 0.4063) < 1e-3

# %% [markdown]
# ## One ball, two ellipsoids
#
# Take all joint speeds of length one, $\lVert\dot{\mathbf q}\rVert = 1$ (eq. 2). The relative
# Jacobian $\mathbf J$ maps this ball to the velocities of $e_2$ as seen from $e_1$: an ellipsoid
# whose half axes are the singular values of $\mathbf J$ (eq. 3). Forces go the other way,
# $\boldsymbol\tau = \mathbf J^T\boldsymbol\gamma$. All forces that need joint torques of length
# one are an ellipsoid too (eq. 5), with the *same axes and inverse lengths*. What is fast is weak.
#
# We look at the linear part, the first three rows.

# %%
i = 6  # the seventh point, in the middle of the first straight
q, u = best.q[i], path.u[i]
J = dp.Relative(cell, q).J_r
A = J @ J.T

axes, widths, _ = np.linalg.svd(J[:3])
print("half axes of the velocity ellipsoid:", np.round(widths, 3), "m")
print("half axes of the force ellipsoid:   ", np.round(1 / widths, 3), "1/m")

# %% [markdown]
# Along a direction $\mathbf u$ the two ellipsoids have the radii (eq. 6, 7)
#
# $$\alpha = (\mathbf u^T \mathbf A\,\mathbf u)^{-1/2}, \qquad
# \beta = (\mathbf u^T \mathbf A^{-1}\mathbf u)^{-1/2}, \qquad \mathbf A = \mathbf J\mathbf J^T .$$
#
# $\alpha$ is force per torque, $\beta$ speed per joint speed. The package minimises $1/\alpha^2$
# (`force`, the paper's $c$) and $1/\beta^2$ (`velocity`). Here is that $\beta$ is what it says:
# among all joint speeds that move the tool along $\mathbf u$, **and along nothing else**, the
# shortest has length $1/\beta$.

# %%
alpha = (u @ A @ u) ** -0.5
beta = (u @ np.linalg.inv(A) @ u) ** -0.5
print(f"alpha = {alpha:.3f} 1/m: {1 / alpha:.3f} Nm for 1 N;  beta = {beta:.3f} m")

q_dot = np.linalg.pinv(J) @ u  # the shortest joint speeds with J q_dot = u
assert np.isclose(np.linalg.norm(q_dot), 1 / beta)
assert np.isclose(np.linalg.norm(J.T @ u), 1 / alpha)
assert np.isclose(dp.indices.force().phi(A, u), 1 / alpha**2)
assert np.isclose(dp.indices.velocity().phi(A, u), 1 / beta**2)
assert beta <= 1 / alpha + 1e-12  # they meet only where u is an axis of the ellipsoid

# %% [markdown]
# Look at both along the best path for force. Orange is the force ellipsoid, blue the velocity
# ellipsoid, the arrow is $\mathbf u$. **What to look at:** the orange one stretches along the
# arrow, the blue one is thin there, and through the fillet they turn with it.

# %%
dp.show.Player(
    task,
    {"best for force": best},
    title="What is strong is slow",
    at=0.2,
    show=["force", "velocity"],
    height=520,
)

# %% [markdown]
# ## The same path, asked differently
#
# Only the index changes; cell, path and solver stay. Yoshikawa's $\sqrt{\det\mathbf A}$ is the
# volume of the ellipsoid: good in *all* directions, so $\mathbf u$ plays no part. All indices here
# are written so that **less is better**, so it comes with a minus sign. Its unit mixes metres and
# radians. To keep it clean, `task_weights` switches the three angular rows off: then it is a
# volume in m³.
#
# Two numbers are set beside each other with care. $\lambda$ weighs index against smoothness, and
# every index has its own scale, so $\lambda$ is chosen for each.

# %%
linear = (1, 1, 1, 0, 0, 0)
asked = {
    "force": (dp.indices.force(), 3.0),
    "velocity": (dp.indices.velocity(task_weights=linear), 3.0),
    "Yoshikawa": (dp.indices.yoshikawa(task_weights=linear), 30.0),
}
answers = {
    name: dp.plan_global(replace(task, index=index, smoothness=weight), effort="quick", seed=0)
    for name, (index, weight) in asked.items()
}
assert all(t.found for t in answers.values())

# %% [markdown]
# Now judge each answer by *every* index. In each column the smallest number is the best, and it
# should stand on the diagonal.


# %%
def mean_of(index: dp.indices.Index, q: np.ndarray) -> float:
    """Return the mean of an index over the path."""
    weights = np.ones(6) if index.task_weights is None else np.asarray(index.task_weights)
    values = []
    for row, direction in zip(q, path.u, strict=True):
        jacobian = np.sqrt(weights)[:, None] * dp.Relative(cell, row).J_r
        values.append(index.phi(jacobian @ jacobian.T, direction))
    return float(np.mean(values))


table = np.array([[mean_of(index, t.q) for index, _ in asked.values()] for t in answers.values()])
print(f"{'planned for':14}" + "".join(f"{name:>12}" for name in asked))
for name, row in zip(answers, table, strict=True):
    print(f"{name:14}" + "".join(f"{value:12.4f}" for value in row))

assert np.array_equal(np.argmin(table, axis=0), np.arange(3))
for name, t in answers.items():  # our own mean is that of the package
    assert np.isclose(mean_of(asked[name][0], t.q), t.mean_index)

# %% [markdown]
# **Read a row.** The posture that pushes best is by far the slowest along the path, and the
# fastest one pushes worst. Yoshikawa's index, asked about no direction in particular, lands beside
# speed: a large ellipsoid is a fast one. For milling it would be the wrong thing to ask for, by a
# factor of fifteen. If the direction is known, say so.

# %%
dp.show.plots.figure_index(
    {
        f"planned for {name}": dp.verified(task, t.q, method=t.method, solver=t.solver)
        for name, t in answers.items()
    },
    title="The force index of three answers",
)

# %%
dp.show.Player(
    task,
    {f"planned for {name}": t for name, t in answers.items()},
    title="Three indices",
    at=0.3,
    layout="side",
    height=520,
)

# %% [markdown]
# ## Near the middle of the joints
#
# A posture at its limits leaves nothing for corrections. `with_joint_centre(w)` adds $w \sum_k
# \bigl((q_k - \text{mid}_k)/\text{half range}_k\bigr)^2$ to any index. How much force does room
# for the joints cost?

# %%
centred = dp.plan_global(
    replace(task, index=dp.indices.force().with_joint_centre(0.1)), effort="quick", seed=0
)


def at_bounds(q: np.ndarray) -> int:
    """Return how many joint values lie on a bound."""
    return int(np.sum((q < cell.lower + 1e-6) | (q > cell.upper - 1e-6)))


before, after = mean_of(dp.indices.force(), best.q), mean_of(dp.indices.force(), centred.q)
print(f"force index {before:.3f} with {at_bounds(best.q)} values on their bounds")
print(f"force index {after:.3f} with {at_bounds(centred.q)} of them, with the centre term")
assert before < after
assert at_bounds(centred.q) < at_bounds(best.q)

# %% [markdown]
# ## An index of your own
#
# An index is a function $\varphi(\mathbf A, \mathbf u)$ of the $6\times6$ matrix and the
# direction. The solver needs its derivatives with respect to $\mathbf A$: the gradient
# $\partial\varphi/\partial\mathbf A$ and how it changes along a symmetric $\mathbf D$. Leave them
# out and they are taken by differences; give them, and it is faster and more exact. Then they
# should be *checked*, because a wrong derivative does not crash: it finds bad answers.
#
# Suppose we grind: the tool is pushed along the path, and pressed on the part just as hard. Let
# $\mathbf n = \mathbf e_z$ be the normal of the plane,
#
# $$\varphi = \mathbf u^T\mathbf A\,\mathbf u + \mathbf n^T\mathbf A\,\mathbf n .$$
#
# It is linear in $\mathbf A$, so the gradient is constant, $\mathbf u\mathbf u^T + \mathbf
# n\mathbf n^T$, and the curvature is zero.


# %%
def grind_phi(A, u):
    return np.dot(u, np.dot(A, u)) + A[2, 2]


def grind_gradient(A, u):
    G = np.outer(u, u)
    G[2, 2] += 1.0
    return G


def grind_curvature(A, u, D):
    return np.zeros((6, 6))


grind = dp.indices.custom("grind", grind_phi, grind_gradient, grind_curvature, units="m^2")
report = dp.indices.check_derivatives(grind)
print(report)
assert report.passed

# %% [markdown]
# And a slip of the pen, as it happens to all of us: a forgotten factor. The check sees it.


# %%
def slipped_gradient(A, u):
    G = np.outer(u, u)
    G[2, 2] += 2.0
    return G


wrong = dp.indices.check_derivatives(dp.indices.custom("slip", grind_phi, slipped_gradient))
print(wrong)
assert not wrong.passed

# %%
ground = dp.plan_global(replace(task, index=grind), effort="quick", seed=0)
for name, t in {"force": best, "grind": ground}.items():
    along, both = mean_of(dp.indices.force(), t.q), mean_of(grind, t.q)
    print(f"planned for {name}: along {along:.3f} m^2, onto the part {both - along:.3f} m^2")
assert ground.found
assert mean_of(grind, ground.q) < mean_of(grind, best.q)

# %% [markdown]
# ## Exercises
#
# 1. `indices.force(joint_weights=...)` takes a weight for each of the 12 joints: a motor with
#    twice the torque deserves a quarter. Make joints 4 to 6 of both arms weak (weight 4). Which
#    posture avoids them?
# 2. Add `indices.inverse_condition_number(task_weights=linear)` to the table. It asks for a
#    *round* ellipsoid. Is it closer to Yoshikawa or to force?
# 3. Minimise `-u @ A @ u` with `custom`. What do you call this index, and is it the same as
#    `velocity`? Compare $\beta$ and $1/\alpha$ along the two answers.
