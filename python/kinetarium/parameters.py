"""Numbers of the model that may differ from world to world (domain randomisation)."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from kinetarium.arrays import Assign, NamedArray, checked
from kinetarium.errors import ClosedError
from kinetarium.names import Strict

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
        names = None if self._table is None else worlds.names(self._table)
        rows = () if names is None else (len(names),)
        numbers = worlds.engine.read_parameter(self._name, np.arange(worlds.count))
        array = numbers.reshape((worlds.count, *rows, *self._width))
        return NamedArray.of(array, (None, names), self._assign(worlds))

    def __set__(self, parameters: Parameters, value: Any) -> None:
        shape = self.__get__(parameters, Parameters).shape
        self._change(parameters._worlds, checked(self._name, value, shape), np.ones(shape, bool))

    def _assign(self, worlds: Worlds) -> Assign:
        those = weakref.ref(worlds)  # no array keeps worlds that are done with

        def assign(wanted: np.ndarray, chosen: np.ndarray) -> None:
            worlds = those()
            if worlds is None:
                raise ClosedError(f"the simulation of this {self._name} is gone: copy the array to change it alone")
            self._change(worlds, wanted, chosen)

        return assign

    def _change(self, worlds: Worlds, wanted: np.ndarray, chosen: np.ndarray) -> None:
        """Gives worlds those numbers that are chosen, or none of them where one is refused."""
        engine, rows = worlds.engine, np.arange(worlds.count)
        now = engine.read_parameter(self._name, rows)
        numbers = np.where(chosen.reshape(now.shape), wanted.reshape(now.shape), now)
        rows = np.flatnonzero((numbers != now).any(axis=1))  # the others' models stay as they are
        if rows.size:
            engine.write_parameter(self._name, rows, numbers[rows])


class Parameters(Strict):
    """Numbers of the model in each world, float64; set items, or whole arrays, to make worlds differ.

    Each attribute is a copy, read-only but for items that are set; that compiles the model anew for the worlds that
    change (a fifth of a millisecond for a humanoid), and leaves their states as they are; none changes where one is
    refused. What is zero in the model must stay zero where it means that something is not there: a drive, dry
    friction, a spring or damper where no joint has any.

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

    __slots__ = ("_worlds",)

    def __init__(self, worlds: Worlds) -> None:
        self._worlds = worlds

    def __repr__(self) -> str:
        worlds = self._worlds
        return f"<Parameters of {worlds.model.name!r}, {worlds.count} worlds: {', '.join(parameter_names())}>"


def parameter_names() -> list[str]:
    """Names of all parameters."""
    return [name for name, value in vars(Parameters).items() if isinstance(value, Parameter)]
