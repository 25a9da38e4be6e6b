"""What a robot has to do, in many worlds at once."""

from __future__ import annotations

import importlib
import importlib.util
from abc import ABC, abstractmethod
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import gymnasium
import numpy as np

import kinetarium as kn
from kinetarium.errors import ShapeError
from kinetarium.simulation import Integrator
from kinetarium.state import quaternion_columns

Array = np.ndarray[Any, np.dtype[Any]]


def model_file(given: str | Path | None, usual: str) -> Path:
    """Where a robot's file is: what was given, a path or a name among Gymnasium's files; else the usual one, which no
    file of the working directory replaces. `~` is the home directory. `FileNotFoundError` where there is none.
    """
    spec = importlib.util.find_spec("gymnasium.envs")
    assert spec is not None and spec.origin is not None
    assets = Path(spec.origin).parent / "mujoco" / "assets"
    name = str(usual if given is None else given)
    path = Path(name).expanduser()
    places = [path]
    if path.name == name:  # no directory: it may be one of Gymnasium's
        places.insert(0 if given is None else 1, assets / name)
    for place in places:
        if place.is_file():
            return place
    missing = " nor ".join(f'"{place}"' for place in places)
    raise FileNotFoundError(f"there is no file {missing}: give a path, or a name among Gymnasium's files")


def coordinate_orders(model: kn.Model) -> tuple[Array, Array]:
    """Which of kinetarium's coordinates each of MuJoCo's is, and the other way round.

    They differ in quaternions: w is first in MuJoCo's, last in kinetarium's.
    """
    order = np.arange(model.coordinates)
    for columns in quaternion_columns(model).values():
        order[columns] = np.roll(order[columns], 1)
    return order, np.argsort(order)


class Seen:
    """All worlds at one time, in MuJoCo's conventions; what is not asked for is not computed.

    Ask before the next step: what has not been read by then is no longer of this time.
    """

    position: Array
    """Joint coordinates, quaternions w first, float64, shape (worlds, coordinates)."""

    def __init__(self, task: Task) -> None:
        self._task = task
        self._state = task.simulation.state
        position = self._state.read("joint_position")
        self.position = position.take(task.to_mujoco, axis=1).astype(np.float64)

    @cached_property
    def velocity(self) -> Array:
        """Joint velocities, shape (worlds, degrees of freedom)."""
        return self._state.read("joint_velocity").astype(np.float64)

    @cached_property
    def body_position(self) -> Array:
        """Positions of the bodies [m], shape (worlds, bodies, 3)."""
        return self._state.read("body_position")

    @cached_property
    def center_of_mass(self) -> Array:
        """Centre of mass of all bodies [m], shape (worlds, 3)."""
        return self._state.read("center_of_mass")

    @cached_property
    def contact_force(self) -> Array:
        """`cfrc_ext` but for the world's row: torque about the centre of mass of its tree and force [N·m, N] of
        the contacts of the last step on each body, world axes, shape (worlds, bodies, 6)."""
        return self._state.read("spatial_contact_force")

    @cached_property
    def motor_force(self) -> Array:
        """Forces of the motors that acted [N or N·m], zero after a reset, shape (worlds, actuators)."""
        return np.asarray(self._task.simulation.controls.actuator) * self._task.gear

    @cached_property
    def joint_force(self) -> Array:
        """Forces of the joints on their bodies [N], world axes, shape (worlds, joints, 3)."""
        return self._state.read("reaction_force")


class Task(ABC):
    """A robot, what it observes, what it is paid for, when it fails, and where it begins; in all worlds at
    once.

    A subclass says what is particular. Parameters that all have:

    worlds:
        Number of worlds.
    xml_file:
        The robot's file: a path, or a name among Gymnasium's; by default the class's `file`.
    frame_skip:
        Time steps of one action, 1 or more.
    integrator, substeps, dtype, threads, device:
        As of `kinetarium.Simulation`. Runge–Kutta is what most of Gymnasium's files ask for; semi-implicit
        Euler takes a third of the time.

    Raises `ValueError` for numbers that cannot be, and for files of robots that lack what is observed. Tasks, and the
    environments made of them, can be pickled and copied in the middle of an episode, and go on to the bit.
    """

    file: ClassVar[str]
    """The robot's file: a name among Gymnasium's, or a path."""
    frame_skip: ClassVar[int]
    """Time steps of one action, unless told otherwise."""
    turning: ClassVar[tuple[str, ...]] = ()
    """Coordinates that count whole turns, which the simulation does not."""

    def __init__(
        self,
        worlds: int = 1,
        *,
        xml_file: str | Path | None = None,
        frame_skip: int | None = None,
        integrator: Integrator = "runge_kutta_4",
        substeps: int = 1,
        dtype: str = "float32",
        threads: int = 0,
        device: str = "cpu",
    ) -> None:
        if worlds < 1:
            raise ValueError(f"the number of worlds is {worlds}: it must be 1 or more")
        steps = self.frame_skip if frame_skip is None else frame_skip
        if not isinstance(steps, (int, np.integer)) or steps < 1:
            raise ValueError(f"frame_skip is {steps}: it must be a whole number of time steps, 1 or more")
        file = model_file(xml_file, self.file)
        model = kn.load(str(file))
        for name in self.turning:
            if name not in model.coordinate_names:
                raise ValueError(
                    f'"{file.name}" has no joint "{name}", which {type(self).__name__} observes: '
                    "give a file of such a robot"
                )
        self.simulation = kn.Simulation(
            model,
            worlds,
            solver="featherstone",
            integrator=integrator,
            substeps=substeps,
            dtype=dtype,
            threads=threads,
            device=device,
        )
        self.worlds = worlds
        self.model = model
        self.steps = int(steps)
        self.dt = model.time_step * self.steps
        self.to_mujoco, self.from_mujoco = coordinate_orders(model)
        self.init_position = np.asarray(model.initial_position)[self.to_mujoco]
        self.gear = (model.parameter("gear") * model.parameter("gain")).ravel()
        low, high = np.asarray(model.control_range).T
        self._range = low.astype(self.simulation.dtype), high.astype(self.simulation.dtype)
        self._action_shape = worlds, len(low)
        self.action_space = gymnasium.spaces.Box(low.astype(np.float32), high.astype(np.float32))
        self._turning = [model.coordinate_names.index(name) for name in self.turning]
        self._turned = np.zeros((worlds, len(self._turning)))
        self._lost = np.zeros(worlds, bool)
        self._camera: tuple[kn.Camera, Array] | None = None
        self._look()
        state = self.simulation.state
        parts = self._observed()
        width = sum(state.read(part)[0].size if isinstance(part, str) else part[0].size for part in parts)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (width,), np.float64)

    @abstractmethod
    def observation(self, seen: Seen) -> Array | list[Array] | list[Array | str]:
        """What is observed, part by part, each an array of shape (worlds, …), or the name of a quantity of
        `kinetarium.State`, which is copied where it belongs; or one such array alone."""

    @abstractmethod
    def outcome(self, seen: Seen, action: Array, velocity: Array) -> tuple[Array, Array, dict[str, Array]]:
        """Rewards and which worlds failed (bool), of shape (worlds,) each, and what to tell besides, of shape
        (worlds, …) each.

        `velocity` [m/s] is how far `place` moved in the step, by its time.
        """

    @abstractmethod
    def draw(self, random: np.random.Generator) -> tuple[Array, Array]:
        """Coordinates and velocities in which one world begins, in MuJoCo's conventions, of shape (coordinates,) and
        (degrees of freedom,)."""

    def place(self, seen: Seen) -> Array:
        """The point whose velocity is paid for [m], shape (worlds, numbers)."""
        return np.zeros((self.worlds, 0))

    def whereabouts(self, seen: Seen) -> dict[str, Array]:
        """What to tell after a reset, too."""
        return {}

    def noise(
        self, random: np.random.Generator, scale: float, *, normal_velocity: bool = False
    ) -> tuple[Array, Array]:
        """The initial state with noise: uniform within ± scale, or velocities of that standard deviation."""
        n, m = self.model.coordinates, self.model.degrees_of_freedom
        position = self.init_position + random.uniform(low=-scale, high=scale, size=n)
        if normal_velocity:
            return position, scale * random.standard_normal(m)
        return position, random.uniform(low=-scale, high=scale, size=m)

    def begin(self, worlds: Array, generators: list[np.random.Generator]) -> None:
        """Draws new states for some worlds."""
        self._draw(worlds, generators)
        self._look()

    def set_state(self, position: Array, velocity: Array) -> None:
        """Puts all worlds into states in MuJoCo's conventions, of shape (worlds, coordinates) and (worlds, degrees of
        freedom). Raises `ShapeError`."""
        self._set(position, velocity, np.arange(self.worlds))
        self._look()

    def act(
        self, action: Array, begins: Array | None = None, generators: list[np.random.Generator] | None = None
    ) -> tuple[Array, Array, dict[str, Array]]:
        """One step of all worlds: rewards, which worlds failed, and what to tell.

        A world that diverged has failed, and stays at its last good state. Worlds that are to begin anew do
        that instead; their numbers mean nothing. Raises `ValueError` for actions of the wrong shape or that
        are not finite numbers.
        """
        self._apply(action)
        before = self._place
        self._lost[self.simulation.step(self.steps)] = True
        if begins is not None and generators is not None:
            self._draw(begins, generators)
        self._look()
        velocity = (self._place - before) / self.dt
        reward, failed, info = self._judged(action, velocity)
        return reward, failed | self._lost, self.whereabouts(self.seen) | info

    def observe(self) -> Array:
        """What all worlds observe, float64, shape (worlds, numbers); yours to keep."""
        observed = np.empty((self.worlds, *self.observation_space.shape))
        column = 0
        for part in self._observed():
            if isinstance(part, str):
                column = self.simulation.state.read_columns(part, observed, column)
                continue
            width = part[0].size
            observed[:, column : column + width].reshape(part.shape)[...] = part
            column += width
        return observed

    def picture(self, world: int, width: int = 480, height: int = 480) -> Array:
        """Colours of a world, uint8 of shape (height, width, 3), from a camera that goes along with the robot."""
        middle = self.simulation.state.body_position[world].mean(axis=0)
        if self._camera is None or (self._camera[0].width, self._camera[0].height) != (width, height):
            framed = self.simulation.framing(world, width=width, height=height)
            self._camera = framed, np.subtract(framed.position, middle)
        camera, arm = self._camera
        x, y, z = (float(number) for number in middle + arm)
        images = self.simulation.render(replace(camera, position=(x, y, z)), worlds=[world])
        picture: Array = images.rgb[0] if images.rgb is not None else np.zeros((height, width, 3), np.uint8)
        return picture

    def __getstate__(self) -> dict[str, Any]:
        # What is seen is read anew from the simulation, which has all of its state.
        return {name: value for name, value in vars(self).items() if name not in ("seen", "_place")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._look()

    def _observed(self) -> list[Array | str]:
        """The parts of the observation; `ShapeError` where they are not of all worlds."""
        given = self.observation(self.seen)
        parts = [given] if isinstance(given, str) or hasattr(given, "__array__") else given
        return [
            part if isinstance(part, str) else self._rows(f"observation: part {k}", part)
            for k, part in enumerate(parts)
        ]

    def _judged(self, action: Array, velocity: Array) -> tuple[Array, Array, dict[str, Array]]:
        """The outcome; `ShapeError` where it is not of all worlds."""
        reward, failed, info = self.outcome(self.seen, action, velocity)
        reward = self._rows("outcome: the reward", reward, single=True)
        failed = self._rows("outcome: failed", failed, single=True)
        if failed.dtype != bool:
            raise ShapeError(f"{type(self).__name__}.outcome: failed is of dtype {failed.dtype}: it must be bool")
        return reward, failed, {name: self._rows(f'outcome: info["{name}"]', told) for name, told in info.items()}

    def _rows(self, what: str, given: Any, *, single: bool = False) -> Array:
        """An array with a row for each world, or a `single` item; `ShapeError` where it is another."""
        rows = np.asarray(given)
        if rows.shape[:1] != (self.worlds,) or (single and rows.ndim > 1):
            expected = f"({self.worlds},)" if single else f"({self.worlds}, …)"
            raise ShapeError(f"{type(self).__name__}.{what} has the shape {rows.shape}: it must be {expected}")
        return rows

    def _draw(self, worlds: Array, generators: list[np.random.Generator]) -> None:
        if len(worlds) > 0:
            position, velocity = zip(*map(self.draw, generators), strict=True)
            self._set(np.array(position), np.array(velocity), worlds)

    def _set(self, position: Array, velocity: Array, worlds: Array) -> None:
        expected = (len(worlds), self.model.coordinates)
        if position.shape[1:] != expected[1:]:
            raise ShapeError(f"the coordinates of the worlds have the shape {position.shape}: it must be {expected}")
        self.simulation.set_state(position[:, self.from_mujoco], velocity, worlds=worlds)
        self._turned[worlds] = position[:, self._turning]
        self._lost[worlds] = False

    def _apply(self, action: Array) -> None:
        if action.shape != self._action_shape:
            raise ValueError(f"the actions have the shape {action.shape}: it must be {self._action_shape}")
        if action.dtype.kind not in "fiub":
            raise ValueError(f"the actions are of dtype {action.dtype}: give real numbers")
        finite = np.isfinite(action)
        if not finite.all():
            wrong = np.flatnonzero(~finite.all(axis=1))[0]
            raise ValueError(f"the action of world {wrong} is not finite: {action[wrong]}")
        low, high = self._range
        np.minimum(np.maximum(action, low), high, out=np.asarray(self.simulation.controls.actuator))

    def _look(self) -> None:
        seen = Seen(self)
        if self._turning:
            angle = seen.position[:, self._turning]
            angle += 2 * np.pi * np.rint((self._turned - angle) / (2 * np.pi))
            seen.position[:, self._turning] = self._turned = angle
        self.seen = seen
        self._place = self.place(seen).copy()


def make_task(task: str | type[Task], worlds: int, **options: Any) -> Task:
    """The task of a class, or of one named "module:Class"; `ValueError` for what is neither."""
    maker: Any = task
    if isinstance(task, str) and ":" in task:
        module, name = task.split(":", 1)
        maker = getattr(importlib.import_module(module), name)
    if not callable(maker):
        raise ValueError(f'the task is {task!r}: give a class derived from Task, or its name "module:Class"')
    made: Task = maker(worlds, **options)
    return made
