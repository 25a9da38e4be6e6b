"""What the robots' options have to be."""

from __future__ import annotations

import numpy as np

from kinetarium.arrays import checked
from kinetarium.envs.task import Array

Range = tuple[float, float]


def number(name: str, value: float, least: float = -np.inf) -> float:
    """A finite number that is not too small; `ValueError` for what is none.

    >>> number("reset_noise_scale", -0.1, least=0)
    Traceback (most recent call last):
        ...
    ValueError: reset_noise_scale is -0.1: it must be finite, and 0 or more
    """
    found: float = checked(name, value, ()).item()
    if not (np.isfinite(found) and found >= least):
        bound = f", and {least:g} or more" if np.isfinite(least) else ""
        raise ValueError(f"{name} is {found:g}: it must be finite{bound}")
    return found


def flag(name: str, value: bool) -> bool:
    """True or false; `ValueError` for what is neither.

    >>> flag("terminate_when_unhealthy", "no")
    Traceback (most recent call last):
        ...
    ValueError: terminate_when_unhealthy is 'no': it must be True or False
    """
    if not isinstance(value, (bool, np.bool_)):
        raise ValueError(f"{name} is {value!r}: it must be True or False")
    return bool(value)


def ends(name: str, value: Range) -> Range:
    """The two ends of a range, infinite or not, in order; `ValueError` for what has none.

    >>> ends("healthy_z_range", 0.7)
    Traceback (most recent call last):
        ...
    ValueError: healthy_z_range is 0.7: give its two ends, the lower one first
    """
    try:
        low, high = (checked(name, end, ()).item() for end in value)
    except (TypeError, ValueError):
        low = high = np.nan
    if not low <= high:
        raise ValueError(f"{name} is {value!r}: give its two ends, the lower one first")
    return low, high


def within(x: Array, between: Range) -> Array:
    """Whether numbers are between two others, strictly."""
    return (between[0] < x) & (x < between[1])
