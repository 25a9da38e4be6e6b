"""Dynamics of trees as functions of their state."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

from kinetarium import _engine
from kinetarium._engine import Model
from kinetarium.arrays import checked, numbers, row
from kinetarium.errors import ShapeError


@dataclass(frozen=True)
class Bodies:
    """Placements and velocities of all bodies in world axes, float64, of states of the leading shape (…)."""

    position: np.ndarray
    """Origins of the bodies' frames [m], shape (…, bodies, 3)."""
    orientation: np.ndarray
    """Quaternions x, y, z, w, shape (…, bodies, 4)."""
    linear_velocity: np.ndarray
    """Velocities of those origins [m/s], shape (…, bodies, 3)."""
    angular_velocity: np.ndarray
    """[rad/s], shape (…, bodies, 3)."""


class Dynamics:
    """The equation of motion of a model that is a tree, M(q) q̈ + b(q, q̇) = τ, as functions.

    With n = `model.degrees_of_freedom`, positions q have the shape (…, coordinates), velocities q̇, accelerations
    q̈ and forces τ [N or N·m] (…, n), in the model's order; what leads is broadcast, and leads the results, float64.
    Quaternions may be of any length but zero. The model's own numbers count, not those a world was given. Nothing is
    stepped; contacts, limits, drives, springs and dampers act through τ alone.

    Raises `SimulationError` for models with loops, coupled or disabled joints; its methods `ShapeError`, and
    `SimulationError` for numbers that are not finite.

    >>> import kinetarium as kn
    >>> model = kn.examples.n_pendula(2)
    >>> dynamics = kn.Dynamics(model)
    >>> q = model.initial_position
    >>> weight = dynamics.inverse_dynamics(q)  # what holds it
    >>> bool(abs(dynamics.forward_dynamics(q, force=weight)).max() < 1e-9)
    True
    >>> dynamics.mass_matrix(q).shape, dynamics.jacobian(q, "link1").shape
    ((2, 2), (6, 2))
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self._engine = _engine.Dynamics(model)

    def __reduce__(self) -> tuple[type[Dynamics], tuple[Model]]:
        return type(self), (self.model,)

    def mass_matrix(self, position: ArrayLike) -> np.ndarray:
        """M(q), shape (…, n, n), with armatures: kinetic energy is ½ q̇ᵀ M q̇."""
        (q,), lead = self._states(position)
        n = self.model.degrees_of_freedom
        return self._engine.mass_matrix(q).reshape(*lead, n, n)

    def inverse_dynamics(
        self, position: ArrayLike, velocity: ArrayLike = 0.0, acceleration: ArrayLike = 0.0
    ) -> np.ndarray:
        """τ, shape (…, n): what it takes to accelerate so. At rest what holds the weight, with q̈ = 0 the bias b."""
        (q, v, a), lead = self._states(position, velocity=velocity, acceleration=acceleration)
        return self._engine.inverse_dynamics(q, v, a).reshape(*lead, self.model.degrees_of_freedom)

    def forward_dynamics(self, position: ArrayLike, velocity: ArrayLike = 0.0, force: ArrayLike = 0.0) -> np.ndarray:
        """q̈ = M⁻¹ (τ − b), shape (…, n), under these forces τ and weight."""
        (q, v, f), lead = self._states(position, velocity=velocity, force=force)
        return self._engine.forward_dynamics(q, v, f).reshape(*lead, self.model.degrees_of_freedom)

    def jacobian(
        self, position: ArrayLike, body: str | SupportsIndex, point: ArrayLike = (0.0, 0.0, 0.0)
    ) -> np.ndarray:
        """J(q), shape (…, 6, n), of points [m], shape (…, 3), in the frame of a body, given by name or row:
        (ω, ẋ) = J q̇ with the body's angular velocity ω and the point's velocity ẋ in world axes.

        A torque and a force there act as τ = Jᵀ (torque, force). Raises `UnknownNameError`, `OutOfRangeError`.
        """
        (q, p), lead = self._states(position, point=point)
        link = row("body", body, self.model.body, len(self.model.body_names))
        found = self._engine.jacobian(q, link, p)
        return found.reshape(*lead, 6, self.model.degrees_of_freedom)

    def bodies(self, position: ArrayLike, velocity: ArrayLike = 0.0) -> Bodies:
        """Where all bodies are, and how they move."""
        (q, v), lead = self._states(position, velocity=velocity)
        found = self._engine.bodies(q, v).reshape(*lead, len(self.model.body_names), 13)
        return Bodies(*np.split(found, [3, 7, 10], axis=-1))

    def _states(self, position: ArrayLike, **others: ArrayLike) -> tuple[list[np.ndarray], tuple[int, ...]]:
        """All as rows, and the shape that leads."""
        arrays = {what: numbers(what, array) for what, array in ({"position": position} | others).items()}
        try:
            lead = np.broadcast_shapes(*(array.shape[:-1] for array in arrays.values()))
        except ValueError:
            shapes = ", ".join(f"{what} {array.shape}" for what, array in arrays.items())
            raise ShapeError(f"what leads of these shapes does not go together: {shapes}") from None
        states, widths = [], {"position": self.model.coordinates, "point": 3}
        for what, array in arrays.items():
            columns = widths.get(what, self.model.degrees_of_freedom)
            states.append(checked(what, array, (*lead, columns)).reshape(math.prod(lead), columns))
        return states, lead
