"""Custom sensors of one simulation: when they are sampled, and what they read."""

from __future__ import annotations

from copy import deepcopy
from math import inf, prod
from typing import TYPE_CHECKING, Any

import numpy as np

from kinetarium._engine import Disturbance
from kinetarium.errors import SensorError, ShapeError

if TYPE_CHECKING:
    from kinetarium.sensors import Custom
    from kinetarium.simulation import Simulation

# A due time so little after a step, in periods, counts as reached.
_SLACK = 1e-6


class _Channel:
    """A sensor in all worlds. Each has a clock of its own: sample k of a rate r is due at its time k/r, and taken at
    the first step at or after."""

    def __init__(self, sensor: Custom, worlds: int, dt: float, seed: int) -> None:
        rate = sensor.rate
        if rate is not None and not 0 < rate <= 1e9:
            raise SensorError(
                f'the rate of sensor "{sensor.name}" is {rate}: it must be above 0 and at most 1e9, in Hz'
            )
        self.sensor = sensor
        self._seed = seed
        self._disturbance: Disturbance | None = None  # as soon as it is known of how many numbers
        self._per_step = 1.0 if rate is None else rate * dt
        self._period = dt if rate is None else 1 / rate
        self.reading: np.ndarray | None = None
        self.time = np.zeros(worlds)
        """Of the last samples [s]."""
        self._last = np.full(worlds, -1)  # which samples these were, from 0 at time 0; −1 before the first
        self._walk = np.zeros((worlds, 0))  # biases that wander

    def _number(self, steps: np.ndarray) -> np.ndarray:
        """The latest sample that is due after so many steps."""
        return np.asarray(np.floor(steps * self._per_step + _SLACK), np.int64)

    def steps_until_due(self, steps: np.ndarray) -> np.ndarray:
        """How many steps, 1 or more, until a later sample is due."""
        return np.asarray(np.maximum(np.ceil((self._number(steps) + 1 - _SLACK) / self._per_step) - steps, 1))

    def due(self, steps: np.ndarray, time: np.ndarray, anew: bool) -> np.ndarray:
        """Whether a sample is to be taken now, or was taken now and is to be taken `anew`."""
        return np.asarray((self._number(steps) != self._last) | (anew & (self.time == time)))

    def forget(self, worlds: np.ndarray) -> None:
        """These worlds begin anew."""
        self._last[worlds], self._walk[worlds] = -1, 0

    def take(
        self, truth: np.ndarray, due: np.ndarray, time: np.ndarray, steps: np.ndarray, began: np.ndarray
    ) -> None:
        """Reads what was measured, in the worlds that are due; `began` is how often each has begun anew."""
        self._fit(truth)
        number = self._number(steps)
        passed = np.where(self._last < 0, 0, number - self._last)
        elapsed = self._period * passed
        samples = [x.tolist() for x in (due, began[due], number[due], elapsed[due])]
        read = self._disturbed(truth, list(zip(*samples, strict=True)))[due]
        before = truth if self.reading is None else self.reading
        self.reading = before.astype(np.result_type(before, read))
        self.reading[due], self.time[due], self._last[due] = read, time[due], number[due]

    def _fit(self, truth: np.ndarray) -> None:
        name, worlds = self.sensor.name, len(self.time)
        if truth.ndim == 0 or len(truth) != worlds:
            raise ShapeError(
                f'sensor "{name}" gave the shape {truth.shape}: it must have {worlds} rows, one for each world'
            )
        if self.reading is not None and truth.shape != self.reading.shape:
            raise ShapeError(f'sensor "{name}" gave the shape {truth.shape}: it must stay {self.reading.shape}')
        numbers = prod(truth.shape[1:])
        if self._disturbance is None:
            sensor = self.sensor
            self._disturbance = Disturbance(name, self._seed, sensor.noise._levels(), sensor.cutoff, numbers)
        if self.reading is None:
            self._walk = np.zeros((worlds, numbers))

    def _disturbed(self, truth: np.ndarray, samples: list[tuple[int, int, int, float]]) -> np.ndarray:
        """With noise and cutoff where there is a sample; as it is, where there is neither of them."""
        if self._disturbance is None or self._disturbance.is_none:
            return truth
        numbers = np.array(truth, np.float64).reshape(self._walk.shape)
        self._disturbance.apply(samples, numbers, self._walk)
        return numbers.reshape(truth.shape).astype(truth.dtype if truth.dtype.kind == "f" else np.float64)

    def save(self) -> Any:
        return deepcopy((self.reading, self.time, self._last, self._walk))

    def restore(self, saved: Any) -> None:
        self.reading, self.time, self._last, self._walk = deepcopy(saved)


class CustomArray:
    """What `SensorArray` is to the engine's sensors."""

    def __init__(self, sensors: list[Custom], worlds: int, dt: float, seed: int) -> None:
        self._channels = {sensor.name: _Channel(sensor, worlds, dt, seed) for sensor in sensors}
        self._dt = dt
        # `Engine.begun` when the worlds were last looked at; none: it may be any.
        self._seen: np.ndarray | None = None
        self._began = np.zeros(worlds, np.int64)  # how often each has begun anew

    def __contains__(self, name: str) -> bool:
        return name in self._channels

    def reading(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """What a sensor read last, and when in each world [s]."""
        channel = self._channels[name]
        return np.array(channel.reading), channel.time.copy()

    def steps_until_due(self, simulation: Simulation) -> float:
        """Steps, 1 or more, until a sample is due in any world that runs; infinite, if there is none."""
        if not self._channels:
            return inf
        steps = self._steps(simulation.time[~simulation.state.diverged])
        return float(min(channel.steps_until_due(steps).min(initial=inf) for channel in self._channels.values()))

    def update(self, simulation: Simulation, *, anew: bool = False) -> None:
        """Takes all samples that are due in worlds that run, and first ones in those that have begun anew; the others
        keep what was measured last. With `anew`, those that were taken now as well."""
        if not self._channels:
            return
        self._look_at_worlds(simulation)
        time, runs = simulation.time, ~simulation.state.diverged
        steps = self._steps(time)
        for channel in self._channels.values():
            due = np.flatnonzero(runs & channel.due(steps, time, anew))
            if due.size or channel.reading is None:
                channel.take(np.array(channel.sensor.measure(simulation)), due, time, steps, self._began)

    def _look_at_worlds(self, simulation: Simulation) -> None:
        """Forgets the samples of those that were set meanwhile."""
        begun = simulation._engine.begun()
        anew = np.zeros(len(begun), bool) if self._seen is None else begun != self._seen
        self._seen = begun
        self._began += anew
        for channel in self._channels.values():
            channel.forget(anew)

    def _steps(self, time: np.ndarray) -> np.ndarray:
        return np.round(time / self._dt)

    def save(self) -> Any:
        """What is carried along, beside a snapshot of the simulation."""
        channels = {name: channel.save() for name, channel in self._channels.items()}
        return deepcopy((channels, self._began))

    def restore(self, saved: Any) -> None:
        """Puts back what `save` gave."""
        channels, self._began = deepcopy(saved)
        self._seen = None
        for name, channel in self._channels.items():
            channel.restore(channels[name])
