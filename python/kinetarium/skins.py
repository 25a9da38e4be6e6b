"""What bodies look like on the page."""

from __future__ import annotations

from os import PathLike, fspath
from pathlib import Path

import numpy as np

from kinetarium import _engine
from kinetarium.errors import SkinError
from kinetarium.types import Vector


class Skin:
    """What a body looks like on the page; the physics does not know of it. Given to `View.dress`.

    It is one of:

    - a colour: (red, green, blue), or with the opacity (red, green, blue, opacity), sRGB, each from 0 to 1; or a text
      as "#4c8dd6" or "#4c8dd680";
    - "plain", the colours of the body's shapes, as they are at first; "replica", a colour for each world;
    - a colour that follows the body's state, with its scale in a corner of the page: "speed" [m/s], "spin" [rad/s],
      "force" (of its contacts) [N], "height" [m];
    - a path to a picture (PNG, JPEG, WebP), which is laid on the body's shapes, or to a model (GLB), which is drawn
      in their place: `fitted` to them, or as large as in the file. Files are 16 MB long at most.

    Whatever has a dot or a slash is a path. A file is read when the skin is made: who changes between some makes
    their skins once. Raises `SkinError` for a colour that is none, `UnknownNameError` for an unknown name,
    `FileError` for a file that is missing, too long, or of another kind, as its first bytes tell.

    >>> import kinetarium as kn
    >>> kn.Skin("#4c8dd6"), kn.Skin("speed")
    (Skin('#4c8dd6'), Skin('speed'))
    >>> kn.Skin("sped")
    Traceback (most recent call last):
    kinetarium.errors.UnknownNameError: there is no skin named "sped"; did you mean "speed"?
    """

    __slots__ = ("_skin", "_what")

    def __init__(self, what: Vector | str | PathLike[str], *, fitted: bool = True) -> None:
        self._what = what
        if isinstance(what, str) and what.startswith("#"):
            self._skin = _color(_digits(what), what)
        elif isinstance(what, PathLike) or (isinstance(what, str) and any(mark in what for mark in "./\\")):
            self._skin = _engine.Skin.file(Path(fspath(what)), fitted)
        elif isinstance(what, str):
            self._skin = _engine.Skin.named(what)
        else:
            self._skin = _color(what, what)

    @classmethod
    def of(cls, what: Skin | Vector | str | PathLike[str], *, fitted: bool = True) -> Skin:
        """A skin as it is, or one made of what is given."""
        return what if isinstance(what, Skin) else cls(what, fitted=fitted)

    def __repr__(self) -> str:
        return f"Skin({self._what!r})"


def _digits(text: str) -> list[float]:
    """The numbers of a colour as in HTML; none where it is none."""
    try:
        return [byte / 255 for byte in bytes.fromhex(text[1:])]
    except ValueError:
        return []


def _color(numbers: Vector, what: object) -> _engine.Skin:
    try:
        color = np.asarray(numbers, dtype=np.float64)
    except (TypeError, ValueError):
        color = np.empty(0)
    if color.shape not in ((3,), (4,)):
        raise SkinError(
            f'the skin {what!r} is none: give a colour, (red, green, blue) from 0 to 1 or "#4c8dd6", '
            "the name of a skin, or a path to a picture or a model"
        )
    red, green, blue, *opacity = color.tolist()
    return _engine.Skin.color(red, green, blue, opacity[0] if opacity else 1.0)
