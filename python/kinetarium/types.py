"""Types of arguments."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, TypedDict

from numpy.typing import NDArray

if TYPE_CHECKING:
    from kinetarium._engine import Body, Drive, Limit

Vector = Sequence[float] | NDArray[Any]
"""So many numbers: three of a point, four of a quaternion x, y, z, w."""
Frame = tuple[Vector, Vector]
"""Position [m] and quaternion x, y, z, w."""
Place = tuple[str | None, Vector, Vector]
"""Name of a body, or none for the world; position [m] and quaternion x, y, z, w in its frame."""
Meshes = Literal["named", "exact", "hull"]
"""What becomes of meshes that collide."""


class JointOptions(TypedDict, total=False):
    """What every joint may be given.

    `position` and `orientation` place its frame in the object; or else `parent_frame` and `child_frame`, each a
    position and a quaternion, in both bodies. Without `parent`, the parent is the world. What acts along its degrees
    of freedom, in N/m, N·s/m, kg, N or N·m/rad, N·m·s/rad, kg·m², N·m: `limit`, `drive`, `damping`, `stiffness` of a
    spring that rests at `rest`, `armature`, `friction_loss`. `initial` are its coordinates at the start.
    `linear_compliance` [m/N] and `angular_compliance` [rad/(N·m)] let the locked directions give (`xpbd`).
    """

    parent: Body | None
    position: Vector
    orientation: Vector
    parent_frame: Frame
    child_frame: Frame
    initial: float | Vector
    limit: Limit
    drive: Drive
    damping: float
    stiffness: float
    rest: float
    armature: float
    friction_loss: float
    linear_compliance: float
    angular_compliance: float
    closes_loop: bool
    bodies_collide: bool
    enabled: bool
