"""Are an index's derivatives right? Compare them with differences."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dualarm_pin.errors import InputError
from dualarm_pin.indices.custom import difference_curvature, difference_gradient
from dualarm_pin.indices.index import Index


@dataclass(frozen=True)
class DerivativeReport:
    """How far derivatives are from central differences, over all samples.

    Attributes:
        name: Of the index.
        gradient_error: Largest difference, as a share of the largest entry (at least 1e-6).
        curvature_error: The same for the curvature.
        samples: How many random A were tried.
        tolerance: What is allowed.
    """

    name: str
    gradient_error: float
    curvature_error: float
    samples: int
    tolerance: float

    @property
    def passed(self) -> bool:
        """Whether both agree."""
        return max(self.gradient_error, self.curvature_error) <= self.tolerance

    def __str__(self) -> str:
        verdict = "agree" if self.passed else "DISAGREE"
        return (
            f"index {self.name!r}: derivatives {verdict} with central differences at "
            f"{self.samples} points: gradient {self.gradient_error:.1e}, curvature "
            f"{self.curvature_error:.1e} (allowed {self.tolerance:.0e})"
        )


def check_derivatives(
    index: Index, n: int = 20, seed: int = 0, tolerance: float = 1e-4, *, strict: bool = False
) -> DerivativeReport:
    """Compare gradient and curvature of an index with central differences.

    Args:
        index: Any index.
        n: How many random A = J J^T, u and D.
        seed: Of the random numbers.
        tolerance: Largest relative difference allowed.
        strict: Raise instead of returning a report that did not pass.

    Raises:
        InputError: n is below 1, phi is not finite at a random A, or `strict` and the derivatives
            disagree.
    """
    if n < 1:
        raise InputError(f"is {n}, must be 1 or more", field="n")
    rng = np.random.default_rng(seed)
    worst_gradient = worst_curvature = 0.0
    for _ in range(n):
        J = rng.normal(size=(6, 12))
        if index.task_weights is not None:
            J *= np.sqrt(index.task_weights)[:, None]
        A, u = J @ J.T, rng.normal(size=6)
        D = rng.normal(size=(6, 12)) * np.where(np.diag(A) > 0.0, 1.0, 0.0)[:, None]
        D = J @ D.T + D @ J.T
        if not np.isfinite(index.phi(A, u)):
            raise InputError(f"phi is {index.phi(A, u)} at a regular A", field=index.name)
        G = index.gradient(A, u)
        differences = _on_rows(A, difference_gradient(index.phi, 1e-6)(A, u))
        worst_gradient = max(worst_gradient, _error(_on_rows(A, G), differences))
        C = index.curvature(A, u, D)
        differences = difference_curvature(index.gradient, 1e-6)(A, u, D)
        worst_curvature = max(worst_curvature, _error(C, differences))
    report = DerivativeReport(index.name, worst_gradient, worst_curvature, n, tolerance)
    if strict and not report.passed:
        raise InputError(str(report), field=index.name)
    return report


def _on_rows(A: np.ndarray, G: np.ndarray) -> np.ndarray:
    """Return G with rows and columns of weight 0 left out: phi is not defined off them."""
    left = np.diag(A) > 0.0
    return np.where(np.outer(left, left), G, 0.0)


def _error(value: np.ndarray, differences: np.ndarray) -> float:
    return float(np.max(np.abs(value - differences)) / max(np.max(np.abs(differences)), 1e-6))
