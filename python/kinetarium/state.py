"""What the worlds look like, as arrays."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from kinetarium.arrays import Assign, NamedArray, aligned
from kinetarium.errors import ShapeError, SimulationError, UnknownNameError
from kinetarium.names import hint
from kinetarium.tables import Table, Tables, tables_of

if TYPE_CHECKING:
    from kinetarium._engine import DeviceArray, Model
    from kinetarium.controls import Controls
    from kinetarium.worlds import Worlds

# Coordinates and velocities beyond this are refused.
_MOST_MOTION = 1e9


def quaternion_columns(model: Model) -> dict[str, slice]:
    """Where the quaternions of joints are among the coordinates; joints that close loops have none."""
    kinds = zip(model.joint_names, model.joint_kinds, strict=True)
    ends = {name: model.joint_coordinates(name) for name, kind in kinds if kind in ("ball", "free")}
    return {name: slice(end - 4, end) for name, (start, end) in ends.items() if start < end}


def _refuse(quantity: str, *_: np.ndarray) -> None:
    raise ShapeError(f"{quantity} follows from the joints: set joint_position and joint_velocity, or copy the array")


def _check_motion(worlds: np.ndarray, what: str, numbers: np.ndarray) -> None:
    wrong = ~(np.abs(numbers) <= _MOST_MOTION)
    if wrong.any():
        row, column = np.argwhere(wrong)[0]
        raise SimulationError(
            f"world {worlds[row]}: {what}[{column}] is {numbers[row, column]:g}: it must be a finite number "
            f"from -{_MOST_MOTION:g} to {_MOST_MOTION:g}"
        )


def _refuse_times(what: str, *_: np.ndarray) -> None:
    raise ShapeError(f"{what} follows from the steps: copy the array to change it alone")


class Quantity(Table):
    """An attribute of `State` that is only read."""

    def __set__(self, tables: Tables, value: NoReturn) -> None:  # type: ignore[override]
        _refuse(self.name)


class Effect(Quantity):
    """One that may depend on the controls as they stand when it is read."""


class State(Tables):
    """The state of all worlds.

    Each attribute is a fresh array of the simulation's dtype, contiguous and yours to keep, read-only but for items
    that are set: one transposing copy from the blocks in which worlds lie side by side. Take it once, not once per
    world; `read` gives a plain array, or fills one of yours. torch and jax take what `read` gives by DLPack without a
    further copy, and of attributes a copy, so that nothing is written there in vain.

    Items of `joint_position` and `joint_velocity` can be set, which changes the simulation: those items, in the
    worlds that have them, and no others; contacts are told as they were until the next step. An array that was read
    before the simulation was stepped or reset refuses that with a `SimulationError`; as numbers it stays good. The
    other quantities follow from those two; accelerations and reactions, by `featherstone`, from the controls as well,
    as they stand when they are read. Names index bodies, joints, coordinates and degrees of freedom.

    >>> import kinetarium as kn
    >>> sim = kn.Simulation(kn.examples.n_pendula(3), worlds=2, dtype="float64")
    >>> sim.state.joint_position[1, "hinge0"] = 0.5
    >>> sim.state.joint_position.round(3)
    array([[1.571, 0.   , 0.   ],
           [0.5  , 0.   , 0.   ]])
    >>> sim.state.body_position[:, "link2"].shape
    (2, 3)
    """

    joint_position = Table(
        "coordinate_names",
        (),
        """Coordinates of the joints [m, rad, quaternions x, y, z, w], shape (worlds, coordinates).

        Angles of axes that turn without end, without a limit, a spring or a position servo, are in [−π, π]. Items can
        be set; quaternions are scaled to unit length then.
        """,
    )
    joint_velocity = Table(
        "dof_names",
        (),
        "Velocities of the joints [m/s or rad/s], shape (worlds, degrees of freedom). Items can be set.",
    )
    joint_acceleration = Effect(
        "dof_names", (), "Accelerations of the joints [m/s² or rad/s²], shape (worlds, degrees of freedom)."
    )
    body_position = Quantity(
        "body_names", (3,), "Positions of the bodies' frames [m], world axes, shape (worlds, bodies, 3)."
    )
    body_orientation = Quantity(
        "body_names", (4,), "Orientations of the bodies' frames, x, y, z, w, shape (worlds, bodies, 4)."
    )
    body_velocity = Quantity(
        "body_names",
        (3,),
        "Velocities of the origins of the bodies' frames [m/s], world axes, shape (worlds, bodies, 3).",
    )
    body_angular_velocity = Quantity(
        "body_names", (3,), "Angular velocities of the bodies [rad/s], world axes, shape (worlds, bodies, 3)."
    )
    reaction_force = Effect(
        "joint_names", (3,), "Forces of the joints on their children [N], world axes, shape (worlds, joints, 3)."
    )
    reaction_torque = Effect(
        "joint_names",
        (3,),
        "Torques of the joints on their children about the child's joint frame [N·m], world axes, shape (worlds, "
        "joints, 3).",
    )
    contact_wrench = Quantity(
        "body_names",
        (6,),
        "Forces [N] and torques about the world's origin [N·m] of the contacts of the last step on the bodies, "
        "world axes, shape (worlds, bodies, 6): force, then torque. Zero before the first step.",
    )
    center_of_mass = Quantity(
        None, (3,), "Centres of mass of all bodies that are not static [m], world axes, shape (worlds, 3)."
    )
    spatial_inertia = Quantity(
        "body_names",
        (10,),
        """Inertias of the bodies about the centre of mass C of their tree, along the world's axes, shape (worlds,
        bodies, 10): Ixx, Iyy, Izz, Ixy, Ixz, Iyz [kg·m²], m (c − C) [kg·m], m [kg], with the body's own centre c.
        MuJoCo's `cinert`.

        A tree is all that joints carry from one body on that hangs on the world or on a static body. Static bodies
        have no mass, here.
        """,
    )
    spatial_velocity = Quantity(
        "body_names",
        (6,),
        "Angular velocities of the bodies [rad/s] and the velocities [m/s] that they have at the centre of mass "
        "of their tree, world axes, shape (worlds, bodies, 6). MuJoCo's `cvel`.",
    )
    spatial_contact_force = Quantity(
        "body_names",
        (6,),
        "Torques [N·m] about the centre of mass of their tree and forces [N] of the contacts of the last step on "
        "the bodies, world axes, shape (worlds, bodies, 6): torque, then force. MuJoCo's `cfrc_ext`, as far as "
        "contacts go.",
    )
    kinetic_energy = Quantity(None, (), "Kinetic energy [J], shape (worlds,).")
    potential_energy = Quantity(None, (), "Potential energy [J] of weight and passive springs, shape (worlds,).")
    momentum = Quantity(None, (3,), "Linear momentum [kg·m/s], shape (worlds, 3).")
    angular_momentum = Quantity(None, (3,), "Angular momentum [kg·m²/s] about the world's origin, shape (worlds, 3).")
    capped = Quantity(
        None,
        (),
        "How often a cap on a force or displacement has bitten since the world was reset, with `xpbd`; how many "
        "contacts there was no room to remember, with `impulse`; else zero, shape (worlds,).",
    )

    __slots__ = ("_controls", "_quaternions")

    def __init__(self, worlds: Worlds, controls: Controls) -> None:
        super().__init__(worlds)
        self._controls = controls
        self._quaternions: dict[str, slice] | None = None

    def __repr__(self) -> str:
        model = self._worlds.model
        return (
            f"<State of {model.name!r}: {self._worlds.count} worlds, {model.coordinates} coordinates, "
            f"{model.degrees_of_freedom} degrees of freedom, {len(model.body_names)} bodies>"
        )

    def read(self, quantity: str, out: np.ndarray | None = None) -> np.ndarray:
        """A quantity of all worlds by name, as the attribute of that name; into `out`, if given, which must be
        of the same shape and of the simulation's dtype, C-contiguous and writeable.

        Raises `ShapeError`, `UnknownNameError`, and `SimulationError` for controls that are not finite, where it
        depends on them.
        """
        worlds, table = self._worlds, self._asked(quantity)
        shape = table.shape(worlds)
        if out is None:
            out = aligned(shape, worlds.dtype)
        elif not isinstance(out, np.ndarray) or out.shape != shape or out.dtype != worlds.dtype:
            found = f"{out.dtype} of {out.shape}" if isinstance(out, np.ndarray) else type(out).__name__
            raise ShapeError(f"out is {found}: it must be an array, {worlds.dtype} of {shape}")
        elif isinstance(out, NamedArray) and out.held is not None and not out.flags.writeable:
            self.read(quantity, out.held)
            out.holds(table.names(worlds), self._assign(table))
            return out
        worlds.engine.read(quantity, out)
        return out

    def read_columns(self, quantity: str, table: np.ndarray, column: int = 0) -> int:
        """Copies a quantity of all worlds into columns of a table, row by row, from one column on; the column behind
        them. Observations of many quantities are put together so without a copy of each, in the simulation's threads.

        `table` has the shape (worlds, columns), is float32 or float64, whatever the simulation's dtype, C-contiguous
        and writeable.

        >>> import kinetarium as kn, numpy as np
        >>> sim = kn.Simulation(kn.examples.n_pendula(3), worlds=2)
        >>> observed = np.zeros((2, 6))
        >>> end = sim.state.read_columns("joint_velocity", observed)
        >>> sim.state.read_columns("joint_position", observed, end)
        6

        Raises `ShapeError` and `UnknownNameError`.
        """
        shape = self._asked(quantity).shape(self._worlds)
        end = column + math.prod(shape[1:])
        if not isinstance(table, np.ndarray) or table.dtype not in (np.float32, np.float64):
            found = table.dtype if isinstance(table, np.ndarray) else type(table).__name__
            raise ShapeError(f"the table is {found}: it must be an array of float32 or float64")
        if table.ndim != 2 or len(table) != shape[0] or not 0 <= column <= end <= table.shape[1]:
            raise ShapeError(
                f"the table has the shape {table.shape}: it must have {shape[0]} rows and columns {column} to {end}"
            )
        self._worlds.engine.read_columns(quantity, table, column)
        return end

    def on_device(self, quantity: str) -> DeviceArray:
        """A quantity of all worlds where it lies in the memory of a CUDA card, of the shape of the attribute of that
        name; nothing is copied to the host. `torch.from_dlpack` and `jax.dlpack.from_dlpack` take it without a copy,
        as do readers of `__cuda_array_interface__`. To be read only.

        What stands there is of the present state until the worlds are stepped or set, or another quantity is asked
        for: take it anew after each step. The memory lasts as long as anybody holds it.

            sim = kn.Simulation(model, worlds=16384, device="cuda")
            sim.step()
            position = torch.from_dlpack(sim.state.on_device("joint_position"))

        Raises `DeviceError` where worlds are not on a CUDA card, by featherstone or xpbd, and for quantities that are
        worked out on the host (`contact_wrench`, `center_of_mass` and the spatial ones), and `UnknownNameError`.
        """
        shape = self._asked(quantity).shape(self._worlds)
        return self._worlds.engine.quantity_on_device(quantity, shape)

    def _asked(self, quantity: str) -> Table:
        """The table of a quantity that is going to be read; the engine then has the controls that it depends on."""
        table = _quantity(quantity)
        if isinstance(table, Effect):
            self._controls._send_changed()
        return table

    def _get(self, table: Table) -> NamedArray:
        return NamedArray.of(self.read(table.name), table.names(self._worlds), self._assign(table))

    def _assign(self, table: Table) -> Assign:
        return partial(_refuse, table.name) if isinstance(table, Quantity) else super()._assign(table)

    def _check(self, table: Table, moment: int) -> None:
        if self._worlds.moment != moment:
            raise SimulationError(
                f"this {table.name} was read before the simulation was stepped or reset: read it anew to set its "
                "items, or copy the array to change it alone"
            )

    def _change(self, table: Table, wanted: np.ndarray, chosen: np.ndarray) -> None:
        if table.name == "joint_position":
            for columns in self._quaternion_columns().values():
                chosen[:, columns] |= chosen[:, columns].any(axis=1, keepdims=True)
        before = self.read(table.name)
        lost = chosen.any(axis=1) & np.asarray(self.diverged)
        worlds = np.flatnonzero((chosen & (wanted != before)).any(axis=1) | lost)
        if worlds.size == 0:
            return
        now = {name: self.read(name)[worlds] for name in ("joint_position", "joint_velocity")}
        now[table.name] = np.where(chosen[worlds], wanted[worlds], now[table.name])
        position, velocity = (np.ascontiguousarray(numbers, np.float64) for numbers in now.values())
        if table.name == "joint_position":
            self._put(worlds, position, velocity, keep=True)
        else:
            _check_motion(worlds, "joint velocity", velocity)
            self._worlds.engine.set_joint_velocities(worlds, velocity)

    def _put(self, worlds: np.ndarray, position: np.ndarray, velocity: np.ndarray, *, keep: bool) -> None:
        """Puts worlds at coordinates and velocities, a row for each, or none of them where one cannot be put there;
        with `keep` they keep their times and controls."""
        _check_motion(worlds, "joint position", position)
        _check_motion(worlds, "joint velocity", velocity)
        for joint, columns in self._quaternion_columns().items():
            zero = np.flatnonzero(np.linalg.norm(position[:, columns], axis=1) < 1e-12)
            if zero.size:
                raise SimulationError(
                    f'world {worlds[zero[0]]}: the quaternion of joint "{joint}" is zero: give one of unit length, '
                    "x, y, z, w"
                )
        self._worlds.engine.set_joint_state(worlds, position, velocity, keep)

    def _quaternion_columns(self) -> dict[str, slice]:
        if self._quaternions is None:
            self._quaternions = quaternion_columns(self._worlds.model)
        return self._quaternions

    @property
    def time(self) -> NamedArray:
        """Times [s], float64 of shape (worlds,); a world that diverged keeps the time at which it was found."""
        return NamedArray.of(self._worlds.engine.times(), (), partial(_refuse_times, "time"))

    @property
    def diverged(self) -> NamedArray:
        """Which worlds left the finite numbers, bool of shape (worlds,). They stay at their last good state until
        they are reset."""
        diverged = np.zeros(self._worlds.count, bool)
        diverged[[world for world, _ in self._worlds.engine.diverged()]] = True
        return NamedArray.of(diverged, (), partial(_refuse_times, "diverged"))


_QUANTITIES = tables_of(State)


def _quantity(name: str) -> Table:
    table = _QUANTITIES.get(name)
    if table is None:
        raise UnknownNameError(f'there is no quantity "{name}"; {hint(name, list(_QUANTITIES))}')
    return table
