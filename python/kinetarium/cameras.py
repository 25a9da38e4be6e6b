"""Cameras: colours, depth, segmentation and normals as arrays, without a window."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import dist, hypot, inf, pi, tan
from operator import index

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kinetarium._engine import Model, View, looking, png
from kinetarium.arrays import is_vector
from kinetarium.errors import RenderError
from kinetarium.types import Vector

_WHOLE = {"width": (1, 16384), "height": (1, 16384), "samples": (1, 64), "occlusion": (0, 64)}
_VECTORS = {"focal": 2, "principal": 2, "position": 3, "orientation": 4}


@dataclass(frozen=True)
class Lamp:
    """A lamp, for `Light.lamps`. Raises `RenderError` for what cannot be.

    >>> import kinetarium as kn
    >>> torch = kn.Lamp("spot", position=(0, 2, 0), direction=(0, -1, 0), cutoff=0.5, body="link1")
    """

    kind: str = "point"
    """"point": it shines in all directions; "spot": about its direction; "parallel": everywhere in its direction."""
    position: Vector = (0.0, 0.0, 0.0)
    """In the frame of its body, or in the world [m]; of one that tracks, from its body's origin along world axes."""
    direction: Vector = (0.0, -1.0, 0.0)
    """Where it shines, along the same axes; of any length but zero."""
    color: Vector = (1.0, 1.0, 1.0)
    """What it adds to a white sheet that faces it, before it fades, in linear light."""
    attenuation: Vector = (1.0, 0.0, 0.0)
    """a, b [1/m] and c [1/m²] by which light of points and spots fades with the distance d, as
    1 / (a + b d + c d²)."""
    cutoff: float = pi / 4
    """Largest angle of a spot's light to its direction [rad], above 0 and at most π/2."""
    exponent: float = 0.0
    """The exponent e by which a spot's light fades with the angle, as cosᵉ; 0 to 128."""
    body: str | None = None
    """Name of the body that it is on; none is the world."""
    mode: str = "fixed"
    """"fixed": it moves and turns with its body. "track": it moves with its body's origin and does not turn."""
    shadows: bool = True
    """Whether what is behind something else, as it sees it, is in its shadow."""

    def __post_init__(self) -> None:
        for what in ("position", "direction", "color", "attenuation"):
            numbers = getattr(self, what)
            if not is_vector(numbers, 3):
                raise RenderError(f"the lamp's {what} is {numbers!r}: give 3 numbers")
        if not 0 < hypot(*self.direction) < inf:
            raise RenderError(f"the lamp's direction is {self.direction}: give one, as (0, 0, -1)")


@dataclass(frozen=True)
class Light:
    """A sun, a sky and lamps, for `Camera.light`; what is `None` is as the model has it, which is a sunny day where
    its file names no lights. Colours are red, green and blue in linear light, not sRGB: 1 is as bright as a white
    sheet can be drawn.

    >>> import kinetarium as kn
    >>> evening = kn.Light(to_sun=(-1, 0.3, 0), sun=(0.8, 0.5, 0.2))
    >>> noon = kn.Light(to_sun=(0, 1, 0), shadows=False)
    >>> night = kn.Light(sun=(0, 0, 0), lamps=[kn.Lamp(position=(0, 3, 0), attenuation=(0, 0, 0.2))])
    """

    to_sun: Vector | None = None
    """Direction to the sun, world axes; of any length but zero."""
    sun: Vector | None = None
    """What the sun adds to a white sheet that faces it; zeros are no sun."""
    shadows: bool | None = None
    """Whether what is behind something else, as the sun sees it, is in its shadow."""
    sun_radius: float | None = None
    """Angle [rad] from the middle of the sun to its edge, which makes the edges of shadows soft where there are
    several samples a pixel; 0 to ½."""
    sky: Vector | None = None
    """What the sky adds to a white sheet that faces up."""
    ground: Vector | None = None
    """What the ground adds to a white sheet that faces down."""
    zenith: Vector | None = None
    """Colour straight above, where nothing is."""
    horizon: Vector | None = None
    """Colour of the horizon, and where endless planes end."""
    lamps: Sequence[Lamp] | None = None
    """Other lights, in place of the model's."""

    def __post_init__(self) -> None:
        for what in ("to_sun", "sun", "sky", "ground", "zenith", "horizon"):
            numbers = getattr(self, what)
            if numbers is not None and not is_vector(numbers, 3):
                raise RenderError(f"the light's {what} is {numbers!r}: give 3 numbers")
        if self.lamps is not None and not all(isinstance(lamp, Lamp) for lamp in self.lamps):
            raise RenderError(f"the light's lamps are {self.lamps!r}: give Lamps, as [Lamp(position=(0, 3, 0))]")


@dataclass(frozen=True)
class Camera:
    """A pinhole camera, free or on a body. It looks along −z of its frame, y is up in the image. Raises `RenderError`
    for what cannot be.

    >>> import kinetarium as kn
    >>> sim = kn.Simulation(kn.examples.n_pendula(3), worlds=2)
    >>> camera = kn.Camera(64, 48, channels=("rgb", "depth")).looking(eye=(0, -1, 4), target=(0, -1, 0))
    >>> images = sim.render(camera)
    >>> images.rgb.shape, images.depth.shape
    ((2, 48, 64, 3), (2, 48, 64))
    """

    width: int = 640
    """Pixels of a row, 1 to 16384."""
    height: int = 480
    """Rows, 1 to 16384."""
    field_of_view: float = pi / 4
    """Angle from the upper to the lower edge [rad], above 0 and below π."""
    focal: Vector | None = None
    """Focal lengths fx, fy [pixel], in place of the field of view."""
    principal: Vector | None = None
    """Where the optical axis meets the image, cx, cy [pixel], with `focal`; its middle by default."""
    near: float = 0.01
    """Depth [m] from which on things are seen."""
    far: float = inf
    """Depth [m] up to which things are seen."""
    body: str | None = None
    """Name of the body that it is on; none is the world."""
    mode: str = "fixed"
    """"fixed": it moves and turns with its body. "track": it moves with its body's origin and does not turn."""
    position: Vector = (0.0, 0.0, 0.0)
    """In the frame of its body, or in the world [m]; of one that tracks, from its body's origin along world axes."""
    orientation: Vector = (0.0, 0.0, 0.0, 1.0)
    """In the frame of its body, or in the world, x, y, z, w; of one that tracks, in world axes."""
    channels: Sequence[str] = field(default=("rgb",))
    """Which images are made: "rgb", "depth", "body", "shape", "normal"."""
    samples: int = 1
    """Samples along each edge of a pixel for its colour, 1 to 64."""
    occlusion: int = 0
    """Rays that tell how much of the sky each sample sees, 0 to 64."""
    light: Light | None = None
    """What lights the scene; as the model has it by default."""
    checker: float | None = None
    """Edge of the squares of the checker pattern on planes [m], 0 for none; as suits the model's size by default."""

    def __post_init__(self) -> None:
        for what, (least, most) in _WHOLE.items():
            number = getattr(self, what)
            try:
                inside = least <= index(number) <= most
            except TypeError:
                raise TypeError(f"the camera's {what} is {number!r}: it must be a whole number") from None
            if not inside:
                raise RenderError(f"the camera's {what} is {number}: it must be from {least} to {most}")
        for what, count in _VECTORS.items():
            numbers = getattr(self, what)
            optional = what in ("focal", "principal")
            if not (optional and numbers is None) and not is_vector(numbers, count):
                raise RenderError(f"the camera's {what} is {numbers!r}: give {count} numbers")
        if self.principal is not None and self.focal is None:
            raise RenderError(f"the camera's principal point is {self.principal}, without focal: give both, or none")
        if isinstance(self.channels, str) or len(self.channels) == 0:
            raise RenderError(f'the camera\'s channels are {self.channels!r}: give one or more, as ("rgb", "depth")')
        if not (self.light is None or isinstance(self.light, Light)):
            raise RenderError(f"the camera's light is {self.light!r}: give a Light, as Light(to_sun=(1, 1, 0))")

    def looking(self, eye: Vector, target: Vector, up: Vector = (0.0, 1.0, 0.0)) -> Camera:
        """The same at `eye` [m], with `target` [m] in the middle of its image and `up` upwards in it, in its body's
        frame or in the world; where the world's z is up, as in files, that is (0, 0, 1). Raises `RenderError` where
        both are the same point, or something is not 3 numbers."""
        for what, point in (("eye", eye), ("target", target), ("up", up)):
            if not is_vector(point, 3):
                raise RenderError(f"the camera's {what} is {point!r}: give 3 numbers")
        if not 0 < dist(eye, target) < inf:
            raise RenderError(
                f"the camera's eye is {eye} and its target is {target}: give two points, some way apart"
            )
        if not 0 < hypot(*up) < inf:
            raise RenderError(f"the camera's up is {up}: give a direction, as (0, 0, 1)")
        x, y, z, w = looking(eye, target, up)
        return replace(self, position=eye, orientation=(x, y, z, w))

    @classmethod
    def of(cls, model: Model, name: str) -> Camera:
        """A camera that the model's file names, of the size that it has there, or of 640 × 480. With another size, or
        other channels: `dataclasses.replace`. Raises `UnknownNameError`."""
        return cls(**model.camera(name))

    @property
    def intrinsics(self) -> NDArray[np.float64]:
        """The calibration K [pixel], a 3 × 3 matrix. What is x to the right, y downwards and d ahead [m] is seen at
        u, v = (K @ (x, y, d))[:2] / d, counted from the upper left corner of the image: the middle of the first pixel
        is at (½, ½), where it is (0, 0) in OpenCV, whose cx and cy are less by ½.

        >>> import kinetarium as kn
        >>> kn.Camera(64, 48, focal=(50, 60)).intrinsics
        array([[50.,  0., 32.],
               [ 0., 60., 24.],
               [ 0.,  0.,  1.]])
        """
        square = 0.5 * self.height / tan(0.5 * self.field_of_view)
        fx, fy = (square, square) if self.focal is None else self.focal
        cx, cy = (0.5 * self.width, 0.5 * self.height) if self.principal is None else self.principal
        return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]], float)

    def _view(self, model: Model) -> View:
        return View(
            model,
            width=self.width,
            height=self.height,
            field_of_view=self.field_of_view,
            focal=self.focal,
            principal=self.principal,
            near=self.near,
            far=self.far,
            body=self.body,
            mode=self.mode,
            position=self.position,
            orientation=self.orientation,
            channels=list(self.channels),
            samples=self.samples,
            occlusion=self.occlusion,
            light=self.light,
            checker=self.checker,
        )


@dataclass(frozen=True, eq=False)
class Images:
    """One image of each world and channel, row by row from the upper left corner; channels that were not asked for
    are `None`. Notebooks show the colours of the first world."""

    rgb: np.ndarray | None = None
    """Red, green, blue in sRGB, uint8 of shape (worlds, height, width, 3)."""
    depth: np.ndarray | None = None
    """Depth along the optical axis [m], float32 of shape (worlds, height, width); infinite where nothing is seen."""
    body: np.ndarray | None = None
    """Rows of bodies, int32 of shape (worlds, height, width); −1 for the world's shapes and where nothing is seen."""
    shape: np.ndarray | None = None
    """Rows of shapes, int32 of shape (worlds, height, width); −1 where nothing is seen."""
    normal: np.ndarray | None = None
    """Unit vectors out of the surfaces, world axes, float32 of shape (worlds, height, width, 3)."""
    time: ArrayLike | None = None
    """Time of each world's image [s], where a sensor made it."""

    def _repr_png_(self) -> bytes | None:
        return None if self.rgb is None or len(self.rgb) == 0 else png(np.ascontiguousarray(self.rgb[0]))
