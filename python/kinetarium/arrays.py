"""Arrays that names index: `sim.controls.force[:, "left_knee"] = 20.0`."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from ctypes import addressof, c_char
from typing import Any, SupportsIndex

import numpy as np

from kinetarium.errors import OutOfRangeError, ShapeError, SimulationError, UnknownNameError
from kinetarium.names import Names, rows

Assign = Callable[[np.ndarray, np.ndarray], None]
"""Takes an array as it shall be and a mask of the items that are set, both plain; raises where that cannot be."""


def aligned(shape: tuple[int, ...], dtype: np.dtype) -> np.ndarray:
    """An array on a boundary of 64 bytes, where jax takes memory without a copy; its numbers are not set."""
    memory = np.empty(math.prod(shape) * dtype.itemsize + 64, np.uint8)
    array: np.ndarray = np.ndarray(shape, dtype, memory, -addressof(c_char.from_buffer(memory.data)) % 64)
    return array


def _named(key: Any) -> bool:
    """Whether a part of an index holds names."""
    if isinstance(key, str):
        return True
    several = isinstance(key, (list, tuple)) or (isinstance(key, np.ndarray) and key.ndim == 1)
    return several and len(key) > 0 and all(isinstance(k, str) for k in key)


def _rows(key: Any, axis: int, names: Names) -> Any:
    """Numbers for a name, or for several."""
    if names is None:
        raise UnknownNameError(
            f"axis {axis} has no names: give numbers instead of {key!r}, or all indices at once, as what an index "
            "gives has no names"
        )
    if isinstance(key, str):
        return rows(key, axis, names)
    return np.concatenate([np.arange(len(names))[rows(name, axis, names)].ravel() for name in key]).tolist()


def _put(array: np.ndarray, key: Any, value: Any) -> None:
    """Sets items by numbers; `ShapeError` where the value does not fit them."""
    try:
        np.ndarray.__setitem__(array, key, value)
    except ValueError:
        checked("the value", value, np.shape(array[key]))  # which says what is wrong with it
        raise


class NamedArray(np.ndarray):
    """A numpy array whose axes may have names, usable in place of numbers in its index.

    A name picks a row as its number would; several names, in a list, a tuple or an array, pick several, and so does
    the name of a joint of several columns. What an index gives has no names, and lies in the same memory or in memory
    of its own, as numpy's rules for views and copies say. `copy` and `astype` keep names. The result of arithmetic is
    a plain `numpy.ndarray`.

    What is assigned must broadcast to the items; else `ShapeError` is raised. Indices out of range, and arithmetic
    with what does not fit, raise what numpy does.

    Those of `Simulation.state` and `parameters` are read-only but for items that are set: what would else be written
    to a part of one, or to the whole by a function such as `numpy.copyto`, would not reach the simulation, and numpy
    raises `ValueError`. Operators that work in place make new numbers of them instead, so that
    `state.joint_position[0] += 0.1` adds and then assigns. By DLPack others take a copy of them.

    >>> import numpy as np
    >>> from kinetarium.arrays import NamedArray
    >>> force = NamedArray.of(np.zeros((2, 3)), (None, ("hip", "knee", "ankle")))
    >>> force[:, "knee"] = 20.0
    >>> force[0, ["knee", "ankle"]]
    array([20.,  0.])
    """

    names: tuple[Names, ...] = ()
    """Names along the axes, as far as there are any."""
    held: np.ndarray | None = None
    """What is written to, of an array whose items are asked for."""
    _assign: Assign | None = None

    @classmethod
    def of(
        cls, array: np.ndarray, names: tuple[Names, ...], assign: Assign | None = None, *, writeable: bool = False
    ) -> NamedArray:
        """A view of `array` with names for each axis; with `assign`, setting items asks that, and it is read-only
        unless it is to be `writeable`."""
        named = array.view(cls)
        named.names = names
        if assign is not None:
            named.flags.writeable = writeable
            named.held, named._assign = array, assign
        return named

    def holds(self, names: tuple[Names, ...], assign: Assign) -> None:
        """Takes other names, and another to ask, when other numbers have been written to what is held."""
        self.names, self._assign = names, assign

    def _numbers(self, key: Any) -> Any:
        """The same index with numbers for names."""
        keys = key if isinstance(key, tuple) else (key,)
        if not any(_named(k) for k in keys):
            return key
        used = sum(k is not None and k is not Ellipsis for k in keys)
        axis, numbers = 0, []
        for k in keys:
            if k is Ellipsis:
                axis += self.ndim - used
            elif k is not None:
                if _named(k):
                    k = _rows(k, axis, self.names[axis] if axis < len(self.names) else None)
                axis += 1
            numbers.append(k)
        return tuple(numbers)

    def __getitem__(self, key: Any) -> Any:
        return super().__getitem__(self._numbers(key))

    def __setitem__(self, key: Any, value: Any) -> None:
        key = self._numbers(key)
        if self._assign is None or self.held is None:
            _put(self, key, value)
            return
        wanted, chosen = self.held.copy(), np.zeros(self.shape, bool)
        _put(wanted, key, value)
        chosen[key] = True
        self._assign(wanted, chosen)
        self.held[...] = wanted

    def __array_wrap__(self, array: np.ndarray, context: Any = None, return_scalar: bool = False) -> Any:
        if array is self:  # in place: `force += 1`
            return self
        plain = np.asarray(array)
        return plain if plain.ndim else plain[()]

    def __dlpack__(self, **options: Any) -> Any:
        numbers = self.view(np.ndarray)
        if not self.flags.writeable:  # which not all heed: torch writes to what it takes
            if options.get("copy") is False:
                raise BufferError("the array is read-only, and only a copy is given: take what `State.read` gives")
            numbers = aligned(self.shape, self.dtype)
            numbers[...] = self
        return numbers.__dlpack__(**options)

    def __reduce__(self) -> Any:
        return self.view(np.ndarray).__reduce__()

    def __repr__(self) -> str:
        return np.array_repr(self if self.names else self.view(np.ndarray))


def _in_place(operation: str) -> Callable[[np.ndarray, Any], Any]:
    work = getattr(np.ndarray, operation)

    def operate(array: np.ndarray, other: Any) -> Any:
        # What is not implemented in place is computed anew, and then assigned.
        return work(array, other) if array.flags.writeable else NotImplemented

    return operate


def _keeping_names(operation: str) -> Callable[..., Any]:
    work = getattr(np.ndarray, operation)

    def operate(array: NamedArray, *arguments: Any, **options: Any) -> Any:
        made = work(array, *arguments, **options)
        if isinstance(made, NamedArray) and made is not array:
            made.names = array.names
        return made

    return operate


for _name in [name for name in vars(np.ndarray) if name.startswith("__i") and f"__{name[3:]}" in vars(np.ndarray)]:
    setattr(NamedArray, _name, _in_place(_name))
for _name in "copy", "astype", "__copy__", "__deepcopy__":
    setattr(NamedArray, _name, _keeping_names(_name))


def numbers(what: str, array: Any) -> np.ndarray:
    """An array of real numbers; `ShapeError` where it is none."""
    try:
        found = np.asarray(array)
    except ValueError as error:
        raise ShapeError(f"{what} is no array: {error}") from None
    if found.dtype.kind not in "fiub":
        raise ShapeError(f"{what} is of dtype {found.dtype}: give real numbers")
    return found


def checked(what: str, array: Any, shape: tuple[int, ...], dtype: Any = np.float64) -> np.ndarray:
    """An array of numbers broadcast to a shape, C-contiguous; `ShapeError` where it cannot be.

    >>> checked("force", [1, 2], (3, 2)).shape
    (3, 2)
    >>> checked("force", [1, 2, 3], (3, 2))
    Traceback (most recent call last):
        ...
    kinetarium.errors.ShapeError: force has the shape (3,), which does not broadcast to (3, 2)
    """
    found = numbers(what, array)
    try:
        found = np.broadcast_to(found, shape)
    except ValueError:
        raise ShapeError(f"{what} has the shape {found.shape}, which does not broadcast to {shape}") from None
    return np.ascontiguousarray(found, dtype=dtype)


def is_vector(array: Any, count: int | None = None) -> bool:
    """Whether this is so many real numbers; one or any number of them, where it is not told how many.

    >>> is_vector((1, 2.5, 3), 3), is_vector((1, 2), 3), is_vector("abc"), is_vector(0.5)
    (True, False, False, True)
    """
    try:
        found = np.asarray(array)
    except ValueError:
        return False
    fits = found.ndim <= 1 if count is None else found.shape == (count,)
    return fits and found.dtype.kind in "fiub"


def whole(what: str, number: Any, least: int = 0, bits: int = 63) -> int:
    """A whole number that is not too small and has so many bits at most; `TypeError` where it is none,
    `SimulationError` where it is out of range.

    >>> whole("steps", -1)
    Traceback (most recent call last):
        ...
    kinetarium.errors.SimulationError: steps is -1: it must not be negative
    """
    try:
        found = operator.index(number)
    except TypeError:
        raise TypeError(f"{what} is {number!r}: it must be a whole number") from None
    if found < least:
        remedy = f"be at least {least}" if least > 0 else "not be negative"
        raise SimulationError(f"{what} is {found}: it must {remedy}")
    if found.bit_length() > bits:
        raise SimulationError(f"{what} is {found}: it must be below 2 to the power of {bits}")
    return found


def row(what: str, thing: str | SupportsIndex, named: Callable[[str], int], count: int) -> int:
    """The row of a thing of a model, such as a body, that is given by its name or its row; of `count` that there are.

    Raises `OutOfRangeError`, what `named` raises of names, and `TypeError`.

    >>> import kinetarium as kn
    >>> row("body", "link1", kn.examples.n_pendula(2).body, 2)
    1
    >>> row("body", 2, kn.examples.n_pendula(2).body, 2)
    Traceback (most recent call last):
        ...
    kinetarium.errors.OutOfRangeError: body 2 does not exist: the model has 2, counted from 0
    """
    if isinstance(thing, str):
        return named(thing)
    try:
        found = operator.index(thing)
    except TypeError:
        raise TypeError(f"the {what} is {thing!r}: give its name or its row") from None
    if not 0 <= found < count:
        raise OutOfRangeError(f"{what} {found} does not exist: the model has {count}, counted from 0")
    return found
