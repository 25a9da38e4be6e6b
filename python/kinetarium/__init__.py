"""Kinetarium: a physics engine for actions, with thousands of worlds side by side.

>>> import kinetarium as kn
>>> model = kn.examples.n_pendula(3)  # or kn.load("robot.xml"), or kn.Builder(...)
>>> sim = kn.Simulation(model, worlds=64, dt=0.002)
>>> sim.controls.force[:, sim.dof("hinge0")] = 0.2
>>> worlds_lost = sim.step(100)
>>> sim.state.body_position[:, "link2"].shape
(64, 3)

SI units; angles in radians; right-handed; quaternions x, y, z, w; sizes of shapes are half sizes.
"""

from typing import TYPE_CHECKING, Any

from kinetarium import errors, examples, sensors
from kinetarium._engine import (
    Axis,
    Body,
    Builder,
    Dof,
    Drive,
    Geometry,
    Joint,
    Limit,
    Material,
    Model,
    Object,
    Replica,
    Shape,
    Softness,
    __version__,
    load,
    parse,
)
from kinetarium.arrays import NamedArray
from kinetarium.cameras import Camera, Images
from kinetarium.errors import KinetariumError
from kinetarium.simulation import Contacts, Event, Linearization, RayHits, Simulation
from kinetarium.view import View

if TYPE_CHECKING:
    from kinetarium import envs as envs
    from kinetarium import plot as plot
    from kinetarium import types as types

__all__ = [
    "Axis",
    "Body",
    "Builder",
    "Camera",
    "Contacts",
    "Dof",
    "Drive",
    "Event",
    "Geometry",
    "Images",
    "Joint",
    "KinetariumError",
    "Limit",
    "Linearization",
    "Material",
    "Model",
    "NamedArray",
    "Object",
    "RayHits",
    "Replica",
    "Shape",
    "Simulation",
    "Softness",
    "View",
    "__version__",
    "errors",
    "examples",
    "load",
    "parse",
    "sensors",
]

# Imported when they are asked for: the first needs gymnasium, the second matplotlib.
_LATER = ("envs", "plot", "types")


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return import_module(f"{__name__}.{name}")


def __dir__() -> list[str]:
    return sorted({*globals(), *_LATER})
