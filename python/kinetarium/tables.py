"""Attributes that are arrays of all worlds: those of `State`, `Controls` and `Parameters`."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, overload

import numpy as np
from numpy.typing import ArrayLike

from kinetarium.arrays import Assign, NamedArray, checked
from kinetarium.errors import ClosedError
from kinetarium.names import Names, Strict

if TYPE_CHECKING:
    from kinetarium.worlds import Worlds


class Table:
    """An attribute of `Tables`: an array with a row for each world."""

    def __init__(self, names: str | None, numbers: tuple[int, ...], meaning: str) -> None:
        """For each of the model's `names`, such as its "body_names", it has numbers of this shape; for the world as a
        whole, where there are no names."""
        self._names, self._numbers = names, numbers
        self.__doc__ = meaning

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, tables: None, owner: type) -> Table: ...
    @overload
    def __get__(self, tables: Tables, owner: type) -> NamedArray: ...
    def __get__(self, tables: Tables | None, owner: type) -> Table | NamedArray:
        return self if tables is None else tables._get(self)

    def __set__(self, tables: Tables, value: ArrayLike) -> None:
        with tables._worlds.changing():
            tables._set(self, value)

    def names(self, worlds: Worlds) -> tuple[Names, ...]:
        """Names along its axes."""
        return () if self._names is None else (None, worlds.names(self._names))

    def shape(self, worlds: Worlds) -> tuple[int, ...]:
        """Its shape."""
        rows = () if self._names is None else (len(worlds.names(self._names) or ()),)
        return worlds.count, *rows, *self._numbers


def tables_of(kind: type[Tables]) -> dict[str, Table]:
    """All of a class, by name."""
    return {name: table for name, table in vars(kind).items() if isinstance(table, Table)}


class Tables(Strict):
    """What has such attributes."""

    __slots__ = ("__weakref__", "_worlds")

    def __init__(self, worlds: Worlds) -> None:
        self._worlds = worlds

    def _get(self, table: Table) -> NamedArray:
        """The array of an attribute."""
        raise NotImplementedError

    def _set(self, table: Table, value: ArrayLike) -> None:
        """Gives an attribute other numbers, in all worlds."""
        wanted = checked(table.name, value, table.shape(self._worlds))
        self._change(table, wanted, np.ones(wanted.shape, bool))

    def _change(self, table: Table, wanted: np.ndarray, chosen: np.ndarray) -> None:
        """Gives worlds those numbers that are chosen, or none of them where one is refused."""
        raise NotImplementedError

    def _check(self, table: Table, moment: int) -> None:
        """Raises where items of what was read at a moment cannot be set any more."""

    def _assign(self, table: Table) -> Assign:
        """What is asked when items of an attribute's array are set."""
        this, moment = weakref.ref(self), self._worlds.moment  # no array keeps worlds that are done with

        def assign(wanted: np.ndarray, chosen: np.ndarray) -> None:
            tables = this()
            if tables is None:
                raise ClosedError(f"the simulation of this {table.name} is gone: copy the array to change it alone")
            with tables._worlds.changing():
                tables._check(table, moment)
                tables._change(table, wanted, chosen)

        return assign
