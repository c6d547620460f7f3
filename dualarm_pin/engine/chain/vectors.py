"""Small vectors and quaternions as tuples, which the compiler keeps in registers.

A quaternion is (w, x, y, z), scalar first.
"""

from __future__ import annotations

from dualarm_pin.engine.jit.compiled import compiled

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


@compiled
def dot(a: Vector, b: Vector) -> float:
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled
def cross(a: Vector, b: Vector) -> Vector:
    """Return a x b."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@compiled
def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """Return the quaternion product a b."""
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


@compiled
def turn_about_z(a: Quaternion, sine: float, cosine: float) -> Quaternion:
    """Return a (cosine, 0, 0, sine): a turn about the local z by twice that angle."""
    return (
        a[0] * cosine - a[3] * sine,
        a[1] * cosine + a[2] * sine,
        a[2] * cosine - a[1] * sine,
        a[3] * cosine + a[0] * sine,
    )


@compiled
def z_axis(a: Quaternion) -> Vector:
    """Return the third column of the rotation matrix of a unit quaternion."""
    return (
        2.0 * (a[1] * a[3] + a[0] * a[2]),
        2.0 * (a[2] * a[3] - a[0] * a[1]),
        1.0 - 2.0 * (a[1] * a[1] + a[2] * a[2]),
    )


@compiled
def rotate(a: Quaternion, x: Vector) -> Vector:
    """Return x turned by a unit quaternion: x + 2 s (v x x) + 2 v x (v x x)."""
    v = (a[1], a[2], a[3])
    t = cross(v, x)
    c = cross(v, t)
    return (
        x[0] + 2.0 * (a[0] * t[0] + c[0]),
        x[1] + 2.0 * (a[0] * t[1] + c[1]),
        x[2] + 2.0 * (a[0] * t[2] + c[2]),
    )
