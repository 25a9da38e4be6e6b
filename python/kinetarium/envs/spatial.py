"""Bodies of all worlds as MuJoCo tells of them: about the centre of mass of all of them, along the world's
axes."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

import kinetarium as kn
from kinetarium.state import State

Array = np.ndarray[Any, np.dtype[Any]]

# Pairs of axes, in MuJoCo's order of a symmetric matrix.
_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def coordinate_orders(model: kn.Model) -> tuple[Array, Array]:
    """Which of kinetarium's coordinates each of MuJoCo's is, and the other way round.

    They differ in quaternions: w is first in MuJoCo's, last in kinetarium's.
    """
    order = np.arange(model.coordinates)
    for name in model.joint_names:
        _, end = model.joint_coordinates(name)
        kind = model.joint_kinds[model.joint(name)]
        if kind in ("free", "ball"):
            order[end - 4 : end] = [end - 1, end - 4, end - 3, end - 2]
    return order, np.argsort(order)


class Masses:
    """Masses and inertias of the bodies, of shape (numbers…, bodies, 1)."""

    def __init__(self, model: kn.Model, dtype: Any) -> None:
        def rows(parameter: str) -> Array:
            return np.ascontiguousarray(model.parameter(parameter).T[..., None], dtype=dtype)

        self.mass = rows("body_mass")[0]
        self.center = rows("body_center")
        self.inertia = rows("body_inertia").reshape(3, 3, -1, 1)


def _rows(array: Array) -> Array:
    """(worlds, bodies, numbers) → (numbers, bodies, worlds), contiguous: worlds side by side, for long
    loops."""
    return np.ascontiguousarray(array.transpose(2, 1, 0))


def _cross(a: Array, b: Array) -> Array:
    """Cross product along the first axis."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


class Bodies:
    """Bodies of all worlds, as arrays of shape (numbers, bodies, worlds), from their positions x and
    rotations R.

    A body's centre is at c = x + R c₀, that of all at C = Σ m c / Σ m, and the arm between is d = c − C.
    """

    def __init__(self, masses: Masses, state: State) -> None:
        self._masses, self._state = masses, state
        position = _rows(state.read("body_position"))
        r, c = self.rotation, masses.center
        self.position = position
        self.center = np.stack([position[i] + r[i][0] * c[0] + r[i][1] * c[1] + r[i][2] * c[2] for i in range(3)])

    @cached_property
    def rotation(self) -> list[list[Array]]:
        """R of the quaternions x, y, z, w (Shoemake 1985)."""
        x, y, z, w = _rows(self._state.read("body_orientation"))
        xx, yy, zz = 2 * x * x, 2 * y * y, 2 * z * z
        xy, xz, yz = 2 * x * y, 2 * x * z, 2 * y * z
        wx, wy, wz = 2 * w * x, 2 * w * y, 2 * w * z
        return [
            [1 - yy - zz, xy - wz, xz + wy],
            [xy + wz, 1 - xx - zz, yz - wx],
            [xz - wy, yz + wx, 1 - xx - yy],
        ]

    @cached_property
    def center_of_all(self) -> Array:
        """C [m], shape (3, worlds)."""
        share = self._masses.mass / self._masses.mass.sum()
        center = np.zeros((3, self.center.shape[2]), self.center.dtype)
        for body, part in enumerate(share):  # in this order for any number of worlds, which a sum of numpy is not
            center += part * self.center[:, body]
        return center

    @cached_property
    def arm(self) -> Array:
        """d [m], shape (3, bodies, worlds)."""
        return self.center - self.center_of_all[:, None]

    def inertia(self) -> Array:
        """`cinert` but for the world's row: R I R^T + m (d·d 1 − d d^T) as xx, yy, zz, xy, xz, yz; m d; m.
        Shape (worlds, bodies, 10)."""
        m, inertia, r, d = self._masses.mass, self._masses.inertia, self.rotation, self.arm
        out = np.empty((10, *d.shape[1:]), d.dtype)
        turned = [[sum(r[i][k] * inertia[k, j] for k in range(3)) for j in range(3)] for i in range(3)]
        np.multiply(m, d, out=out[6:9])
        square = out[6:9] * d
        whole = square.sum(axis=0)
        for row, (i, j) in enumerate(_PAIRS):
            own = turned[i][0] * r[j][0] + turned[i][1] * r[j][1] + turned[i][2] * r[j][2]
            np.add(own, whole - square[i] if i == j else -out[6 + i] * d[j], out=out[row])
        out[9] = m
        return out.transpose(2, 1, 0)

    def velocity(self) -> Array:
        """`cvel` but for the world's row: ω, and v + ω × (C − x), the velocity that the body has at C. Shape
        (worlds, bodies, 6)."""
        angular = _rows(self._state.read("body_angular_velocity"))
        linear = _rows(self._state.read("body_velocity"))
        linear += _cross(angular, self.center_of_all[:, None] - self.position)
        return np.concatenate([angular, linear]).transpose(2, 1, 0)

    def about_center(self, wrench: Array) -> Array:
        """Forces f and torques t about the world's origin as torques about C, t − C × f, and forces; shape
        (worlds, bodies, 6)."""
        rows = _rows(wrench)
        force, torque = rows[:3], rows[3:]
        torque -= _cross(self.center_of_all[:, None], force)
        about = np.empty_like(wrench)
        about[..., :3] = torque.transpose(2, 1, 0)
        about[..., 3:] = force.transpose(2, 1, 0)
        return about
