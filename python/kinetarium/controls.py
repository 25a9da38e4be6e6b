"""What a controller sets, in all worlds at once."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from kinetarium.arrays import Assign, NamedArray, aligned, checked
from kinetarium.errors import SimulationError, UnknownNameError
from kinetarium.names import hint
from kinetarium.tables import Table, Tables, tables_of

if TYPE_CHECKING:
    from kinetarium._engine import DeviceArray, Engine, Model
    from kinetarium.worlds import Worlds


def undriven(model: Model) -> np.ndarray:
    """Which degrees of freedom have no drive, bool of shape (degrees of freedom,)."""
    gains = [model.parameter(name).ravel() for name in ("drive_stiffness", "drive_damping")]
    found: np.ndarray = ~np.any(gains, axis=0)
    return found


def _refuse_vain(target: str, model: Model, vain: np.ndarray, wanted: np.ndarray, chosen: np.ndarray) -> None:
    """Refuses targets of degrees of freedom that no drive pulls there."""
    wrong = np.argwhere(vain & chosen & (wanted != 0))
    if wrong.size:
        world, dof = wrong[0]
        raise SimulationError(
            f'world {world}: {target} is {wanted[world, dof]:g} for "{model.dof_names[dof]}", which has no drive: '
            "make the simulation of model.with_drives(kn.Drive(stiffness, damping)), or leave it at 0"
        )


class Controls(Tables):
    """Controls of all worlds, as arrays that are written in place and hold until they are written again.

    Each is one array of the simulation's dtype that lives as long as the simulation: what stands in it when
    `Simulation.step` is called is what acts, and what accelerations and reactions in `Simulation.state` are told by.
    Arrays that were never asked for are not copied. torch and jax take them by DLPack without a copy: what torch
    writes there acts.

    >>> import kinetarium as kn
    >>> sim = kn.Simulation(kn.examples.n_pendula(3), worlds=2)
    >>> sim.controls.force[:, "hinge1"] = 2.0
    >>> sim.controls.force
    NamedArray([[0., 2., 0.],
                [0., 2., 0.]], dtype=float32)
    """

    force = Table(
        "dof_names", (), "Generalised forces [N or N·m], shape (worlds, degrees of freedom); zero at first."
    )
    target_position = Table(
        "dof_names",
        (),
        """Position targets of the drives [m or rad], shape (worlds, degrees of freedom); the model's at first.

        Degrees of freedom without a drive have none: setting items there to anything but 0 raises `SimulationError`.
        Hinges that turn without end, as those without a limit, are pulled the shorter way round: see `Drive`.
        What is written past this array does nothing there, and is not seen: to parts of it that numpy gives, by
        torch, by `on_device`. `Model.with_drives` gives drives to models that have none, as those of URDF files.
        """,
    )
    target_velocity = Table(
        "dof_names",
        (),
        "Velocity targets of the drives [m/s or rad/s], shape (worlds, degrees of freedom); the model's at first. "
        "Without a drive there is none, as of `target_position`.",
    )
    actuator = Table(
        "actuator_names",
        (),
        "Controls of the actuators, shape (worlds, actuators); zero at first. Those beyond an actuator's range act "
        "as its ends.",
    )

    __slots__ = ("_arrays", "_sent")

    def __init__(self, worlds: Worlds) -> None:
        super().__init__(worlds)
        self._arrays: dict[str, NamedArray] = {}
        self._sent: dict[str, np.ndarray] = {}  # what the engine was given of each

    def __repr__(self) -> str:
        shapes = ", ".join(f"{name} {table.shape(self._worlds)}" for name, table in tables_of(Controls).items())
        return f"<Controls of {self._worlds.model.name!r}: {shapes}>"

    def on_device(self, name: str) -> DeviceArray:
        """A control of all worlds where it lies in the memory of a CUDA card, shape (worlds, degrees of freedom) or
        (worlds, actuators), to be written: what stands there when `Simulation.step` is called is what acts. It is not
        checked: a world that is given NaN diverges. `torch.from_dlpack` and the like take it without a copy.

            force = torch.from_dlpack(sim.controls.on_device("force"))
            force[:] = policy(observation)
            sim.step()

        From then on it is the card's: do not use the attribute of that name as well, whose array each step copies
        over it. What the array holds when this is called is copied first. Raises `DeviceError` where worlds are not
        on a CUDA card, by featherstone or xpbd, and `UnknownNameError`.
        """
        tables = tables_of(Controls)
        if name not in tables:
            raise UnknownNameError(f'there is no control "{name}"; {hint(name, list(tables))}')
        engine = self._worlds.engine
        array = self._arrays.get(name)
        if array is not None:
            self._write(engine, name, array)
        shared = engine.control_on_device(name, tables[name].shape(self._worlds))
        self._arrays.pop(name, None)  # not before: where this is refused, the array still acts
        return shared

    def _get(self, table: Table) -> NamedArray:
        engine = self._worlds.engine
        array = self._arrays.get(table.name)
        if array is None:
            names, assign = table.names(self._worlds), self._guard(table)
            array = NamedArray.of(self._read(engine, table), names, assign, writeable=True)
            self._arrays[table.name], self._sent[table.name] = array, np.array(array)
        return array

    def _guard(self, table: Table) -> Assign | None:
        """What is asked when items are set: of targets, where something has no drive."""
        if not table.name.startswith("target_"):
            return None
        vain = undriven(self._worlds.model)
        return partial(_refuse_vain, table.name, self._worlds.model, vain) if vain.any() else None

    def _read(self, engine: Engine, table: Table) -> np.ndarray:
        """What the engine has of a control."""
        numbers = aligned(table.shape(self._worlds), self._worlds.dtype)
        engine.read_control(table.name, numbers)
        return numbers

    def _set(self, table: Table, value: ArrayLike) -> None:
        array = self._get(table)
        if value is not array or array.held is not None:  # `force += 1` has done it already
            array[...] = checked(table.name, value, array.shape, array.dtype)

    def _send(self, engine: Engine) -> None:
        """Gives the engine what stands in the arrays."""
        for name, array in self._arrays.items():
            self._write(engine, name, array)

    def _send_changed(self) -> None:
        """The same where something else was written to them since, before what depends on it is read; not while a
        call changes the worlds, which has sent what acts."""
        others = any(not np.array_equal(array, self._sent[name]) for name, array in self._arrays.items())
        if others and not self._worlds.is_changing:
            self._send(self._worlds.engine)

    def _write(self, engine: Engine, name: str, array: NamedArray) -> None:
        engine.write_control(name, array)
        self._sent[name][...] = array

    def _act(self, engine: Engine, worlds: np.ndarray, actuator: np.ndarray) -> None:
        """Gives worlds that were set these controls of actuators. No array comes of it: one is sent in every step."""
        array = self._arrays.get("actuator")
        if array is not None:
            np.asarray(array)[worlds] = actuator
            self._write(engine, "actuator", array)
            return
        numbers = self._read(engine, tables_of(Controls)["actuator"])
        numbers[worlds] = actuator
        engine.write_control("actuator", numbers)

    def _fetch(self, worlds: np.ndarray) -> None:
        """Takes what the engine has of worlds that were set; what was written for others stays."""
        tables = tables_of(Controls)
        for name, array in self._arrays.items():
            np.asarray(array)[worlds] = self._read(self._worlds.engine, tables[name])[worlds]
            self._sent[name][worlds] = array[worlds]
