"""Numbers of the model that may differ from world to world (domain randomisation)."""

from __future__ import annotations

from typing import TYPE_CHECKING, overload

import numpy as np

from kinetarium.arrays import NamedArray, Names, checked

if TYPE_CHECKING:
    from kinetarium.worlds import Worlds


class Parameter:
    """An attribute of `Parameters`: a table of the model, with the numbers of every world."""

    def __init__(self, table: str | None, width: tuple[int, ...], meaning: str) -> None:
        self._table, self._width = table, width
        self.__doc__ = meaning

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    @overload
    def __get__(self, parameters: None, owner: type) -> Parameter: ...
    @overload
    def __get__(self, parameters: Parameters, owner: type) -> NamedArray: ...
    def __get__(self, parameters: Parameters | None, owner: type) -> Parameter | NamedArray:
        if parameters is None:
            return self
        worlds = parameters._worlds
        names: Names = None if self._table is None else worlds.names(self._table)
        numbers = worlds.engine.read_parameter(self._name, np.arange(worlds.count))
        rows = () if names is None else (len(names),)
        array = numbers.reshape((worlds.count, *rows, *self._width))
        before = array.copy()

        def assign(numbers: np.ndarray) -> None:
            self._write(parameters, before, numbers)
            before[...] = numbers

        return NamedArray.of(array, (None, names), assign)

    def __set__(self, parameters: Parameters, value: np.ndarray) -> None:
        before = self.__get__(parameters, Parameters)
        numbers = checked(self._name, value, before.shape)
        self._write(parameters, np.asarray(before), numbers)

    def _write(self, parameters: Parameters, before: np.ndarray, numbers: np.ndarray) -> None:
        """Tells the engine of the worlds whose numbers are others."""
        rows = numbers.reshape(len(numbers), -1)
        worlds = np.flatnonzero((rows != before.reshape(rows.shape)).any(axis=1))
        engine = parameters._worlds.engine
        engine.write_parameter(self._name, worlds, np.ascontiguousarray(rows[worlds]))


class Parameters:
    """Numbers of the model in each world, float64; set items, or whole arrays, to make worlds differ.

    Each attribute is a copy, whose items can be set; that compiles the model anew for the worlds that change (some
    tens of microseconds each), and leaves their states as they are. What is zero in the model must stay zero where
    it means that something is not there: a drive, dry friction, a spring or damper where no joint has any.

    >>> import kinetarium as kn
    >>> sim = kn.Simulation(kn.examples.n_pendula(2), worlds=3)
    >>> sim.parameters.gravity[1] = (0, -1.62, 0)
    >>> sim.parameters.gravity[:, 1]
    array([-9.81, -1.62, -9.81])
    """

    gravity = Parameter(None, (3,), "Gravity [m/s²], shape (worlds, 3).")
    body_mass = Parameter("body_names", (), "Masses [kg], shape (worlds, bodies).")
    body_center = Parameter(
        "body_names", (3,), "Centres of mass in the bodies' frames [m], shape (worlds, bodies, 3)."
    )
    body_inertia = Parameter(
        "body_names",
        (3, 3),
        "Inertias about the centres of mass [kg·m²] along the bodies' axes, shape (worlds, bodies, 3, 3).",
    )
    armature = Parameter("dof_names", (), "Reflected inertias of motors [kg or kg·m²], shape (worlds, dofs).")
    damping = Parameter("dof_names", (), "Viscous damping [N·s/m or N·m·s/rad], shape (worlds, dofs).")
    stiffness = Parameter("dof_names", (), "Stiffness of springs [N/m or N·m/rad], shape (worlds, dofs).")
    rest = Parameter("dof_names", (), "Coordinates at which springs are slack [m or rad], shape (worlds, dofs).")
    friction_loss = Parameter("dof_names", (), "Dry friction [N or N·m], shape (worlds, dofs).")
    drive_stiffness = Parameter("dof_names", (), "Stiffness of drives [N/m or N·m/rad], shape (worlds, dofs).")
    drive_damping = Parameter("dof_names", (), "Damping of drives [N·s/m or N·m·s/rad], shape (worlds, dofs).")
    effort_limit = Parameter("dof_names", (), "Largest efforts of drives [N or N·m], shape (worlds, dofs).")
    friction = Parameter("shape_names", (), "Coulomb friction coefficients, shape (worlds, shapes).")
    restitution = Parameter("shape_names", (), "Restitutions, shape (worlds, shapes).")
    gear = Parameter("actuator_names", (), "Gears of the actuators, shape (worlds, actuators).")
    gain = Parameter("actuator_names", (), "Gains of the actuators, shape (worlds, actuators).")
    bias = Parameter("actuator_names", (3,), "Biases of the actuators, shape (worlds, actuators, 3).")

    def __init__(self, worlds: Worlds) -> None:
        self._worlds = worlds


def parameter_names() -> list[str]:
    """Names of all parameters."""
    return [name for name, value in vars(Parameters).items() if isinstance(value, Parameter)]
