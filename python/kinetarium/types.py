"""Types of arguments."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, TypedDict

from numpy.typing import NDArray

if TYPE_CHECKING:
    from kinetarium._engine import Body, Dof, Drive, Limit

Vector = Sequence[float] | NDArray[Any]
"""So many numbers: three of a point, four of a quaternion x, y, z, w."""
Frame = tuple[Vector, Vector]
"""Position [m] and quaternion x, y, z, w."""
Place = tuple[str | None, Vector, Vector]
"""Name of a body, or none for the world; position [m] and quaternion x, y, z, w in its frame."""
Meshes = Literal["named", "exact", "hull", "pieces"]
"""What becomes of meshes that collide."""


class BodyOptions(TypedDict, total=False):
    """What every body may be given, as `Object.body` tells. `None` is as if nothing were given."""

    position: Vector | None
    orientation: Vector | None
    mass: float | None
    inertia: Sequence[Vector] | NDArray[Any] | None
    center: Vector | None
    static: bool | None
    group: int | None
    membership: int | None
    collides_with: int | None
    world: int | None


class JointOptions(TypedDict, total=False):
    """What every joint may be given.

    `position` and `orientation` place its frame in the object; or else `parent_frame` and `child_frame`, each a
    position and a quaternion, in both bodies. Without `parent`, the parent is the world. What acts along all its
    degrees of freedom, in N/m, N·s/m, kg, N or N·m/rad, N·m·s/rad, kg·m², N·m: `limit` (or its two ends), `drive`,
    `damping`, `stiffness` of a spring that rests at `rest`, `armature`, `friction_loss`; `dofs` tells what acts along
    each, one `Dof` for each. `initial` are its coordinates at the start. `linear_compliance` [m/N] and
    `angular_compliance` [rad/(N·m)] let the locked directions give (`xpbd`). `None` is as if nothing were given, but
    for the `limit` of a joint that is changed: it takes limits away.
    """

    parent: Body | None
    position: Vector | None
    orientation: Vector | None
    parent_frame: Frame | None
    child_frame: Frame | None
    initial: float | Vector | None
    dofs: Sequence[Dof] | None
    limit: Limit | Vector | None
    drive: Drive | None
    damping: float | None
    stiffness: float | None
    rest: float | None
    armature: float | None
    friction_loss: float | None
    linear_compliance: float | None
    angular_compliance: float | None
    closes_loop: bool | None
    bodies_collide: bool | None
    enabled: bool | None
