"""Names: of rows and attributes, and what was meant by one that nothing has."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from kinetarium.errors import UnknownNameError

Names = Sequence[str] | None
"""Names along an axis, or none."""


def hint(name: str, known: Sequence[str]) -> str:
    """What to do about a name that is not known: the one that was meant, if one is alike, or what there is.

    >>> hint("hinge_1", ["hinge0", "hinge1"])
    'did you mean "hinge1"?'
    >>> hint("knee", ["hinge0", "hinge1"])
    'known are hinge0, hinge1'
    """
    from difflib import get_close_matches  # seldom needed, and slow to import

    alike = get_close_matches(str(name), known, n=1)
    some = ", ".join(known[:20]) + (", …" if len(known) > 20 else "")
    return f'did you mean "{alike[0]}"?' if alike else f"known are {some or 'none'}"


class JointNames(tuple[str, ...]):
    """Names of columns that belong to joints, a name each; a joint's own name stands for all its columns."""

    joints: Sequence[str]
    columns: Callable[[str], tuple[int, int]]

    @classmethod
    def of(cls, names: Iterable[str], joints: Sequence[str], columns: Callable[[str], tuple[int, int]]) -> JointNames:
        """Names of the columns, names of the joints, and what tells the columns of a joint."""
        made = cls(names)
        made.joints, made.columns = joints, columns
        return made


def rows(name: str, axis: int, names: Sequence[str]) -> int | slice:
    """The row of a name, or the rows of a joint; `UnknownNameError` where there are none."""
    if name in names:
        return names.index(name)
    known = list(names)
    if isinstance(names, JointNames):
        if name in names.joints:
            start, end = names.columns(name)
            if start < end:
                return slice(start, end)
        known += [joint for joint in names.joints if joint not in names]
    raise UnknownNameError(f'axis {axis} has nothing named "{name}"; {hint(name, known)}')


class Strict:
    """Attributes that do not exist cannot be set, so that none is set in vain where its name is misspelt.

    Those who derive from it name their own in `__slots__`.
    """

    __slots__ = ()

    if not TYPE_CHECKING:  # which would take it for leave to set any

        def __setattr__(self, name: str, value: Any) -> None:
            try:
                super().__setattr__(name, value)
            except AttributeError:
                kind = type(self)
                if hasattr(kind, name):
                    raise
                known = [n for n in dir(kind) if not n.startswith("_") and not callable(getattr(kind, n))]
                message = f'{kind.__name__} has no attribute "{name}"; {hint(name, known)}'
                raise AttributeError(message) from None
