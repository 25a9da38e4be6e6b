"""W worlds of one model, stepped together."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, SupportsIndex, get_args

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from kinetarium import _nvrtc
from kinetarium._engine import Engine, Geometry, Model, framing, render_view, show
from kinetarium.arrays import checked, row, whole
from kinetarium.cameras import Camera, Images
from kinetarium.controls import Controls
from kinetarium.errors import RenderError, ShapeError, SimulationError, UnknownNameError
from kinetarium.names import Strict, hint
from kinetarium.parameters import Parameters, parameter_names
from kinetarium.queries import FIRST, NearShapes, Queries, Seen, ShapeHits, asked, sight
from kinetarium.sensors import Custom, Sensor, Sensors
from kinetarium.skins import Skin
from kinetarium.state import State
from kinetarium.view import Skins, View
from kinetarium.worlds import Worlds

_NO_CONTROL = np.empty(0)

Solver = Literal["auto", "featherstone", "xpbd", "impulse"]
Integrator = Literal["semi_implicit_euler", "explicit_euler", "verlet", "runge_kutta_4"]
Watched = Literal["contacts", "persisting_contacts", "sensors", "limits", "sleep", "divergence"]
EventKind = Literal[
    "contact_begins",
    "contact_persists",
    "contact_ends",
    "sensor_begins",
    "sensor_ends",
    "limit_reached",
    "falls_asleep",
    "wakes",
    "diverged",
]


@dataclass(frozen=True, eq=False)
class Contacts:
    """The contacts of a world or of several, a row for each; those that do not press have no force."""

    world: np.ndarray
    """In which world, ascending, int64, shape (contacts,)."""
    shapes: np.ndarray
    """Rows of the two shapes; the second one moves. int64, shape (contacts, 2)."""
    position: np.ndarray
    """Midway between the surfaces [m], world axes, shape (contacts, 3)."""
    normal: np.ndarray
    """Unit vectors from the first shape to the second, shape (contacts, 3)."""
    distance: np.ndarray
    """Gaps less margins [m], negative where shapes overlap, shape (contacts,)."""
    force: np.ndarray
    """Forces of the first shape on the second [N], world axes, shape (contacts, 3)."""
    torque: np.ndarray
    """Torques of the first shape on the second against twisting and rolling [N·m], besides those of the forces at
    the positions, world axes, shape (contacts, 3)."""
    feature: np.ndarray
    """Numbers that stay the same from step to step while the same features touch, shape (contacts,)."""
    worlds: int | np.ndarray = field(repr=False)
    """The world that was asked for, or the rows of several."""
    model: Model = field(repr=False)
    """What has these shapes."""

    def __len__(self) -> int:
        return len(self.distance)

    def between(self, first: str | int, second: str | int) -> Contacts:
        """Those of two shapes, each given by its name or its row, in either order. Raises `UnknownNameError`,
        `OutOfRangeError`."""
        pair = self._pair(first, second)
        chosen = (self.shapes == pair).all(axis=1) | (self.shapes == pair[::-1]).all(axis=1)
        columns = {name: x[chosen] for name, x in vars(self).items() if name not in ("worlds", "model")}
        return replace(self, **columns)

    def wrench(self, first: str | int, second: str | int) -> np.ndarray:
        """What one shape does to another, each given by its name or its row: force [N], then torque about the world's
        origin [N·m], world axes, zero where they do not touch, shape (6,), or (worlds, 6) of several worlds. Raises
        `UnknownNameError`, `OutOfRangeError`."""
        touching = self.between(first, second)
        torque = touching.torque + np.cross(touching.position, touching.force)
        sign = np.where(touching.shapes[:, :1] == self._pair(first, second)[0], 1.0, -1.0)
        wrenches = np.zeros((np.max(self.worlds, initial=0) + 1, 6))
        np.add.at(wrenches, touching.world, sign * np.hstack([touching.force, torque]))
        wrench: np.ndarray = wrenches[self.worlds]
        return wrench

    def _pair(self, first: str | int, second: str | int) -> list[int]:
        count = len(self.model.shape_bodies)
        return [row("shape", shape, self.model.shape, count) for shape in (first, second)]


@dataclass(frozen=True, eq=False)
class RayHits:
    """What rays meet first; (…) is (rays,), or (worlds, rays) of several worlds."""

    distance: np.ndarray
    """From the origin [m], infinite where nothing is met, shape (…)."""
    shape: np.ndarray
    """Rows of the shapes, −1 where nothing is met, int64, shape (…)."""
    body: np.ndarray
    """Rows of their bodies, −1 for the world's and where nothing is met, int64, shape (…)."""
    position: np.ndarray
    """The points [m], world axes, NaN where nothing is met, shape (…, 3)."""
    normal: np.ndarray
    """Unit vectors out of the surfaces, NaN where nothing is met, shape (…, 3)."""


@dataclass(frozen=True)
class Event:
    """Something that happened in a world."""

    world: int
    """Which world."""
    time: float
    """End [s] of the substep in which it happened; sensors are as shapes lay at its beginning."""
    kind: EventKind
    """What."""
    details: dict[str, Any] = field(default_factory=dict)
    """By kind: `shapes` (rows of both), `impulse` [N·s]; `dof` and `upper`; `body`."""


@dataclass(frozen=True, eq=False)
class Linearization:
    """A time step about a state: δx' = state δx + control δu + force δf + …, float64.

    x is (δq, q̇), of n degrees of freedom each; δq are increments in the directions of the velocities, as MuJoCo's
    `mjd_transitionFD` has them.
    """

    state: np.ndarray
    """A = ∂x'/∂x, shape (2n, 2n)."""
    control: np.ndarray
    """B = ∂x'/∂u by the controls of the actuators, shape (2n, actuators)."""
    force: np.ndarray
    """By the generalised forces, shape (2n, n)."""
    target_position: np.ndarray
    """By the drives' position targets, shape (2n, n)."""
    target_velocity: np.ndarray
    """By the drives' velocity targets, shape (2n, n)."""


def _precision(dtype: DTypeLike) -> np.dtype:
    """A dtype that simulations have; `SimulationError` for others."""
    try:
        name = "None" if dtype is None else np.dtype(dtype).name  # numpy takes none for float64
    except TypeError:
        name = str(dtype)
    if name not in ("float32", "float64"):
        raise SimulationError(f"dtype is {name}: it must be float32 or float64")
    precision: np.dtype = np.dtype(name)
    return precision


def _seconds(dt: Any) -> float:
    """A time step; `SimulationError` where it is no number."""
    try:
        return float(dt)
    except (TypeError, ValueError, OverflowError):
        raise SimulationError(f"dt is {dt!r}: it must be a number of seconds, as 0.002") from None


class Simulation(Strict):
    """W worlds of one model, advanced together.

    Parameters
    ----------
    model:
        What exists: from `load`, `parse` or a `Builder`.
    worlds:
        Number of worlds.
    dt:
        Time step [s]; by default what the model recommends.
    solver:
        "featherstone" (reduced coordinates: accurate), "xpbd" (maximal coordinates: loops, compliance),
        "impulse" (bodies by the thousand in one world), or "auto", which picks; `solver` tells what runs.
    substeps:
        Parts of a time step; by default 4 for xpbd, else 1.
    integrator:
        Of featherstone: "semi_implicit_euler", "explicit_euler", "verlet" or "runge_kutta_4".
    contacts:
        Whether shapes touch.
    dtype:
        "float32" (16 worlds in a register where the machine has 512 bits) or "float64" (8).
    threads:
        Number of threads; 0 is one per processor. Results do not depend on it.
    device:
        Where worlds run: "cpu", "gpu" (a graphics card), "gpu:NAME" with a part of its name, "cuda" (an NVIDIA card),
        "cuda:NUMBER", or "auto", which takes a card where there is one, but for impulse. Cards compute in float32
        and agree with the processor to rounding, by CUDA, but for impulse, to the bit; states stay there, and what is
        read is copied. Simulations that name the same card share what is compiled for it. CUDA needs NVRTC:
        `pip install ".[cuda]"` in a checkout. Raises `DeviceError` where there is no such card.
    iterations, contact_passes, contact_iterations, speed_limit, sleep_speed:
        As `Settings` in Rust: passes over all constraints (xpbd), passes over contacts (featherstone), passes of
        projected Gauss-Seidel, the speed [m/s or rad/s] beyond which a world has diverged, the speed [m/s] below
        which bodies sleep (impulse).

    sensors, seed:
        What robots measure (see `kinetarium.sensors`), and the seed of its noise.

    Raises `SimulationError` for settings out of range and models that the solver cannot take. Calls that fail leave
    the simulation as it was. One thread at a time may call it: others get `BusyError`. While the engine computes,
    Python's lock is free. It can be pickled and copied: model, settings, states, controls, parameters, what it
    watches and a subclass's own attributes come along, events that were not fetched do not. A process that was forked
    after it was made cannot use it, and gets `ForkedError`.

    >>> import kinetarium as kn
    >>> sim = kn.Simulation(kn.examples.n_pendula(3), worlds=64, dt=0.002)
    >>> sim.controls.force[:, "hinge0"] = 0.1
    >>> sim.step(500)
    array([], dtype=int64)
    >>> float(sim.state.time[7])
    1.0
    """

    __slots__ = (
        "__weakref__",
        "_controls",
        "_device",
        "_isa",
        "_parameters",
        "_sensors",
        "_settings",
        "_solver",
        "_state",
        "_threads",
        "_view",
        "_watched",
        "_worlds",
    )

    def __init__(
        self,
        model: Model,
        worlds: int = 1,
        *,
        dt: float | None = None,
        solver: Solver = "auto",
        substeps: int | None = None,
        integrator: Integrator = "semi_implicit_euler",
        contacts: bool = True,
        dtype: DTypeLike = "float32",
        threads: int = 0,
        device: str = "cpu",
        iterations: int = 1,
        contact_passes: int = 2,
        contact_iterations: int = 8,
        speed_limit: float = 1e5,
        sleep_speed: float = 0.01,
        sensors: Iterable[Sensor | Custom] | Sensor | Custom = (),
        seed: int = 0,
    ) -> None:
        if not isinstance(model, Model):
            raise TypeError(f"the model is a {type(model).__name__}: give a Model, as load and Builder make")
        precision = _precision(dtype)
        if not isinstance(device, str):
            raise TypeError(f'device is {device!r}: it must be a text, such as "cpu", "gpu" or "cuda:0"')
        self._settings: dict[str, Any] = {
            "dt": model.time_step if dt is None else _seconds(dt),
            "solver": solver,
            "substeps": None if substeps is None else whole("substeps", substeps),
            "integrator": integrator,
            "contacts": contacts,
            "threads": whole("threads", threads),
            "device": device,
            "iterations": whole("iterations", iterations),
            "contact_passes": whole("contact_passes", contact_passes),
            "contact_iterations": whole("contact_iterations", contact_iterations),
            "speed_limit": speed_limit,
            "sleep_speed": sleep_speed,
        }
        count, seed = whole("worlds", worlds), whole("seed", seed, bits=64)
        self._worlds = Worlds(self._make(model, count, precision), model, count, precision)
        self._solver, self._isa, self._threads, self._device = self._engine.describe()
        self._controls = Controls(self._worlds)
        self._state = State(self._worlds, self._controls)
        self._parameters = Parameters(self._worlds)
        self._view: View | None = None
        self._watched: tuple[Watched, ...] = ()
        self._sensors = Sensors(self, sensors, seed)
        with self._worlds.changing():
            self._sensors._update(self)

    def _make(self, model: Model, worlds: int, dtype: np.dtype) -> Engine:
        keywords = dict(self._settings)
        if keywords["device"].partition(":")[0] in ("auto", "cuda") and _nvrtc.has_driver():
            _nvrtc.load()
        return Engine(model, worlds=worlds, time_step=keywords.pop("dt"), double=dtype == np.float64, **keywords)

    @property
    def _engine(self) -> Engine:
        return self._worlds.engine

    @property
    def model(self) -> Model:
        """The model."""
        return self._worlds.model

    @property
    def worlds(self) -> int:
        """Number of worlds."""
        return self._worlds.count

    @property
    def dt(self) -> float:
        """Time step [s]."""
        return float(self._settings["dt"])

    @property
    def dtype(self) -> np.dtype:
        """Precision of all numbers: float32 or float64."""
        return self._worlds.dtype

    @property
    def solver(self) -> str:
        """Name of the solver that runs: what "auto" picked."""
        return self._solver

    @property
    def isa(self) -> str:
        """Instruction set that runs."""
        return self._isa

    @property
    def threads(self) -> int:
        """Number of threads that run."""
        return self._threads

    @property
    def device(self) -> str:
        """Where the worlds run: "cpu", or the name of a graphics card."""
        return self._device

    @property
    def left_to_processor(self) -> int:
        """How many substeps of all worlds together a card has left to the processor; only of `impulse`."""
        return self._worlds.engine.left_to_processor()

    @property
    def controls(self) -> Controls:
        """Forces, targets and actuator controls, to be written in place."""
        return self._controls

    @property
    def state(self) -> State:
        """Joints, bodies, energies, times, as arrays."""
        return self._state

    @property
    def parameters(self) -> Parameters:
        """Masses, gravity, friction and other numbers of the model, in each world."""
        return self._parameters

    @property
    def sensors(self) -> Sensors:
        """Readings of the sensors by name: `sim.sensors["imu"]`."""
        _ = self._engine  # which tells where there is none
        return self._sensors

    @property
    def time(self) -> np.ndarray:
        """Times of the worlds [s], shape (worlds,)."""
        return self._state.time

    def body(self, name: str) -> int:
        """Row of a body."""
        return self.model.body(name)

    def joint(self, name: str) -> int:
        """Row of a joint."""
        return self.model.joint(name)

    def dof(self, name: str) -> int:
        """Row of a degree of freedom: a column of `controls.force` and `state.joint_velocity`."""
        return self.model.dof(name)

    def actuator(self, name: str) -> int:
        """Row of an actuator: a column of `controls.actuator`."""
        return self.model.actuator(name)

    def shape(self, name: str) -> int:
        """Row of a shape."""
        return self.model.shape(name)

    def step(self, steps: SupportsIndex = 1) -> np.ndarray:
        """Advances all worlds by time steps, under the controls as they stand.

        Returns the worlds that diverged meanwhile, int64; they stay at their last good state, and the others go on.
        What a `Custom` sensor raises ends it at the step in which that was sampled.
        """
        steps = whole("steps", steps)
        with self._worlds.changing() as engine:
            self._controls._send(engine)
            self._worlds.moment += 1
            diverged = self._sensors._step(self, engine, steps) if self._sensors else engine.step(steps)
        # Between the parts of many steps the page may bring a world back, to diverge again.
        return np.array(list(dict.fromkeys(diverged)), np.int64)

    def reset(self, worlds: ArrayLike | None = None, *, keyframe: str | None = None) -> None:
        """Brings worlds (a mask, a list of rows, or all) to the model's initial state at time 0, or to one of its
        keyframes, with the model's controls."""
        rows = self._worlds.rows(worlds)
        if keyframe is not None:
            position, velocity, control = self.model.keyframe(keyframe)
            self._put(rows, position, velocity, control)
            return
        with self._worlds.changing() as engine:
            engine.reset(rows)
            self._begun(engine, rows)

    def _put(self, rows: np.ndarray, position: ArrayLike, velocity: ArrayLike, control: np.ndarray) -> None:
        """Puts worlds at a state at time 0, with these controls of actuators, or the model's if they are empty."""
        position = checked("joint_position", position, (len(rows), self.model.coordinates))
        velocity = checked("joint_velocity", velocity, (len(rows), self.model.degrees_of_freedom))
        with self._worlds.changing() as engine:
            self._state._put(rows, position, velocity, keep=False)
            self._begun(engine, rows, control)

    def _begun(self, engine: Engine, rows: np.ndarray, control: np.ndarray = _NO_CONTROL) -> None:
        """Takes over what the engine has of worlds that were set: controls, but for those that are given, and what
        sensors read."""
        if not rows.size:
            return
        self._worlds.moment += 1
        self._controls._fetch(rows)
        if control.size:
            self._controls._act(engine, rows, control)
        self._sensors._update(self)

    def set_state(
        self,
        joint_position: ArrayLike,
        joint_velocity: ArrayLike = 0.0,
        *,
        worlds: ArrayLike | None = None,
    ) -> None:
        """Puts worlds at joint coordinates and velocities, at time 0, with the model's controls.

        The arrays broadcast to (worlds given, coordinates) and (worlds given, degrees of freedom). Quaternions are
        scaled to unit length. What touches there touches for the first time, and so slips a little before it sticks.
        To change a state as it runs, set items of `state.joint_position`.

        Raises `ShapeError`, `OutOfRangeError`, and `SimulationError` for numbers that are not finite.
        """
        self._put(self._worlds.rows(worlds), joint_position, joint_velocity, _NO_CONTROL)

    def snapshot(self) -> bytes:
        """States, controls and times of all worlds, to the bit; not what sensors carry along (pickle the simulation
        for that)."""
        self._controls._send(self._engine)
        return self._engine.snapshot()

    def restore(self, snapshot: bytes | bytearray | memoryview) -> None:
        """Returns to a snapshot of the same model, solver, dtype and number of worlds."""
        held = snapshot if isinstance(snapshot, bytes) else bytes(memoryview(snapshot))
        with self._worlds.changing() as engine:
            engine.restore(held)
            self._begun(engine, np.arange(self.worlds))

    def save(self, path: str | Path) -> None:
        """Writes a snapshot to a file."""
        Path(path).write_bytes(self.snapshot())

    def load(self, path: str | Path) -> None:
        """Returns to a snapshot that `save` wrote."""
        self.restore(Path(path).read_bytes())

    def contacts(self, world: int | None = None, *, worlds: ArrayLike | None = FIRST) -> Contacts:
        """The contacts of the last step in a world, 0 by default, or in several (a list, a mask, or `None` for all),
        in an order that does not change from step to step. Raises `ShapeError`, `OutOfRangeError`, and
        `SimulationError` where both `world` and `worlds` are given.

        >>> import kinetarium as kn
        >>> sim = kn.Simulation(kn.examples.pyramid(2), worlds=3)
        >>> _ = sim.step(100)
        >>> contacts = sim.contacts(worlds=[0, 2])
        >>> set(contacts.world.tolist()), contacts.wrench("floor", 2).shape
        ({0, 2}, (2, 6))
        """
        worlds = asked(world, worlds)
        rows = self._worlds.rows(worlds)
        several = worlds is None or np.ndim(worlds) > 0
        found = self._engine.contacts(np.unique(rows))
        return Contacts(**found, worlds=rows if several else int(rows[0]), model=self.model)

    def asleep(self, world: int = 0) -> np.ndarray:
        """Which bodies of a world sleep, bool of shape (bodies,); `impulse` only."""
        return np.array(self._engine.asleep(self._world(world)), bool)

    def _world(self, world: int) -> int:
        return int(self._worlds.rows([world])[0])

    def cast_rays(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        world: int | None = None,
        worlds: ArrayLike | None = FIRST,
        max_distance: float = np.inf,
    ) -> RayHits:
        """What rays meet first, up to a distance [m], in a world, 0 by default, or in several (a list, a mask, or
        `None` for all).

        In one world, origins [m] and directions (of any length but zero) broadcast to (rays, 3), world axes, and the
        answer's arrays have the shape (rays, …); in several worlds these are (worlds, rays, …). Rays meet all shapes
        but sensors, those that are only seen, too. Raises `ShapeError`, `OutOfRangeError`, and `SimulationError` for
        numbers that make no sense, and where both `world` and `worlds` are given.
        """
        worlds = asked(world, worlds)
        rows = self._worlds.rows(worlds)
        rays = Queries.of(rows, worlds, origins=(origins, 3), directions=(directions, 3))
        starts, ways = rays.arrays
        return RayHits(**rays.shaped(self._engine.cast_rays(rows, starts, ways, max_distance)))

    def cast_shape(
        self,
        geometry: Geometry,
        positions: ArrayLike,
        directions: ArrayLike,
        *,
        orientations: ArrayLike = (0.0, 0.0, 0.0, 1.0),
        world: int | None = None,
        worlds: ArrayLike | None = FIRST,
        max_distance: float = np.inf,
        seen: Seen | None = None,
    ) -> ShapeHits:
        """What a convex shape that moves along lines, without turning, first touches, up to a distance [m].

        In one world, positions [m], directions (of any length but zero) and orientations (x, y, z, w) of the starts
        broadcast to (casts, 3) and (casts, 4), world axes, and the answer's arrays have the shape (casts, …). In
        several worlds (a list, a mask, or `None` for all) these are (worlds, casts, …). A shape that is overlapped at
        the start is met at distance 0. Shapes are as rays meet them; `seen` picks some.

        Raises `ShapeError`, `OutOfRangeError` for worlds and bodies that do not exist, and `SimulationError` for
        shapes that are not convex solids, numbers that make no sense, and both `world` and `worlds`.

        >>> import kinetarium as kn
        >>> sim = kn.Simulation(kn.examples.pyramid(3))
        >>> hits = sim.cast_shape(kn.Geometry.sphere(0.1), [[0, 5, 0], [9, 5, 0]], (0, -1, 0))
        >>> float(hits.distance[1].round(6))
        4.9
        """
        worlds = asked(world, worlds)
        rows = self._worlds.rows(worlds)
        queries = Queries.of(
            rows, worlds, positions=(positions, 3), directions=(directions, 3), orientations=(orientations, 4)
        )
        (starts, ways, turns), sees = queries.arrays, sight(seen, self.model)
        return queries.hits(self._engine.cast_shapes(rows, geometry, starts, turns, ways, max_distance, sees))

    def nearest(
        self,
        points: ArrayLike,
        k: int = 1,
        *,
        world: int | None = None,
        worlds: ArrayLike | None = FIRST,
        max_distance: float = np.inf,
        seen: Seen | None = None,
    ) -> ShapeHits:
        """The k nearest shapes to points [m], up to a distance [m], the nearest first; all shapes of the model, where
        it has fewer than k.

        In one world, points broadcast to (points, 3), world axes, and the answer's arrays have the shape
        (points, k, …); in several worlds these are (worlds, points, …). Distances are from the surfaces, negative
        inside; of closed meshes, too. What holds a point is the nearer the deeper it does. Raises as `cast_shape`.
        """
        worlds = asked(world, worlds)
        rows, shapes = self._worlds.rows(worlds), len(self._worlds.names("shape_names") or ())
        k = min(whole("k", k, 1), max(shapes, 1))
        queries = Queries.of(rows, worlds, points=(points, 3))
        (places,) = queries.arrays
        return queries.hits(self._engine.nearest(rows, places, k, max_distance, sight(seen, self.model)), k)

    def closest_points(
        self,
        points: ArrayLike,
        max_distance: float = np.inf,
        *,
        world: int | None = None,
        worlds: ArrayLike | None = FIRST,
        seen: Seen | None = None,
    ) -> NearShapes:
        """Of each shape within a distance [m] of points [m], the nearest point of its surface; points, distances and
        errors as those of `nearest`. The nearest shape of a point comes first."""
        worlds = asked(world, worlds)
        rows = self._worlds.rows(worlds)
        queries = Queries.of(rows, worlds, points=(points, 3))
        (places,) = queries.arrays
        return queries.near(self._engine.closest_points(rows, places, max_distance, sight(seen, self.model)), rows)

    def overlaps(
        self,
        geometry: Geometry,
        positions: ArrayLike,
        *,
        orientations: ArrayLike = (0.0, 0.0, 0.0, 1.0),
        world: int | None = None,
        worlds: ArrayLike | None = FIRST,
        seen: Seen | None = None,
    ) -> NearShapes:
        """The shapes that a convex shape overlaps or touches in some places; these, and errors, as those of
        `cast_shape`.

        Distances are 0 or less: how far the two overlap along the way out, which the normal tells.
        """
        worlds = asked(world, worlds)
        rows = self._worlds.rows(worlds)
        queries = Queries.of(rows, worlds, positions=(positions, 3), orientations=(orientations, 4))
        starts, turns = queries.arrays
        return queries.near(self._engine.overlaps(rows, geometry, starts, turns, sight(seen, self.model)), rows)

    def linearize(self, world: int = 0) -> Linearization:
        """A time step linearised about the state of a world: exact derivatives of the solver's own step in float64,
        with the controls as they stand, and the contacts that it remembers. `featherstone` only; others raise
        `SimulationError`.

        >>> import kinetarium as kn
        >>> step = kn.Simulation(kn.examples.n_pendula(2), dt=0.01).linearize()
        >>> step.state.shape, step.force.shape
        ((4, 4), (4, 2))
        """
        self._controls._send(self._engine)
        return Linearization(**self._engine.linearize(self._world(world)))

    def framing(self, world: int = 0, *, width: int = 640, height: int = 480) -> Camera:
        """A free camera that has all bodies of a world, as they are now, in its image [pixel]."""
        row, width, height = self._world(world), whole("width", width, 1), whole("height", height, 1)
        (x, y, z), (i, j, k, w), angle = framing(self._engine, self.model, row, width, height)
        return Camera(width, height, angle, position=(x, y, z), orientation=(i, j, k, w))

    def render(
        self, camera: Camera | str | None = None, *, worlds: ArrayLike | None = None, device: str = "cpu"
    ) -> Images:
        """What a camera sees in some worlds (all by default), without a window. The model's cameras
        (`model.camera_names`) go by their names.

        Images are drawn by rays on the processor, "cpu", or on a graphics card: "gpu", "gpu:NAME" with a part of its
        name, or "auto", which takes a card where there is one and it draws what the camera asks for. Cards take 1 or
        2 `samples` and no `occlusion`; they are opened at the first image of a model. Where the worlds run is another
        matter. Raises `DeviceError` where there is no such card, or it refuses.

        Without a camera: colours, 640 × 480, of the first world given, from where all its bodies are in the image.
        Raises `RenderError`, and `UnknownNameError` for a camera that the model has not.
        """
        rows = self._worlds.rows(worlds)
        if camera is None:
            if rows.size == 0:
                raise ShapeError("there are no worlds to be seen: give at least one")
            rows = rows[:1]
            camera = replace(self.framing(int(rows[0])), samples=2)
        elif isinstance(camera, str):
            camera = Camera.of(self.model, camera)
        elif not isinstance(camera, Camera):
            raise RenderError(f"the camera is {camera!r}: give a Camera, or the name of one")
        view = camera._view(self.model)
        return Images(**render_view(self._engine, self.model, view, rows, device))

    def view(
        self,
        *,
        address: str | None = None,
        token: str | None = None,
        browser: bool = True,
        height: int = 600,
        skins: Skins | None = None,
    ) -> View:
        """Shows the worlds on a page while the program goes on: in a browser where there is one, in a frame of the
        given height [pixel] in a notebook; where there is neither, the address is printed.

        The page watches what `step` does, and steers: run, step, drag bodies, set targets, plot, look back. It is
        served at a free port of the loopback address, or at `address` ("0.0.0.0:7357"), which wants a `token`.
        It stays until `View.close`, or until neither the simulation nor the view is left. Raises `ViewerError`, also
        for an open page that is wanted at another address. `skins` are what bodies wear, by their names
        (`{"torso": "speed", "crate": "crate.png"}`), as `View.dress` tells, which changes them at any time.
        """
        dressed = [(bodies, Skin.of(skin)) for bodies, skin in (skins or {}).items()]
        for bodies, _ in dressed:
            for name in (bodies,) if isinstance(bodies, str) else bodies or ():
                self.body(name)  # before anything is shown
        if self._view is None or not self._view.is_open:
            self._view = View(show(self._engine, address, token), address, token)
        self._view._check(address, token)
        for bodies, skin in dressed:
            self._view.dress(bodies, skin)
        self._view._show(browser, height)
        return self._view

    def watch(self, *events: Watched) -> None:
        """Chooses which events are told from now on, by kind; none to begin with, and none without arguments.

        Watching costs a report of every substep.
        """
        kinds = get_args(Watched)
        for event in events:
            if event not in kinds:
                raise UnknownNameError(f'there are no events "{event}"; {hint(event, kinds)}')
        self._engine.watch(**{kind: kind in events for kind in kinds})
        self._watched = events

    def events(self) -> list[Event]:
        """The events since the last call, in an order that does not depend on threads."""
        return [Event(*event) for event in self._engine.drain_events()]

    def close(self) -> None:
        """Frees the worlds now rather than with the object; later calls raise `ClosedError`."""
        if not self._worlds.closed:
            self._worlds.close()
            if self._view is not None:
                self._view.close()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        if self._worlds.closed:
            return f"<Simulation of {self.model.name!r}, closed>"
        place = f"{self._isa}, {self._threads} threads" if self._device == "cpu" else self._device
        return (
            f"<Simulation of {self.model.name!r}: {self.worlds} worlds, {self._solver}, dt {self.dt:g} s, "
            f"{self.dtype}, {place}>"
        )

    def __getstate__(self) -> dict[str, Any]:
        names = [name for name in parameter_names() if self._differs(name)]
        return {
            "model": self.model,
            "worlds": self.worlds,
            "dtype": self.dtype.name,
            "settings": self._settings,
            "parameters": {name: np.asarray(getattr(self._parameters, name)) for name in names},
            "snapshot": self.snapshot(),
            "watched": self._watched,
            "sensors": self._sensors.list,
            "seed": self._sensors.seed,
            "readings": self._sensors._save(),
            "own": getattr(self, "__dict__", {}),
        }

    def _differs(self, name: str) -> bool:
        """Whether a world differs from the model in a parameter."""
        numbers = self._engine.read_parameter(name, np.arange(self.worlds))
        return bool((numbers != self.model.parameter(name).ravel()).any())

    def __setstate__(self, state: dict[str, Any]) -> None:
        for name, value in state["own"].items():
            setattr(self, name, value)
        Simulation.__init__(
            self,
            state["model"],
            state["worlds"],
            dtype=state["dtype"],
            sensors=state["sensors"],
            seed=state["seed"],
            **state["settings"],
        )
        self._parameters.update(state["parameters"])
        self.restore(state["snapshot"])
        with self._worlds.changing():
            self._sensors._restore(self, state["readings"])
        self.watch(*state["watched"])
