"""Numbers of the model that may differ from world to world (domain randomisation)."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from kinetarium.arrays import NamedArray, checked
from kinetarium.errors import UnknownNameError
from kinetarium.names import hint
from kinetarium.tables import Table, Tables, tables_of


class Parameters(Tables):
    """Numbers of the model in each world, float64; set items, or whole arrays, to make worlds differ.

    Each attribute is a copy, read-only but for items that are set; that compiles the model anew for the worlds that
    change (a fifth of a millisecond for a humanoid), and leaves their states as they are; none changes where one is
    refused. What is zero in the model must stay zero where it means that something is not there: a drive, dry
    friction, a spring or damper where no joint has any. `Model.with_drives` makes a model that has drives.

    >>> import kinetarium as kn
    >>> sim = kn.Simulation(kn.examples.n_pendula(2), worlds=3)
    >>> sim.parameters.gravity[1] = (0, -1.62, 0)
    >>> sim.parameters.gravity[:, 1]
    array([-9.81, -1.62, -9.81])
    """

    gravity = Table(None, (3,), "Gravity [m/s²], shape (worlds, 3).")
    body_mass = Table("body_names", (), "Masses [kg], shape (worlds, bodies).")
    body_center = Table("body_names", (3,), "Centres of mass in the bodies' frames [m], shape (worlds, bodies, 3).")
    body_inertia = Table(
        "body_names",
        (3, 3),
        "Inertias about the centres of mass [kg·m²] along the bodies' axes, shape (worlds, bodies, 3, 3).",
    )
    armature = Table("dof_names", (), "Reflected inertias of motors [kg or kg·m²], shape (worlds, dofs).")
    damping = Table("dof_names", (), "Viscous damping [N·s/m or N·m·s/rad], shape (worlds, dofs).")
    stiffness = Table("dof_names", (), "Stiffness of springs [N/m or N·m/rad], shape (worlds, dofs).")
    rest = Table("dof_names", (), "Coordinates at which springs are slack [m or rad], shape (worlds, dofs).")
    friction_loss = Table("dof_names", (), "Dry friction [N or N·m], shape (worlds, dofs).")
    drive_stiffness = Table("dof_names", (), "Stiffness of drives [N/m or N·m/rad], shape (worlds, dofs).")
    drive_damping = Table("dof_names", (), "Damping of drives [N·s/m or N·m·s/rad], shape (worlds, dofs).")
    effort_limit = Table(
        "dof_names",
        (),
        "Largest efforts of drives [N or N·m], shape (worlds, dofs); they do not limit `controls.force`.",
    )
    friction = Table(
        "shape_names",
        (),
        "Coulomb friction coefficients, shape (worlds, shapes). Contact pairs that were given one keep it.",
    )
    restitution = Table("shape_names", (), "Restitutions, shape (worlds, shapes).")
    gear = Table("actuator_names", (), "Gears of the actuators, shape (worlds, actuators).")
    gain = Table("actuator_names", (), "Gains of the actuators, shape (worlds, actuators).")
    bias = Table("actuator_names", (3,), "Biases of the actuators, shape (worlds, actuators, 3).")

    __slots__ = ()

    def __repr__(self) -> str:
        worlds = self._worlds
        return f"<Parameters of {worlds.model.name!r}, {worlds.count} worlds: {', '.join(parameter_names())}>"

    def _get(self, table: Table) -> NamedArray:
        worlds = self._worlds
        numbers = worlds.engine.read_parameter(table.name, np.arange(worlds.count))
        return NamedArray.of(numbers.reshape(table.shape(worlds)), table.names(worlds), self._assign(table))

    def _change(self, table: Table, wanted: np.ndarray, chosen: np.ndarray) -> None:
        engine, rows = self._worlds.engine, np.arange(self._worlds.count)
        now = engine.read_parameter(table.name, rows)
        numbers = np.where(chosen.reshape(now.shape), wanted.reshape(now.shape), now)
        rows = np.flatnonzero((numbers != now).any(axis=1))  # the others' models stay as they are
        if rows.size:
            engine.write_parameter(table.name, rows, numbers[rows])

    def update(self, tables: Mapping[str, ArrayLike], worlds: ArrayLike | None = None) -> None:
        """Gives worlds (a mask, a list of rows, or all) numbers of several parameters by name, which compiles their
        models once, and also takes what can be had only together; none changes where one is refused.

        Arrays broadcast to the shape of their attribute, with a row for each world given.

        >>> import kinetarium as kn
        >>> sim = kn.Simulation(kn.examples.n_pendula(2), worlds=3)
        >>> sim.parameters.update({"body_mass": [[2.0], [3.0]], "gravity": (0, -1.62, 0)}, worlds=[0, 2])
        >>> sim.parameters.body_mass[:, "link0"].tolist()
        [2.0, 1.0, 3.0]

        Raises `UnknownNameError`, `ShapeError`, `OutOfRangeError`, and what setting an attribute raises.
        """
        rows = self._worlds.rows(worlds)
        wanted = {name: self._wanted(name, numbers, rows) for name, numbers in tables.items()}
        if not rows.size:
            return
        with self._worlds.changing() as engine:
            others = [(numbers != engine.read_parameter(name, rows)).any(axis=1) for name, numbers in wanted.items()]
            other = np.any(others, axis=0)  # those of the rest stay as they are
            if np.any(other):
                engine.write_parameters(rows[other], [(name, numbers[other]) for name, numbers in wanted.items()])

    def _wanted(self, name: str, numbers: ArrayLike, rows: np.ndarray) -> np.ndarray:
        """Numbers of a parameter as the engine takes them, a row for each of these worlds."""
        table = tables_of(Parameters).get(name)
        if table is None:
            raise UnknownNameError(f'there is no parameter "{name}"; {hint(name, parameter_names())}')
        shape = table.shape(self._worlds)[1:]
        return checked(name, numbers, (len(rows), *shape)).reshape(len(rows), math.prod(shape))


def parameter_names() -> list[str]:
    """Names of all parameters."""
    return list(tables_of(Parameters))
