"""What a controller sets, in all worlds at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kinetarium.arrays import NamedArray, aligned, checked
from kinetarium.errors import UnknownNameError
from kinetarium.names import Strict, hint

if TYPE_CHECKING:
    from kinetarium._engine import DeviceArray, Engine
    from kinetarium.worlds import Worlds

_NAMES = {
    "force": "dof_names",
    "target_position": "dof_names",
    "target_velocity": "dof_names",
    "actuator": "actuator_names",
}


class Controls(Strict):
    """Controls of all worlds, as arrays that are written in place and hold until they are written again.

    Each is one array of the simulation's dtype that lives as long as the simulation: what stands in it when
    `Simulation.step` is called is what acts. Arrays that were never asked for are not copied. torch and jax take them
    by DLPack without a copy: what torch writes there acts.

    >>> import kinetarium as kn
    >>> sim = kn.Simulation(kn.examples.n_pendula(3), worlds=2)
    >>> sim.controls.force[:, "hinge1"] = 2.0
    >>> sim.controls.force
    NamedArray([[0., 2., 0.],
                [0., 2., 0.]], dtype=float32)
    """

    __slots__ = ("_arrays", "_worlds")

    def __init__(self, worlds: Worlds) -> None:
        self._worlds = worlds
        self._arrays: dict[str, NamedArray] = {}

    def __repr__(self) -> str:
        shapes = ", ".join(f"{name} {self._shape(name)}" for name in _NAMES)
        return f"<Controls of {self._worlds.model.name!r}: {shapes}>"

    def _shape(self, name: str) -> tuple[int, int]:
        return self._worlds.count, len(self._worlds.names(_NAMES[name]) or ())

    def on_device(self, name: str) -> DeviceArray:
        """A control of all worlds where it lies in the memory of a CUDA card, shape (worlds, degrees of freedom) or
        (worlds, actuators), to be written: what stands there when `Simulation.step` is called is what acts. It is not
        checked: a world that is given NaN diverges. `torch.from_dlpack` and the like take it without a copy.

            force = torch.from_dlpack(sim.controls.on_device("force"))
            force[:] = policy(observation)
            sim.step()

        From then on it is the card's: do not use the attribute of that name as well, whose array each step copies
        over it. What the array holds when this is called is copied first. Raises `DeviceError` where worlds are not
        on a CUDA card, and `UnknownNameError`.
        """
        if name not in _NAMES:
            raise UnknownNameError(f'there is no control "{name}"; {hint(name, list(_NAMES))}')
        engine = self._worlds.engine
        array = self._arrays.pop(name, None)
        if array is not None:
            engine.write_control(name, array)
        return engine.control_on_device(name, self._shape(name))

    def _array(self, name: str) -> NamedArray:
        engine = self._worlds.engine
        array = self._arrays.get(name)
        if array is None:
            numbers = aligned(self._shape(name), self._worlds.dtype)
            engine.read_control(name, numbers)
            array = self._arrays[name] = NamedArray.of(numbers, (None, self._worlds.names(_NAMES[name])))
        return array

    def _set(self, name: str, value: np.ndarray) -> None:
        array = self._array(name)
        if value is not array:  # `force += 1` has done it already
            array[...] = checked(name, value, array.shape, array.dtype)

    def _send(self, engine: Engine) -> None:
        """Gives the engine what stands in the arrays."""
        for name, array in self._arrays.items():
            engine.write_control(name, array)

    def _fetch(self, worlds: np.ndarray) -> None:
        """Takes what the engine has of worlds that were set; what was written for others stays."""
        for name, array in self._arrays.items():
            numbers = np.empty(array.shape, array.dtype)
            self._worlds.engine.read_control(name, numbers)
            np.asarray(array)[worlds] = numbers[worlds]

    @property
    def force(self) -> NamedArray:
        """Generalised forces [N or N·m], shape (worlds, degrees of freedom); zero at first."""
        return self._array("force")

    @force.setter
    def force(self, value: np.ndarray) -> None:
        self._set("force", value)

    @property
    def target_position(self) -> NamedArray:
        """Position targets of the drives [m or rad], shape (worlds, degrees of freedom); the model's at first."""
        return self._array("target_position")

    @target_position.setter
    def target_position(self, value: np.ndarray) -> None:
        self._set("target_position", value)

    @property
    def target_velocity(self) -> NamedArray:
        """Velocity targets of the drives [m/s or rad/s], shape (worlds, degrees of freedom); the model's at
        first."""
        return self._array("target_velocity")

    @target_velocity.setter
    def target_velocity(self, value: np.ndarray) -> None:
        self._set("target_velocity", value)

    @property
    def actuator(self) -> NamedArray:
        """Controls of the actuators, shape (worlds, actuators); zero at first. Those beyond an actuator's range
        act as its ends."""
        return self._array("actuator")

    @actuator.setter
    def actuator(self, value: np.ndarray) -> None:
        self._set("actuator", value)
