"""Arrays that names index: `sim.controls.force[:, "left_knee"] = 20.0`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from kinetarium.errors import ShapeError, UnknownNameError

Names = Sequence[str] | None
"""Names along an axis, or none."""


def _row(name: str, axis: int, names: Sequence[str]) -> int:
    try:
        return names.index(name)
    except ValueError:
        from difflib import get_close_matches  # seldom needed, and slow to import

        alike = get_close_matches(name, names, n=1)
        some = ", ".join(names[:8]) + (", …" if len(names) > 8 else "")
        hint = f'did you mean "{alike[0]}"?' if alike else f"there are {some or 'none'}"
        raise UnknownNameError(f'axis {axis} has nothing named "{name}"; {hint}') from None


def _named(key: Any) -> bool:
    """Whether a part of an index holds names."""
    return isinstance(key, str) or (isinstance(key, list) and len(key) > 0 and all(isinstance(k, str) for k in key))


class NamedArray(np.ndarray):
    """A numpy array whose axes may have names, usable in place of numbers in its index.

    A name picks a row as its number would; a list of names picks several. What an index gives is a plain
    `numpy.ndarray` on the same memory, as numpy's rules for views and copies say. So is the result of
    arithmetic.

    >>> import numpy as np
    >>> from kinetarium.arrays import NamedArray
    >>> force = NamedArray.of(np.zeros((2, 3)), (None, ("hip", "knee", "ankle")))
    >>> force[:, "knee"] = 20.0
    >>> force[0, ["knee", "ankle"]]
    array([20.,  0.])
    """

    names: tuple[Names, ...]
    _assign: Callable[[np.ndarray], None] | None

    @classmethod
    def of(
        cls,
        array: np.ndarray,
        names: tuple[Names, ...],
        assign: Callable[[np.ndarray], None] | None = None,
    ) -> NamedArray:
        """A view of `array` with names for each axis; `assign` is told of the array after its items are set."""
        named = array.view(cls)
        named.names = names
        named._assign = assign
        return named

    def __array_finalize__(self, source: np.ndarray | None) -> None:
        self.names = ()
        self._assign = None

    def __array_wrap__(self, array, context=None, return_scalar=False):
        if array is self:  # in place: `force += 1`
            return self
        plain = np.asarray(array)
        return plain[()] if return_scalar else plain

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
                    names = self.names[axis] if axis < len(self.names) else None
                    if names is None:
                        raise UnknownNameError(f"axis {axis} has no names: give numbers instead of {k!r}")
                    k = _row(k, axis, names) if isinstance(k, str) else [_row(n, axis, names) for n in k]
                axis += 1
            numbers.append(k)
        return tuple(numbers)

    def __getitem__(self, key: Any) -> Any:
        return self.view(np.ndarray)[self._numbers(key)]

    def __setitem__(self, key: Any, value: Any) -> None:
        self.view(np.ndarray)[self._numbers(key)] = value
        if self._assign is not None:
            self._assign(self.view(np.ndarray))

    def __reduce__(self) -> Any:
        return self.view(np.ndarray).__reduce__()


def checked(what: str, array: Any, shape: tuple[int, ...], dtype: Any = np.float64) -> np.ndarray:
    """An array of numbers broadcast to a shape, C-contiguous; `ShapeError` where it cannot be.

    >>> checked("force", [1, 2], (3, 2)).shape
    (3, 2)
    >>> checked("force", [1, 2, 3], (3, 2))
    Traceback (most recent call last):
        ...
    kinetarium.errors.ShapeError: force has the shape (3,), which does not broadcast to (3, 2)
    """
    try:
        numbers = np.asarray(array)
    except ValueError as error:
        raise ShapeError(f"{what} is no array: {error}") from None
    if numbers.dtype.kind not in "fiub":
        raise ShapeError(f"{what} is of dtype {numbers.dtype}: give real numbers")
    try:
        numbers = np.broadcast_to(numbers, shape)
    except ValueError:
        raise ShapeError(f"{what} has the shape {numbers.shape}, which does not broadcast to {shape}") from None
    return np.ascontiguousarray(numbers, dtype=dtype)
