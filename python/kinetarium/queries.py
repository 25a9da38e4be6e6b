"""What is asked about shapes, and what is answered."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kinetarium._engine import Model
from kinetarium.arrays import checked, row
from kinetarium.errors import ShapeError, SimulationError

FIRST = np.intp(0)
"""The world that is asked about where none is given: by its identity, another than a 0 that is given."""


def asked(world: int | None, worlds: ArrayLike | None) -> ArrayLike | None:
    """The worlds that are asked about: one, or several; `SimulationError` where both are given.

    >>> asked(2, FIRST), asked(None, [0, 1])
    (2, [0, 1])
    >>> asked(2, [0, 1])
    Traceback (most recent call last):
        ...
    kinetarium.errors.SimulationError: both world=2 and worlds=[0, 1] are given: leave one out
    """
    if world is None:
        return worlds
    if worlds is not FIRST:
        raise SimulationError(f"both world={world!r} and worlds={worlds!r} are given: leave one out")
    return world


@dataclass(frozen=True)
class Seen:
    """Which shapes a query sees: by default all but sensors, also those that take part in no contacts.

    >>> import kinetarium as kn
    >>> sim = kn.Simulation(kn.examples.n_pendula(3))
    >>> near = sim.nearest((0, 0, 0), seen=kn.Seen(except_bodies=["link0", "link1"]))
    >>> near.body == sim.body("link2")
    array([[ True]])
    """

    membership: int | None = None
    """Those of one of these kinds only, a bit each, as `Shape.membership`; of any where `None`."""
    colliding: bool = False
    """Those that take part in contacts only."""
    sensors: bool = False
    """Sensors, too."""
    except_bodies: Sequence[str | int] = ()
    """None of these bodies, names or rows."""

    def _of(self, model: Model) -> tuple[bool, bool, int | None, list[int]]:
        """As the engine takes it."""
        if isinstance(self.except_bodies, str):
            raise TypeError(f"except_bodies is {self.except_bodies!r}: give a list, as [{self.except_bodies!r}]")
        count = len(model.body_names)
        bodies = [row("body", body, model.body, count) for body in self.except_bodies]
        return self.colliding, self.sensors, self.membership, bodies


def sight(seen: Seen | None, model: Model) -> tuple[bool, bool, int | None, list[int]]:
    """What a query sees, as the engine takes it; what it sees by default, if nothing is given."""
    if not isinstance(seen, Seen | None):
        raise TypeError(f"seen is {seen!r}: give a Seen, as Seen(colliding=True)")
    return (seen or Seen())._of(model)


@dataclass(frozen=True, eq=False)
class ShapeHits:
    """The shapes that queries found, as many as were asked for; (…) is the shape of what was asked."""

    distance: np.ndarray
    """How far [m], infinite where nothing was found, shape (…)."""
    shape: np.ndarray
    """Rows of the shapes, −1 where nothing was found, int64, shape (…)."""
    body: np.ndarray
    """Rows of their bodies, −1 for the world's and where nothing was found, int64, shape (…)."""
    position: np.ndarray
    """Points of their surfaces [m], world axes, NaN where nothing was found, shape (…, 3)."""
    normal: np.ndarray
    """Unit vectors out of the surfaces there, world axes, NaN where nothing was found, shape (…, 3)."""


@dataclass(frozen=True, eq=False)
class NearShapes:
    """The shapes that queries found, a row for each, in the order of the queries."""

    world: np.ndarray
    """In which world, int64, shape (found,)."""
    query: np.ndarray
    """By which query of that world, int64, shape (found,)."""
    distance: np.ndarray
    """How far [m], shape (found,)."""
    shape: np.ndarray
    """Rows of the shapes, int64, shape (found,)."""
    body: np.ndarray
    """Rows of their bodies, −1 for the world's, int64, shape (found,)."""
    position: np.ndarray
    """Points of their surfaces [m], world axes, shape (found, 3)."""
    normal: np.ndarray
    """Unit vectors out of the surfaces there, world axes, shape (found, 3)."""

    def __len__(self) -> int:
        return len(self.distance)


@dataclass(frozen=True, eq=False)
class Queries:
    """Queries of one world or of several, in rows."""

    lead: tuple[int, ...]
    """(queries,), or (worlds, queries)."""
    arrays: list[np.ndarray]
    """What is asked, a row for each query of each world."""

    @classmethod
    def of(cls, rows: np.ndarray, worlds: ArrayLike | None, **asked: tuple[ArrayLike, int]) -> Queries:
        """Of arrays with so many numbers a query; worlds as they were given, and as rows."""
        shapes = [np.shape(array) for array, _ in asked.values()]
        several = worlds is None or np.ndim(worlds) > 0
        least = (len(rows), 1) if several else (1,)
        names, form = " and ".join(asked), "(worlds, queries, …)" if several else "(queries, …)"
        try:
            lead = np.broadcast_shapes(*(shape[:-1] for shape in shapes), least)
        except ValueError:
            given = " and ".join(map(str, shapes))
            raise ShapeError(f"{names} of the shapes {given} do not broadcast to {form}") from None
        if len(lead) != len(least) or (several and lead[0] != len(rows)):
            raise ShapeError(f"{names} have the shape {lead} together, before the last axis: it must be {form}")
        arrays = [checked(name, array, (*lead, width)).reshape(-1, width) for name, (array, width) in asked.items()]
        return cls(lead, arrays)

    def shaped(self, found: dict[str, Any], *each: int) -> dict[str, Any]:
        """Answers in the shape of the queries, each of which may have several."""
        lead = self.lead + each
        return {name: array.reshape(lead + array.shape[1:]) for name, array in found.items()}

    def hits(self, found: dict[str, Any], *each: int) -> ShapeHits:
        """The same as an object."""
        return ShapeHits(**self.shaped(found, *each))

    def near(self, found: dict[str, Any], rows: np.ndarray) -> NearShapes:
        """Answers in rows, with the worlds and the queries that they are of."""
        world, query = np.divmod(found.pop("query"), self.lead[-1] or 1)
        return NearShapes(world=rows[world], query=query, **found)
