"""What robots measure, in all worlds at once, with rates and noise of their own.

>>> import kinetarium as kn
>>> from kinetarium import sensors
>>> sim = kn.Simulation(
...     kn.examples.n_pendula(2),
...     worlds=64,
...     sensors=[
...         sensors.JointPosition("angles"),
...         sensors.Imu("imu", "link1", position=(0, -0.5, 0), rate=100, noise=sensors.Noise(deviation=0.02)),
...         sensors.Custom("height", lambda sim: sim.state.body_position[:, "link1", 1], rate=50),
...     ],
...     seed=1,
... )
>>> _ = sim.step(50)  # 0.1 s at 2 ms, in which the imu is sampled ten times
>>> sim.sensors["imu"].shape, sim.sensors["angles"].shape, sim.sensors["height"].shape
((64, 6), (64, 2), (64,))
>>> round(float(sim.sensors.time("imu")[0]), 6)
0.1

Readings hold from one sample to the next. A sensor with a rate is sampled at the first step at or after its time
is due. Noise is a function of seed, sensor, world and sample: the same whatever the number of worlds and threads.
"""

from __future__ import annotations

import weakref
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from kinetarium._custom import CustomArray
from kinetarium._engine import Engine, Measurement, Model, SensorArray
from kinetarium.arrays import is_vector
from kinetarium.cameras import Camera as Pinhole
from kinetarium.cameras import Images
from kinetarium.errors import ClosedError, SensorError, UnknownNameError
from kinetarium.names import Strict, hint
from kinetarium.types import Frame, Place, Vector

if TYPE_CHECKING:
    from kinetarium.simulation import Simulation

Level = float | Vector
"""One number for all of a reading, or one for each."""
Axes = Literal["world", "own"]


@dataclass(frozen=True)
class Noise:
    """What a sensor adds to the truth, in the unit of its reading; nothing by default. Raises `SensorError` for what
    is no number."""

    deviation: Level = 0.0
    """Standard deviation of white noise."""
    bias: Level = 0.0
    """Standard deviation of an offset that is drawn once for each world, for good."""
    walk: Level = 0.0
    """Standard deviation of a random walk after one second."""
    step: Level = 0.0
    """What readings are rounded to multiples of; 0 is not at all."""

    def __post_init__(self) -> None:
        for what in ("deviation", "bias", "walk", "step"):
            level = getattr(self, what)
            if not is_vector(level):
                raise SensorError(f"the noise's {what} is {level!r}: give a number, or one for each of the reading")

    def _levels(self) -> list[float | list[float]]:
        levels = self.deviation, self.bias, self.walk, self.step
        return [float(x) if np.ndim(x) == 0 else [float(v) for v in x] for x in levels]  # type: ignore


@dataclass(frozen=True)
class Sensor(ABC):
    """What every sensor has."""

    name: str
    """Unique among the sensors."""
    rate: float | None = field(default=None, kw_only=True)
    """Samples a second; none: every step."""
    noise: Noise = field(default_factory=Noise, kw_only=True)
    """What is added to the truth."""
    cutoff: float | None = field(default=None, kw_only=True)
    """Readings are kept within ± this, noise included; none: of any size."""

    @abstractmethod
    def _measurement(self, model: Model) -> Measurement: ...


@dataclass(frozen=True)
class JointPosition(Sensor):
    """Coordinates of joints [m, rad, quaternions], shape (worlds, coordinates); of all that have any by default."""

    joints: Sequence[str] | None = None

    def _measurement(self, model: Model) -> Measurement:
        return Measurement.joint_position(model, _listed(self.joints))


@dataclass(frozen=True)
class JointVelocity(Sensor):
    """Velocities of joints [m/s or rad/s], shape (worlds, degrees of freedom); of all by default."""

    joints: Sequence[str] | None = None

    def _measurement(self, model: Model) -> Measurement:
        return Measurement.joint_velocity(model, _listed(self.joints))


@dataclass(frozen=True)
class JointEffort(Sensor):
    """Forces of drives, actuators and controls along degrees of freedom [N or N·m], shape (worlds, degrees of
    freedom)."""

    joints: Sequence[str] | None = None

    def _measurement(self, model: Model) -> Measurement:
        return Measurement.joint_effort(model, _listed(self.joints))


@dataclass(frozen=True)
class ActuatorForce(Sensor):
    """Forces of actuators before their gears [N or N·m], shape (worlds, actuators); of all by default."""

    actuators: Sequence[str] | None = None

    def _measurement(self, model: Model) -> Measurement:
        return Measurement.actuator_force(model, _listed(self.actuators))


def _listed(names: Sequence[str] | None) -> list[str] | None:
    return [names] if isinstance(names, str) else None if names is None else list(names)


def _check_place(name: str, position: Vector, orientation: Vector) -> None:
    for what, numbers, count in (("position", position, 3), ("orientation", orientation, 4)):
        if not is_vector(numbers, count):
            raise SensorError(f'the {what} of sensor "{name}" is {numbers!r}: give {count} numbers')


@dataclass(frozen=True)
class _Mounted(Sensor):
    """A sensor with a place on a body, or in the world where `body` is none."""

    body: str | None = None
    position: Vector = field(default=(0.0, 0.0, 0.0), kw_only=True)
    """In the body's frame, or in the world [m]."""
    orientation: Vector = field(default=(0.0, 0.0, 0.0, 1.0), kw_only=True)
    """In the body's frame, or in the world, x, y, z, w."""

    def __post_init__(self) -> None:
        _check_place(self.name, self.position, self.orientation)

    def _place(self) -> Place:
        return self.body, self.position, self.orientation


@dataclass(frozen=True)
class Imu(_Mounted):
    """An inertial unit: acceleration less gravity [m/s²] (at rest it reads 9.81 upwards), then angular velocity
    [rad/s], in its own axes, shape (worlds, 6)."""

    def _measurement(self, model: Model) -> Measurement:
        return Measurement.imu(model, self._place())


@dataclass(frozen=True)
class ForceTorque(Sensor):
    """Force [N] and torque [N·m] of a joint on its child, shape (worlds, 6), in a frame of the child (position,
    orientation), by default the joint's."""

    joint: str = ""
    frame: Frame | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        if self.frame is not None:
            if len(self.frame) != 2:
                needed = "give a position and a quaternion"
                raise SensorError(f'the frame of sensor "{self.name}" is {self.frame!r}: {needed}')
            _check_place(self.name, *self.frame)

    def _measurement(self, model: Model) -> Measurement:
        return Measurement.force_torque(model, self.joint, self.frame)


@dataclass(frozen=True)
class Touch(Sensor):
    """Sum of the normal forces of contacts on a body [N], shape (worlds, 1)."""

    body: str = ""

    def _measurement(self, model: Model) -> Measurement:
        return Measurement.touch(model, self.body)


@dataclass(frozen=True)
class ContactForce(Sensor):
    """Sum of the contact forces on a body [N], in its own axes or the world's, shape (worlds, 3)."""

    body: str = ""
    axes: Axes = field(default="own", kw_only=True)

    def _measurement(self, model: Model) -> Measurement:
        return Measurement.contact_force(model, self.body, self.axes)


@dataclass(frozen=True)
class FramePose(_Mounted):
    """Position [m] and quaternion x, y, z, w, in the world or relative to a body, shape (worlds, 7)."""

    relative_to: str | None = field(default=None, kw_only=True)

    def _measurement(self, model: Model) -> Measurement:
        reference = (self.relative_to, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
        return Measurement.frame_pose(model, self._place(), reference)


@dataclass(frozen=True)
class FrameVelocity(_Mounted):
    """Velocity [m/s] and angular velocity [rad/s], in its own axes or the world's, shape (worlds, 6)."""

    axes: Axes = field(default="own", kw_only=True)

    def _measurement(self, model: Model) -> Measurement:
        return Measurement.frame_velocity(model, self._place(), self.axes)


@dataclass(frozen=True)
class CenterOfMass(Sensor):
    """Centre of mass of a body and all that joints carry from it on, or of all bodies [m], world axes, shape (worlds,
    3). Static bodies have no mass."""

    body: str | None = None

    def _measurement(self, model: Model) -> Measurement:
        return Measurement.center_of_mass(model, self.body)


@dataclass(frozen=True)
class Rangefinder(_Mounted):
    """Distance [m] along x of its frame to what is there, at most `max_range`, which also stands for nothing; shape
    (worlds, 1)."""

    max_range: float = field(default=inf, kw_only=True)

    def _measurement(self, model: Model) -> Measurement:
        return Measurement.rangefinder(model, self._place(), self.max_range)


@dataclass(frozen=True)
class Lidar(_Mounted):
    """Distances [m] along a fan of rays, shape (worlds, elevations, azimuths); `max_range` where nothing is met.

    The ray of azimuth α and elevation ε [rad] goes along (cos ε cos α, cos ε sin α, sin ε) in its frame: x forwards,
    y to the left, z upwards. It does not see its own body.
    """

    azimuths: Vector = field(default=(0.0,), kw_only=True)
    elevations: Vector = field(default=(0.0,), kw_only=True)
    max_range: float = field(default=inf, kw_only=True)

    def _measurement(self, model: Model) -> Measurement:
        azimuths, elevations = ([float(a) for a in angles] for angles in (self.azimuths, self.elevations))
        return Measurement.lidar(model, self._place(), azimuths, elevations, self.max_range)


@dataclass(frozen=True)
class Camera(Sensor):
    """Images of a `kinetarium.Camera`, or of one of the model's by its name; its reading is an `Images`. Its noise is
    that of its images: normal numbers, independent from pixel to pixel and image to image, the same for the same
    `seed`."""

    camera: Pinhole | str = field(default_factory=Pinhole)
    rgb_noise: float = field(default=0.0, kw_only=True)
    """Standard deviation of red, green and blue, each in its sRGB value from 0 to 1."""
    depth_noise: float = field(default=0.0, kw_only=True)
    """Standard deviation of depth [m]; what is infinitely far stays there."""
    device: str = field(default="cpu", kw_only=True)
    """Where its images are drawn, as of `Simulation.render`: "cpu", "gpu", "gpu:NAME" or "auto"."""

    def _measurement(self, model: Model) -> Measurement:
        camera = Pinhole.of(model, self.camera) if isinstance(self.camera, str) else self.camera
        if not isinstance(camera, Pinhole):
            raise SensorError(f'the camera of sensor "{self.name}" is {camera!r}: give a Camera, or its name')
        return Measurement.camera(camera._view(model), self.rgb_noise, self.depth_noise, self.device)


@dataclass(frozen=True)
class Described(Sensor):
    """A sensor that the model's file describes, by its name there, which is its own by default; see `from_model`."""

    source: str | None = None

    def _measurement(self, model: Model) -> Measurement:
        return Measurement.described(model, self.source or self.name)


def from_model(model: Model) -> list[Sensor]:
    """The sensors that the model's file describes (MJCF's `<sensor>`), with their rates, cutoffs and noise:

        model = kn.load("robot.xml")
        sim = kn.Simulation(model, worlds=64, sensors=kn.sensors.from_model(model))

    They are as others: to be left out, changed by `dataclasses.replace`, and given beside others. Readings are
    MuJoCo's `sensordata`, but for the order of quaternions, x, y, z, w; for rangefinders that meet nothing, which
    read their cutoff, or infinity; and for noise, which MuJoCo does not add.
    """
    return [
        Described(name, rate=rate, noise=Noise(deviation=noise), cutoff=cutoff)
        for name, rate, noise, cutoff in model.sensors
    ]


@dataclass(frozen=True)
class Custom:
    """A sensor of one's own: a function of the simulation that gives an array with a row for each world.

    It is called where a sample is due in any world; the others keep what was measured last. It must not change the
    simulation: `BusyError` where it steps or resets it. Where it fails, the simulation stands at the step of the
    sample.
    """

    name: str
    """Unique among the sensors."""
    measure: Callable[[Simulation], ArrayLike]
    rate: float | None = field(default=None, kw_only=True)
    """Samples a second; none: every step, which makes steps one at a time."""
    noise: Noise = field(default_factory=Noise, kw_only=True)
    """What is added to the truth, which makes readings floating-point numbers."""
    cutoff: float | None = field(default=None, kw_only=True)
    """Readings are kept within ± this, noise included; none: of any size."""


class Sensors(Strict, Mapping[str, Any]):
    """The sensors of a simulation: readings by name, as arrays of their own."""

    __slots__ = ("_array", "_cameras", "_custom", "_simulation", "list", "seed")

    def __init__(
        self, simulation: Simulation, sensors: Iterable[Sensor | Custom] | Sensor | Custom, seed: int
    ) -> None:
        sensors = (sensors,) if isinstance(sensors, Sensor | Custom) else tuple(sensors)
        for sensor in sensors:
            if not isinstance(sensor, Sensor | Custom):
                raise SensorError(f"{sensor!r} is no sensor: give those of kinetarium.sensors")
            if not isinstance(sensor.noise, Noise):
                raise SensorError(
                    f'the noise of sensor "{sensor.name}" is {sensor.noise!r}: give a Noise, as Noise(deviation=0.1)'
                )
        self._simulation = weakref.ref(simulation)
        self.list = sensors
        """The sensors as they were given."""
        self.seed = seed
        """Seed of the noise."""
        names = [s.name for s in sensors]
        for name in names:
            if names.count(name) > 1:
                raise SensorError(f'two sensors are named "{name}"; rename one')
        drafts = [self._draft(s, simulation.model) for s in sensors if isinstance(s, Sensor)]
        self._array = SensorArray(simulation._engine, drafts, seed) if drafts else None
        self._cameras = {s.name for s in sensors if isinstance(s, Camera)}
        custom = [s for s in sensors if isinstance(s, Custom)]
        self._custom = CustomArray(custom, simulation.worlds, simulation.dt, seed)

    @staticmethod
    def _draft(sensor: Sensor, model: Model) -> tuple[Any, ...]:
        return sensor.name, sensor._measurement(model), sensor.rate, sensor.cutoff, sensor.noise._levels()

    def _step(self, simulation: Simulation, engine: Engine, steps: int) -> list[int]:
        diverged: list[int] = []
        while steps > 0:
            part = int(min(steps, self._custom.steps_until_due(simulation)))
            if self._array is None:
                diverged += engine.step(part)
            else:
                diverged += self._array.step(engine, part)
            self._custom.update(simulation)
            steps -= part
        return diverged

    def _update(self, simulation: Simulation) -> None:
        """Samples anew what was set or reset."""
        if self._array is not None:
            self._array.update(simulation._engine)
        self._custom.update(simulation)

    def resample(self) -> None:
        """Takes samples of the present time of a world anew, with the noise that they had: after items of the state,
        controls or parameters were set. Others hold; steps and resets sample by themselves."""
        simulation = self._simulation()
        if simulation is None:
            raise ClosedError("the simulation of these sensors is gone")
        with simulation._worlds.changing() as engine:
            simulation._controls._send(engine)
            if self._array is not None:
                self._array.resample(engine)
            self._custom.update(simulation, anew=True)

    def _save(self) -> dict[str, Any]:
        return {"array": None if self._array is None else self._array.save(), "custom": self._custom.save()}

    def _restore(self, simulation: Simulation, saved: dict[str, Any]) -> None:
        """Puts back what `_save` gave, and looks at the worlds, so that it is seen which are reset from now on."""
        if self._array is not None:
            self._array.restore(saved["array"])
        self._custom.restore(saved["custom"])
        self._update(simulation)

    def _read(self, name: str) -> tuple[Any, np.ndarray]:
        if name in self._custom:
            return self._custom.reading(name)
        if self._array is None or name not in self:
            raise UnknownNameError(f'there is no sensor "{name}"; {hint(name, list(self))}')
        if name in self._cameras:
            images, time = self._array.images(name)
            return Images(**images, time=time), time
        return self._array.reading(name)

    def __getitem__(self, name: str) -> Any:
        """The reading of a sensor: an array with a row for each world, or `Images`."""
        return self._read(name)[0]

    # `Mapping` counts on `KeyError` where there is no such name.
    def __contains__(self, name: object) -> bool:
        return any(sensor.name == name for sensor in self.list)

    def get(self, name: str, default: Any = None) -> Any:
        """The reading of a sensor, or `default` where there is none of this name."""
        try:
            return self[name]
        except UnknownNameError:
            return default

    def time(self, name: str) -> np.ndarray:
        """When each world's reading of a sensor was taken [s], shape (worlds,)."""
        return self._read(name)[1]

    def __iter__(self) -> Iterator[str]:
        return (sensor.name for sensor in self.list)

    def __len__(self) -> int:
        return len(self.list)

    def __repr__(self) -> str:
        return f"<Sensors: {', '.join(self) or 'none'}>"
