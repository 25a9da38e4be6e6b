"""Plots over time; needs matplotlib (`pip install ".[plot]"` in a checkout).

>>> import kinetarium as kn
>>> from kinetarium import plot
>>> sim = kn.Simulation(kn.examples.n_pendula(2))
>>> track = plot.record(sim, {"energy": lambda s: s.state.kinetic_energy + s.state.potential_energy}, seconds=0.2)
>>> track["energy"].shape
(101, 1)
>>> figure = plot.over_time(track, "energy")
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from kinetarium.errors import OutOfRangeError, ShapeError, SimulationError, UnknownNameError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kinetarium.simulation import Simulation

Track = dict[str, np.ndarray]
"""Quantities by name, each with a row for each sample; "time" [s] is one of them."""


def record(
    sim: Simulation,
    quantities: Mapping[str, Callable[[Simulation], ArrayLike] | None],
    *,
    seconds: float,
    every: int = 1,
) -> Track:
    """Steps a simulation for so many seconds and keeps quantities after each `every` steps, the start included.

    A quantity is a function of the simulation, or none for the one of that name in `Simulation.state`. Raises
    `SimulationError` for times and steps that cannot be, and for a quantity named "time", which the samples' is.
    """
    if "time" in quantities:
        raise SimulationError('a quantity is named "time", as the times of the samples are: give it another name')
    if not 0 <= seconds < inf:
        raise SimulationError(f"seconds is {seconds}: it must be 0 or more, and finite")
    if every < 1:
        raise SimulationError(f"every is {every}: it must be 1 or more steps")

    def sample() -> list[np.ndarray]:
        return [np.array(sim.state.read(name) if of is None else of(sim)) for name, of in quantities.items()]

    samples, times = [sample()], [sim.time[0]]
    for _ in range(round(seconds / (sim.dt * every))):
        sim.step(every)
        samples.append(sample())
        times.append(sim.time[0])
    track = {name: np.stack(values) for name, values in zip(quantities, zip(*samples, strict=True), strict=True)}
    return {"time": np.array(times), **track}


def over_time(
    track: Track,
    quantity: str,
    *,
    world: int = 0,
    names: Sequence[str] | None = None,
    unit: str = "",
) -> Figure:
    """Draws a quantity of one world over time, a line for each of its numbers; `names` label them.

    Raises `UnknownNameError`, `OutOfRangeError` for a world that was not recorded, and `ShapeError` where there are
    not as many names as lines.
    """
    from matplotlib.figure import Figure

    if quantity not in track:
        raise UnknownNameError(f'nothing named "{quantity}" was recorded; there are {", ".join(track)}')
    numbers = track[quantity]
    worlds = numbers.shape[1] if numbers.ndim > 1 else 0
    if not -worlds <= world < worlds:
        raise OutOfRangeError(f'there is no world {world} of "{quantity}": there are {worlds}, counted from 0')
    lines = numbers[:, world].reshape(len(numbers), -1)
    if names is not None and len(names) != lines.shape[1]:
        raise ShapeError(f'there are {len(names)} names for {lines.shape[1]} numbers of "{quantity}"')
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.subplots()
    for i, line in enumerate(lines.T):
        axes.plot(track["time"], line, label=names[i] if names is not None else None)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(f"{quantity} [{unit}]" if unit else quantity)
    axes.grid(alpha=0.3)
    if names is not None and len(names) <= 12:
        axes.legend()
    return figure
