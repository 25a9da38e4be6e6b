"""What a simulation shares with its tables."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock, get_ident

import numpy as np
from numpy.typing import ArrayLike

from kinetarium._engine import Engine, Model
from kinetarium.errors import BusyError, ClosedError, ForkedError, OutOfRangeError, ShapeError
from kinetarium.names import JointNames, Names

_forks = 0  # how many lie between the first process and this one


def _count_fork() -> None:
    global _forks
    _forks += 1


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_count_fork)


class Worlds:
    """The engine of a simulation, and of what sizes and names its arrays are.

    `State`, `Controls` and `Parameters` hold this rather than the simulation: nothing goes round in a circle, and a
    simulation is freed with the last reference to it.
    """

    __slots__ = (
        "__weakref__",
        "_changer",
        "_engine",
        "_forks",
        "_names",
        "_turn",
        "closed",
        "count",
        "dtype",
        "model",
        "moment",
    )

    def __init__(self, engine: Engine, model: Model, count: int, dtype: np.dtype) -> None:
        self._engine = engine
        self._forks = _forks
        self._names: dict[str, Names] = {}
        self._turn = Lock()
        self._changer: int | None = None  # the thread whose turn it is
        self.model = model
        self.count = count
        self.dtype = dtype
        self.closed = False
        self.moment = 0
        """Counts what brings the worlds into another state: steps, resets."""

    @property
    def forked(self) -> bool:
        """Whether this process was forked from the one that made the worlds."""
        return self._forks != _forks

    @property
    def engine(self) -> Engine:
        """What computes. Raises `ClosedError`, and `ForkedError` in a process without its threads."""
        if self.closed:
            raise ClosedError("the simulation is closed: make it anew")
        if self.forked:
            raise ForkedError(
                "the simulation was made before this process was forked, and its threads stayed behind: make it anew "
                'here, or start processes by multiprocessing\'s "spawn", which hands on a copy'
            )
        return self._engine

    def rows(self, worlds: ArrayLike | None) -> np.ndarray:
        """Worlds as numbers: all, or those of a mask, or those of a list. Raises `ShapeError`, `OutOfRangeError`."""
        if worlds is None:
            return np.arange(self.count)
        refused = ShapeError("worlds must be a mask or a list of whole numbers")
        try:
            rows = np.atleast_1d(np.asarray(worlds))
        except ValueError:
            raise refused from None
        if rows.dtype == bool:
            if rows.shape != (self.count,):
                raise ShapeError(f"the mask of worlds has the shape {rows.shape}: it must be ({self.count},)")
            return np.flatnonzero(rows)
        if rows.size == 0:
            return np.empty(0, np.int64)
        if rows.dtype.kind not in "iu" or rows.ndim != 1:
            raise refused
        wrong = rows[(rows < 0) | (rows >= self.count)]
        if wrong.size:
            raise OutOfRangeError(f"world {wrong[0]} does not exist: there are {self.count}, counted from 0")
        return np.ascontiguousarray(rows, dtype=np.int64)

    @property
    def is_changing(self) -> bool:
        """Whether a call brings the worlds into another state just now."""
        return self._turn.locked()

    @contextmanager
    def changing(self) -> Iterator[Engine]:
        """The engine, to bring worlds into another state by: one call at a time, from the first to the last that it
        does, and none by a sensor that measures meanwhile. Raises `BusyError`."""
        engine = self.engine
        if not self._turn.acquire(blocking=False):
            if self._changer == get_ident():
                raise BusyError("a `Custom` sensor changes the simulation that it measures: it may only read it")
            raise BusyError(
                "another thread is using this simulation: one call at a time, or a simulation for each thread"
            )
        self._changer = get_ident()
        try:
            yield engine
        finally:
            self._changer = None
            self._turn.release()

    def close(self) -> None:
        """Frees the worlds."""
        self._engine.close()
        self.closed = True

    def names(self, table: str) -> Names:
        """The names of one of the model's tables, such as "dof_names"."""
        if table not in self._names:
            self._names[table] = self._read_names(table)
        return self._names[table]

    def _read_names(self, table: str) -> Names:
        names, model = tuple(getattr(self.model, table)), self.model
        if table == "dof_names":
            return JointNames.of(names, model.joint_names, model.joint_dofs)
        if table == "coordinate_names":
            return JointNames.of(names, model.joint_names, model.joint_coordinates)
        return names
