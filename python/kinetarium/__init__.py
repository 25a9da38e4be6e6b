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
    ShapeHandle,
    Softness,
    __version__,
    load,
    parse,
)
from kinetarium.arrays import NamedArray
from kinetarium.cameras import Camera, Images, Lamp, Light
from kinetarium.dynamics import Bodies, Dynamics
from kinetarium.errors import KinetariumError
from kinetarium.queries import NearShapes, Seen, ShapeHits
from kinetarium.simulation import Contacts, Event, Linearization, RayHits, Simulation
from kinetarium.skins import Skin
from kinetarium.view import View

if TYPE_CHECKING:
    from kinetarium import envs as envs
    from kinetarium import plot as plot
    from kinetarium import types as types

__all__ = [
    "Axis",
    "Bodies",
    "Body",
    "Builder",
    "Camera",
    "Contacts",
    "Dof",
    "Drive",
    "Dynamics",
    "Event",
    "Geometry",
    "Images",
    "Joint",
    "KinetariumError",
    "Lamp",
    "Light",
    "Limit",
    "Linearization",
    "Material",
    "Model",
    "NamedArray",
    "NearShapes",
    "Object",
    "RayHits",
    "Replica",
    "Seen",
    "Shape",
    "ShapeHandle",
    "ShapeHits",
    "Simulation",
    "Skin",
    "Softness",
    "View",
    "__version__",
    "errors",
    "examples",
    "load",
    "parse",
    "sensors",
]

# Imported when they are asked for, and what must be installed for them.
_LATER = {"envs": "gymnasium", "plot": None, "types": None}


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    needed = _LATER[name]
    try:
        return import_module(f"{__name__}.{name}")
    except ModuleNotFoundError as error:
        if needed is None or (error.name or "").partition(".")[0] != needed:
            raise
        raise AttributeError(f"{__name__}.{name} needs {needed}: `pip install {needed}`") from error


def __dir__() -> list[str]:
    from importlib.util import find_spec

    return sorted({*globals(), *(name for name, needed in _LATER.items() if needed is None or find_spec(needed))})
