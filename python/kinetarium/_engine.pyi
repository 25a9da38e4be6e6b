"""The engine: what `kinetarium` is made of."""

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import Self, Unpack

from kinetarium.types import BodyOptions, Frame, JointOptions, Meshes, Place, Vector

__version__: str

__all__ = [
    "Axis",
    "Body",
    "Builder",
    "DeviceArray",
    "Disturbance",
    "Dof",
    "Drive",
    "Dynamics",
    "Engine",
    "Geometry",
    "Joint",
    "Limit",
    "Material",
    "Measurement",
    "Model",
    "Object",
    "Replica",
    "SensorArray",
    "Shape",
    "ShapeHandle",
    "Skin",
    "Softness",
    "View",
    "Viewer",
    "__version__",
    "arch",
    "ball_joint",
    "balls",
    "billiards",
    "card_house",
    "dominoes",
    "framing",
    "linkage",
    "load",
    "looking",
    "n_pendula",
    "parse",
    "pile",
    "png",
    "prismatic",
    "pyramid",
    "ragdolls",
    "render_view",
    "rings",
    "room",
    "rover",
    "run_program",
    "show",
]

@final
class Model:
    """A checked, immutable model of one world, shared by all worlds of a simulation.

    Made by `load`, `parse` or a `Builder`. Names index its tables: `model.body("torso")` is a row of
    `model.body_names`.
    """
    @property
    def name(self) -> str:
        """Name of the model."""
    @property
    def warnings(self) -> list[str]:
        """What of its file was left out, each with its line."""
    @property
    def time_step(self) -> float:
        """Recommended time step [s]."""
    @property
    def up_axis(self) -> Literal["y", "z"]:
        """The direction that is up: "y" or "z"."""
    @property
    def worlds(self) -> int:
        """Number of worlds that the model asks for."""
    @property
    def coordinates(self) -> int:
        """Number of joint coordinates: columns of `state.joint_position`."""
    @property
    def degrees_of_freedom(self) -> int:
        """Number of degrees of freedom: columns of `state.joint_velocity` and `controls.force`."""
    @property
    def total_mass(self) -> float:
        """Mass of everything that moves [kg]."""
    @property
    def body_names(self) -> list[str]:
        """Names of the bodies."""
    @property
    def body_parents(self) -> list[int]:
        """The parent body of each body's joint, −1 for the world and for bodies that do not move."""
    @property
    def joint_names(self) -> list[str]:
        """Names of the joints."""
    @property
    def joint_kinds(self) -> list[str]:
        """Kinds of the joints, such as "revolute"."""
    @property
    def shape_names(self) -> list[str]:
        """Names of the shapes; some may be empty."""
    @property
    def shape_bodies(self) -> list[int]:
        """The body of each shape, −1 for the world's."""
    @property
    def dof_names(self) -> list[str]:
        """Names of the degrees of freedom."""
    @property
    def coordinate_names(self) -> list[str]:
        """Names of the joint coordinates."""
    @property
    def actuator_names(self) -> list[str]:
        """Names of the actuators."""
    @property
    def sensors(self) -> list[tuple[str, float | None, float, float | None]]:
        """Of each sensor that the file describes: name, samples a second (none: at every step), standard deviation of
        its noise, and cutoff, if any. `kinetarium.sensors.from_model` makes sensors of them.
        """
    @property
    def keyframe_names(self) -> list[str]:
        """Names of the keyframes."""
    @property
    def camera_names(self) -> list[str]:
        """Names of the cameras."""
    @property
    def initial_position(self) -> NDArray[np.float64]:
        """Joint coordinates at the start, shape (coordinates,)."""
    @property
    def control_range(self) -> NDArray[np.float64]:
        """Lower and upper end of each actuator's control, shape (actuators, 2); infinite where there is none."""
    @property
    def dof_range(self) -> NDArray[np.float64]:
        """Lower and upper end of each degree of freedom's range [m or rad], shape (degrees of freedom, 2); infinite
        where there is none.
        """
    def body(self, name: str) -> int:
        """Row of a body. Raises `UnknownNameError`, as all that look up names do."""
    def joint(self, name: str) -> int:
        """Row of a joint."""
    def shape(self, name: str) -> int:
        """Row of a shape; of several of that name, of the first."""
    def dof(self, name: str) -> int:
        """Row of a degree of freedom."""
    def actuator(self, name: str) -> int:
        """Row of an actuator."""
    def joint_coordinates(self, name: str) -> tuple[int, int]:
        """The coordinates of a joint: columns of `state.joint_position`."""
    def joint_dofs(self, name: str) -> tuple[int, int]:
        """The degrees of freedom of a joint: columns of `state.joint_velocity`."""
    def keyframe(self, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """A named state: joint coordinates, joint velocities, actuator controls."""
    def camera(self, name: str) -> dict[str, Any]:
        """A camera: what `kinetarium.Camera` takes, by name."""
    def parameter(self, name: str) -> NDArray[np.float64]:
        """A parameter of the model by the name that it has in `Simulation.parameters`, shape (rows, numbers)."""
    def with_drives(self, drive: Drive, joints: Sequence[str] | None = None) -> Model:
        """The same model with a drive along each degree of freedom of some joints, in place of what they had: robot files
        often have joints without any, and the targets in `Simulation.controls` need them.

        Without names: all joints, but for free ones and those that follow another by a coupling; a model with actuators,
        which move some of its joints and leave others free on purpose, wants names. Where the drive has no effort limit,
        each joint keeps its own, as URDF files have it (`effort`). A drive without stiffness and damping takes theirs
        away. Hinges that turn without end are pulled the shorter way round: see `Drive`.

        >>> import kinetarium as kn
        >>> model = kn.examples.n_pendula(2).with_drives(kn.Drive(100.0, 10.0))
        >>> sim = kn.Simulation(model)
        >>> sim.controls.target_position[:, "hinge1"] = 0.5
        >>> sim.parameters.drive_stiffness
        NamedArray([[100., 100.]])

        Raises `UnknownNameError`, and `ModelError` for joints that take no drive.
        """
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...
    def __copy__(self) -> Model: ...
    def __deepcopy__(self, _memo: dict[int, Any]) -> Model: ...
    @staticmethod
    def _from_bytes(bytes: bytes) -> Model: ...

def load(
    path: str | PathLike[str],
    *,
    meshes: Meshes = "named",
    lenient: bool = False,
    floating_base: bool = False,
) -> Model:
    """Reads a robot file: MJCF (`<mujoco>`) or URDF (`<robot>`).

    `meshes`: what becomes of meshes that collide: "named" (refused by the solvers), "exact" (as they are),
    "hull" (their convex hulls) or "pieces" (convex pieces, nearly what they are). `lenient`: what is not supported and would change the motion is left out
    with a warning instead of an error. `floating_base`: the root link of a URDF floats. What was left out is in
    `Model.warnings`.

    Raises `FileError` with file and line.
    """

def parse(
    text: str,
    *,
    files: Mapping[str, str] = ...,
    meshes: Meshes = "named",
    lenient: bool = False,
    floating_base: bool = False,
) -> Model:
    """Reads a text as `load` reads a file; `files` are the texts of those that it includes, by their names."""

_Point = tuple[float, float, float]
_Combine = Literal["average", "minimum", "multiply", "maximum"]

@final
class Geometry:
    """A solid, centred at the origin of its own frame unless it is a hull, or a surface.

    Sizes are half sizes [m]; capsules, cylinders and cones stand along y. Made by its static methods, as in
    `Geometry.sphere(0.1)`.
    """
    @staticmethod
    def plane(half_x: float = 0.0, half_z: float = 0.0) -> Geometry:
        """The half space below y = 0 of its frame, drawn as a rectangle; endless where a half size is 0. A plane that ends
        is a `rectangle`.
        """
    @staticmethod
    def sphere(radius: float) -> Geometry:
        """A ball of a radius [m]."""
    @staticmethod
    def capsule(radius: float, half_height: float) -> Geometry:
        """A cylinder with round caps, along y; the half height [m] includes the caps and is at least 1.01 radii."""
    @staticmethod
    def cylinder(radius: float, half_height: float) -> Geometry:
        """A cylinder along y."""
    @staticmethod
    def cone(radius: float, half_height: float) -> Geometry:
        """A cone along y, its base at −half_height."""
    @staticmethod
    def box(half: Vector) -> Geometry:
        """A cuboid of three half extents [m]."""
    @staticmethod
    def ellipsoid(half: Vector) -> Geometry:
        """An ellipsoid of three half axes [m]."""
    @staticmethod
    def hull(points: Sequence[Vector] | NDArray[Any]) -> Geometry:
        """The convex hull of points [m], an array of the shape (points, 3)."""
    @staticmethod
    def mesh(
        vertices: Sequence[Vector] | NDArray[Any], triangles: Sequence[Sequence[int]] | NDArray[Any]
    ) -> Geometry:
        """A surface of triangles, touched from its front: vertices [m] (vertices, 3), triangles (triangles, 3)
        counter-clockwise as seen from outside. Where it is closed it has the mass of
        what it holds.
        """
    @staticmethod
    def revolution(profile: Sequence[Sequence[float]] | NDArray[Any], around: int = 32) -> Geometry:
        """What a closed profile of points (distance from the y axis, height) [m], counter-clockwise about what is solid,
        sweeps as it turns about that axis in `around` steps: a ring, a bowl.
        """
    @staticmethod
    def rectangle(half_x: float, half_z: float) -> Geometry:
        """A rectangle in the plane y = 0 of its frame, of half sizes [m], as a mesh of two triangles without thickness. It is
        touched from above, and what rolls off its edge falls; rays meet both of its sides. A plate to be touched from both
        is a thin box.
        """
    @staticmethod
    def height_field(heights: Sequence[Sequence[float]] | NDArray[Any], spacing: Vector) -> Geometry:
        """A height field, around the origin: heights [m] along y, an array of the shape (along z, along x), `spacing` [m]
        apart along x and z, in this order. The first axis is z: `heights[i][j]` stands at x = j · spacing[0] and
        z = i · spacing[1], counted from the corner of least x and z.
        """
    @staticmethod
    def distance_field(distances: Sequence[Sequence[Sequence[float]]] | NDArray[Any], spacing: float) -> Geometry:
        """The surface where signed distances [m] are zero, an array of the shape (along x, along y, along z), negative
        inside; the samples are `spacing` [m] apart, around the origin. The first axis is x, other than that of a
        height field.
        """
    def convex_hull(self) -> Geometry:
        """The convex hull of a mesh: what was hollow is filled."""
    @property
    def kind(self) -> str:
        """What it is, by the name of the method that makes it, such as "sphere"; "mesh" for all surfaces of triangles."""
    @property
    def center(self) -> _Point:
        """Middle of boxes about it [m]: the origin, but of a hull a point inside, and of a mesh the middle of its corners."""
    @property
    def half_extents(self) -> _Point | None:
        """Half of the box about `center` that holds it, along its own axes [m]; none for a plane, which has no end."""
    @property
    def vertices(self) -> NDArray[np.float64]:
        """Corners of a hull or mesh [m], shape (corners, 3); of others there are none."""
    @property
    def triangles(self) -> NDArray[np.uint32]:
        """Triangles of a hull or mesh, as rows of `vertices`, counter-clockwise as seen from outside, shape
        (triangles, 3); of others there are none.
        """
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...

@final
class Softness:
    """Resistance of a surface to being pressed in, at each point of contact."""
    @staticmethod
    def time(
        constant: float = 0.002, ratio: float = 1.0, impedance: float = 0.0, mass: float | None = None
    ) -> Softness:
        """What brings the touching masses to rest in a time constant [s] with a damping ratio; `impedance`,
        from 0 to below 1, is the share of a load that an added mass takes; `mass` [kg] is what moves at this
        surface, unless it is all that hangs together.
        """
    @staticmethod
    def spring(stiffness: float, damping: float) -> Softness:
        """Stiffness [N/m] and damping [N·s/m]."""
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...

@final
class Material:
    """Surface of a shape.

    `friction` is the coefficient of what slides, `static_friction` that of what sticks, at least as large; none: the same.
    `torsional_friction` and `rolling_friction` are lengths [m]; `margin` [m] is the distance from the surface at
    which contact begins; `combine` tells how coefficients of two surfaces become one: "average", "minimum",
    "multiply" or "maximum", of which the later holds.
    """
    def __new__(
        cls,
        friction: float = 0.5,
        *,
        static_friction: float | None = None,
        torsional_friction: float = 0.0,
        rolling_friction: float = 0.0,
        restitution: float = 0.0,
        softness: Softness | None = None,
        margin: float = 0.0,
        combine: _Combine = "average",
    ) -> Self: ...
    @property
    def friction(self) -> float:
        """Coulomb friction coefficient of what slides."""
    @property
    def static_friction(self) -> float | None:
        """Coulomb friction coefficient of what sticks, where it is another one."""
    @property
    def torsional_friction(self) -> float:
        """Torsional friction coefficient [m]."""
    @property
    def rolling_friction(self) -> float:
        """Rolling friction coefficient [m]."""
    @property
    def restitution(self) -> float:
        """Separation speed over approach speed."""
    @property
    def softness(self) -> Softness:
        """How far the surface gives way."""
    @property
    def margin(self) -> float:
        """Distance from the surface at which contact begins [m]."""
    @property
    def combine(self) -> _Combine:
        """How coefficients of two surfaces become one."""
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...

@final
class Shape:
    """A solid fixed to a body (or to the world), with its material.

    `position` [m] and `orientation` (x, y, z, w) are in the body's frame; `density` [kg/m³] gives mass to bodies
    that are given none; `color` is red, green, blue in sRGB and opacity, each 0 to 1; without `collides` it is only
    seen; a `sensor` touches but never pushes; `membership` and `collides_with` are kinds, a bit each.
    """
    def __new__(
        cls,
        geometry: Geometry,
        *,
        name: str = "",
        position: Vector | None = None,
        orientation: Vector | None = None,
        density: float = 1000.0,
        material: Material | None = None,
        color: Vector | None = None,
        collides: bool = True,
        sensor: bool = False,
        membership: int = 1,
        collides_with: int = 1,
    ) -> Self: ...
    @property
    def geometry(self) -> Geometry:
        """Its form."""
    @property
    def name(self) -> str:
        """Its name; may be empty."""
    @property
    def position(self) -> _Point:
        """Where it is in the body's frame [m]."""
    @property
    def orientation(self) -> tuple[float, float, float, float]:
        """How it is turned in the body's frame, a quaternion x, y, z, w."""
    @property
    def density(self) -> float:
        """Density [kg/m³]."""
    @property
    def material(self) -> Material:
        """Its surface."""
    @property
    def color(self) -> tuple[float, float, float, float] | None:
        """Red, green, blue in sRGB and opacity, each 0 to 1; none: its body's colour."""
    @property
    def collides(self) -> bool:
        """Whether it takes part in contacts."""
    @property
    def sensor(self) -> bool:
        """Whether it touches but never pushes."""
    @property
    def membership(self) -> int:
        """Kinds that it is of, a bit each."""
    @property
    def collides_with(self) -> int:
        """Kinds that it collides with, a bit each."""
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...

@final
class Axis:
    """One axis of a `d6` joint. Axes act in turn: each is fixed in the frame that the ones before it have moved.

    `reference` [m or rad] is the coordinate at which the two frames of the joint coincide.
    """
    @staticmethod
    def angular(direction: Vector, *, anchor: Vector | None = None, reference: float = 0.0) -> Axis:
        """Rotation about a direction, of any length but zero, through a point `anchor` [m] of the joint's frame; other
        points than its origin only `featherstone` takes.
        """
    @staticmethod
    def linear(direction: Vector, *, reference: float = 0.0) -> Axis:
        """Translation along a direction, of any length but zero."""
    @property
    def kind(self) -> Literal["linear", "angular"]:
        """What it does: "linear" or "angular"."""
    @property
    def direction(self) -> _Point:
        """Unit direction in the joint's frame."""
    @property
    def anchor(self) -> _Point:
        """A point on the axis in the joint's frame [m]."""
    @property
    def reference(self) -> float:
        """Coordinate at which the two joint frames coincide [m or rad]."""
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...

@final
class Limit:
    """A soft stop at each end of a coordinate's range [m or rad]; none where that is infinite, as in `Limit(0, math.inf)`.

    Beyond an end the force is −stiffness · excess − damping · velocity − inertia · acceleration, in N/m, N·s/m and kg
    or N·m/rad, N·m·s/rad and kg·m²; it never pulls.
    """
    def __new__(
        cls,
        lower: float,
        upper: float,
        *,
        stiffness: float = 1e4,
        damping: float = 1e2,
        inertia: float = 0.0,
    ) -> Self: ...
    @property
    def lower(self) -> float:
        """Lower end [m or rad]."""
    @property
    def upper(self) -> float:
        """Upper end [m or rad]."""
    @property
    def stiffness(self) -> float:
        """Stiffness [N/m or N·m/rad]."""
    @property
    def damping(self) -> float:
        """Damping [N·s/m or N·m·s/rad]."""
    @property
    def inertia(self) -> float:
        """Mass or moment of inertia that is carried along beyond the ends [kg or kg·m²]."""
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...

@final
class Drive:
    """A motor that pulls a coordinate to targets: stiffness · (target − q) + damping · (target velocity − q̇), within
    ± effort limit; of a ball that is a limit of the torque, whichever way it points.

    A hinge without a limit turns without end, and is pulled the shorter way round, unlike by a position servo, which counts
    turns.

    `control_time` [s] is the time constant with which it follows a jump of the target.
    """
    def __new__(
        cls,
        stiffness: float = 0.0,
        damping: float = 0.0,
        *,
        target_position: float = 0.0,
        target_velocity: float = 0.0,
        effort_limit: float = ...,
        control_time: float = 0.0,
    ) -> Self: ...
    @property
    def stiffness(self) -> float:
        """Stiffness [N/m or N·m/rad]."""
    @property
    def damping(self) -> float:
        """Damping [N·s/m or N·m·s/rad]."""
    @property
    def target_position(self) -> float:
        """Initial position target [m or rad]."""
    @property
    def target_velocity(self) -> float:
        """Initial velocity target [m/s or rad/s]."""
    @property
    def effort_limit(self) -> float:
        """Largest force or torque [N or N·m]."""
    @property
    def control_time(self) -> float:
        """Time constant with which it follows a jump of the target [s]."""
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...

@final
class Dof:
    """What acts along one degree of freedom of a joint, in N/m, N·s/m, kg, N or N·m/rad, N·m·s/rad, kg·m², N·m: `limit`
    (or its two ends), `drive`, `damping`, `stiffness` of a spring that rests at `rest`, `armature`, `friction_loss`.

    `name` is unique in the model; unless given, it is the joint's, with a number behind where there are several. What
    is not given is as the joint's own keywords say; or else does not act, or stays as it was where a joint is changed.
    """
    def __new__(
        cls,
        name: str | None = None,
        *,
        limit: Limit | Vector | None = None,
        drive: Drive | None = None,
        damping: float | None = None,
        stiffness: float | None = None,
        rest: float | None = None,
        armature: float | None = None,
        friction_loss: float | None = None,
    ) -> Self: ...
    @property
    def name(self) -> str | None:
        """Its name."""
    @property
    def limit(self) -> Limit | None:
        """Range of the coordinate."""
    @property
    def drive(self) -> Drive | None:
        """Motor."""
    @property
    def damping(self) -> float | None:
        """Viscous damping [N·s/m or N·m·s/rad]."""
    @property
    def stiffness(self) -> float | None:
        """Stiffness of a spring [N/m or N·m/rad]."""
    @property
    def rest(self) -> float | None:
        """Coordinate at which the spring is slack [m or rad]."""
    @property
    def armature(self) -> float | None:
        """Reflected inertia of the motor [kg or kg·m²]."""
    @property
    def friction_loss(self) -> float | None:
        """Dry friction [N or N·m]."""
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...

@final
class Body:
    """A body of a builder, in all replicas of its object."""
    @property
    def name(self) -> str:
        """Its name."""
    def shape(self, number: int = 0) -> ShapeHandle:
        """Its shape of this number, in the order of adding."""
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __copy__(self) -> Body: ...
    def __deepcopy__(self, _memo: dict[int, Any]) -> Body: ...

@final
class ShapeHandle:
    """A shape of a builder, in all replicas of its object; made by `Body.shape` and `Object.scenery`."""
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __copy__(self) -> ShapeHandle: ...
    def __deepcopy__(self, _memo: dict[int, Any]) -> ShapeHandle: ...

@final
class Joint:
    """A joint of a builder, in all replicas of its object."""
    @property
    def name(self) -> str:
        """Its name."""
    def __eq__(self, value: object, /) -> bool: ...
    def __ne__(self, value: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __copy__(self) -> Joint: ...
    def __deepcopy__(self, _memo: dict[int, Any]) -> Joint: ...

@final
class Builder:
    """Makes a `Model` by hand.

    A world consists of objects, an object of bodies, joints and actuators that belong together; an object can be
    replicated within the world, and each replica be placed by itself. `gravity` [m/s²] is 9.81 downwards unless
    given; `up_axis` is "y" or "z"; `time_step` [s] is what is recommended; `worlds` is how many the model asks for. All
    four can be set later, too.

    `copy.copy` and `copy.deepcopy` make a builder that goes its own way, and takes the bodies and joints that were made
    before; objects that are copied deeply together with their builder belong to the copy.

    >>> import kinetarium as kn
    >>> world = kn.Builder("pendulum")
    >>> arm = world.object("arm")
    >>> rod = kn.Geometry.capsule(radius=0.02, half_height=0.5)
    >>> link = arm.body("link", shapes=[rod], position=(0, -0.5, 0), mass=1.0)
    >>> hinge = arm.revolute("hinge", link, axis=(0, 0, 1), initial=[0.3])
    >>> arm.motor("motor", hinge, control_range=(-2, 2))
    >>> world.build().dof_names
    ['hinge']
    """
    def __new__(
        cls,
        name: str,
        *,
        up_axis: Literal["y", "z"] = "y",
        gravity: Vector | None = None,
        time_step: float = 0.002,
        worlds: int = 1,
    ) -> Self: ...
    @property
    def name(self) -> str:
        """Name of the model."""
    @property
    def up_axis(self) -> Literal["y", "z"]:
        """The direction that is up: "y" or "z". Setting it turns gravity to point down."""
    @up_axis.setter
    def up_axis(self, value: Literal["y", "z"], /) -> None: ...
    @property
    def gravity(self) -> _Point:
        """Gravity [m/s²]."""
    @gravity.setter
    def gravity(self, value: Vector, /) -> None: ...
    @property
    def time_step(self) -> float:
        """Recommended time step [s]."""
    @time_step.setter
    def time_step(self, value: float, /) -> None: ...
    @property
    def worlds(self) -> int:
        """Number of worlds that the model asks for."""
    @worlds.setter
    def worlds(self, value: int, /) -> None: ...
    @property
    def objects(self) -> list[Object]:
        """The objects, in the order of making."""
    def object(self, name: str) -> Object:
        """Adds an empty object."""
    def change_body(
        self,
        body: Body,
        shapes: Sequence[Shape | Geometry] | Shape | Geometry | None = None,
        **options: Unpack[BodyOptions],
    ) -> None:
        """Changes a body that was made before: `shapes`, one or several, are added to those that it has; of the rest, the
        keywords of `Object.body`, what is not given stays. A body can be made `static`, and stays so.
        """
    def change_joint(self, joint: Joint, **options: Unpack[JointOptions]) -> None:
        """Changes a joint that was made before: of the keywords that all joints take, what is not given stays; a `limit`
        of `None` takes away what limits there are. See `JointOptions`.
        """
    def keyframe(
        self,
        name: str,
        joint_position: Vector,
        *,
        joint_velocity: Vector | None = None,
        control: Vector = ...,
    ) -> None:
        """Adds a named state of the finished model: coordinates of all joints, their velocities, controls of the
        actuators; without `joint_velocity`, at rest as the world is now.
        """
    def contact_pair(
        self,
        a: ShapeHandle,
        b: ShapeHandle,
        material: Material | None = None,
        *,
        friction: float | None = None,
        static_friction: float | None = None,
        torsional_friction: float | None = None,
        rolling_friction: float | None = None,
        restitution: float | None = None,
        softness: Softness | None = None,
        margin: float | None = None,
    ) -> None:
        """Has two shapes touch in any case, whatever masks, groups, joints and exclusions say, with a surface of their own:
        `material`, or else what their materials make of each other now; and of that surface what else is given. Where
        `friction` is given, what sticks has it too, unless `static_friction` is.

        Each replica of the one is paired with its own replica of the other; one of another object may also stand there
        only once.

        >>> import kinetarium as kn
        >>> world = kn.Builder("curling")
        >>> ice = world.object("rink").scenery(kn.Geometry.plane())
        >>> stone = world.object("stones").body("stone", kn.Geometry.cylinder(0.145, 0.06), mass=19.0)
        >>> world.contact_pair(stone.shape(), ice, friction=0.01)
        """
    def body_row(self, body: Body, replica: int = 0) -> int:
        """Row of a body's k-th replica in the model that `build` makes."""
    def joint_row(self, joint: Joint, replica: int = 0) -> int:
        """Row of a joint's k-th replica in the model that `build` makes."""
    def shape_row(self, shape: ShapeHandle, replica: int = 0) -> int:
        """Row of a shape's k-th replica in the model that `build` makes."""
    def build(self) -> Model:
        """Compiles the world to a checked model. The builder can go on being used.

        Raises `ModelError` with the first fault found and its remedy.
        """
    def __copy__(self) -> Builder: ...
    def __deepcopy__(self, _memo: dict[int, Any]) -> Builder: ...

@final
class Object:
    """Bodies, joints and actuators that belong together; made by `Builder.object`.

    A call that is refused leaves everything as it was.
    """
    @property
    def name(self) -> str:
        """Its name."""
    @property
    def bodies(self) -> list[Body]:
        """Its bodies, in the order of making."""
    @property
    def joints(self) -> list[Joint]:
        """Its joints, in the order of making."""
    def body(
        self,
        name: str,
        shapes: Sequence[Shape | Geometry] | Shape | Geometry | None = None,
        *,
        position: Vector = ...,
        orientation: Vector = ...,
        mass: float | None = None,
        inertia: Sequence[Vector] | NDArray[Any] | None = None,
        center: Vector | None = None,
        static: bool = False,
        group: int | None = None,
        membership: int | None = None,
        collides_with: int | None = None,
        world: int = 0,
    ) -> Body:
        """Adds a body of shapes, one or several.

        `position` [m] and `orientation` (x, y, z, w) are in the object. Mass [kg] and inertia follow from the shapes and
        their densities; `mass` alone scales them; `mass` with `inertia` [kg·m²] (3 × 3, about `center` [m], along the
        body's axes) replaces them. A `static` body never moves, and has no mass. Bodies of `group`s collide as the
        conventions say; `membership` and `collides_with` are given to all its shapes. `world` is a number from −1 on:
        bodies of different numbers, neither of them −1, do not touch, and no joint may tie them. It has nothing to do
        with the worlds of a simulation, each of which has all bodies.
        """
    def scenery(self, shape: Shape | Geometry) -> ShapeHandle:
        """Adds a shape that belongs to the world, such as a floor."""
    def fixed(self, name: str, child: Body, **options: Unpack[JointOptions]) -> Joint:
        """Adds a joint without motion. What else joints may be given are keywords: see `JointOptions`."""
    def revolute(self, name: str, child: Body, axis: Vector, **options: Unpack[JointOptions]) -> Joint:
        """Adds a hinge about an axis of its frame, of any length but zero."""
    def prismatic(self, name: str, child: Body, axis: Vector, **options: Unpack[JointOptions]) -> Joint:
        """Adds a slide along an axis of its frame, of any length but zero."""
    def ball(self, name: str, child: Body, **options: Unpack[JointOptions]) -> Joint:
        """Adds a ball joint; its coordinates are a quaternion x, y, z, w. It has three degrees of freedom."""
    def free(self, name: str, child: Body, **options: Unpack[JointOptions]) -> Joint:
        """Adds a joint that lets everything go; its coordinates are a position [m] and a quaternion. It has six degrees of
        freedom: three along, three about.
        """
    def distance(self, name: str, child: Body, length: float, **options: Unpack[JointOptions]) -> Joint:
        """Adds a joint that keeps the origins of its two frames `length` [m] apart."""
    def d6(self, name: str, child: Body, axes: Sequence[Axis], **options: Unpack[JointOptions]) -> Joint:
        """Adds a joint of up to three linear and three angular axes, in turn, each of which is a degree of freedom."""
    def plane_xz(self, name: str, child: Body, **options: Unpack[JointOptions]) -> Joint:
        """Adds a joint that moves along x and z of its frame and turns about its y: three degrees of freedom."""
    def exclude(self, body: Body, other: Body | None = None) -> None:
        """Lets two bodies pass through each other; without `other`, a body and the world."""
    def couple(self, name: str, joint: Joint, other: Joint, *, ratio: float = 1.0, offset: float = 0.0) -> None:
        """Ties two coordinates: q(joint) = offset + ratio · q(other); taken by `featherstone` and `xpbd`."""
    def motor(
        self,
        name: str,
        joint: Joint,
        *,
        gear: float = 1.0,
        dof: int = 0,
        control_range: Vector | None = None,
        force_range: Vector | None = None,
    ) -> None:
        """Adds a motor: its force is gear · control [N or N·m]. An end of a range that is infinite is none."""
    def position_servo(
        self,
        name: str,
        joint: Joint,
        *,
        stiffness: float,
        damping: float = 0.0,
        gear: float = 1.0,
        dof: int = 0,
        control_range: Vector | None = None,
        force_range: Vector | None = None,
    ) -> None:
        """Adds a servo whose control is a position: stiffness · (control − q) − damping · q̇."""
    def velocity_servo(
        self,
        name: str,
        joint: Joint,
        *,
        damping: float,
        gear: float = 1.0,
        dof: int = 0,
        control_range: Vector | None = None,
        force_range: Vector | None = None,
    ) -> None:
        """Adds a servo whose control is a velocity: damping · (control − q̇)."""
    def replicate(self, count: int) -> None:
        """Asks for this many copies of the object within the world, each placed by `replica`."""
    def replica(self, k: int) -> Replica:
        """The k-th copy, to be moved."""
    def replicas(self) -> Replica:
        """All copies, to be moved together."""
    def __copy__(self) -> Object: ...
    def __deepcopy__(self, memo: dict[int, Any]) -> Object: ...

@final
class Replica:
    """One copy of an object, or all, to be moved within the world."""
    def translate_by(self, shift: Vector) -> None:
        """Moves it by a shift [m]."""
    def translate_to(self, point: Vector) -> None:
        """Moves its origin to a point [m]."""
    def move_on_axis_by(self, axis: Vector, distance: float) -> None:
        """Moves it along a direction by a distance [m]."""
    def move_on_axis_to(self, axis: Vector, distance: float) -> None:
        """Moves it along a direction until its origin is at a distance [m] along it."""
    def rotate_around_by(self, point: Vector, axis: Vector, angle: float) -> None:
        """Turns it about an axis through a point [m] by an angle [rad]."""
    def rotate_around_to(self, point: Vector, axis: Vector, angle: float) -> None:
        """Turns it about an axis through a point [m] until it is turned by an angle [rad] about it."""

@final
class DeviceArray:
    """Numbers (float32) of all worlds in the memory of a CUDA card."""
    @property
    def shape(self) -> tuple[int, ...]: ...
    @property
    def __cuda_array_interface__(self) -> dict[str, Any]: ...
    def __dlpack_device__(self) -> tuple[int, int]: ...
    def __dlpack__(
        self,
        *,
        stream: int | None = None,
        max_version: tuple[int, int] | None = None,
        dl_device: tuple[int, int] | None = None,
        copy: bool | None = None,
    ) -> Any: ...

@final
class Dynamics:
    """Functions of states, one a row; arrays are float64 and contiguous, and Python's lock is free meanwhile."""
    def __new__(cls, model: Model) -> Self: ...
    def mass_matrix(self, position: NDArray[np.float64]) -> NDArray[np.float64]:
        """M(q), row by row."""
    def inverse_dynamics(
        self, position: NDArray[np.float64], velocity: NDArray[np.float64], acceleration: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """τ of a motion."""
    def forward_dynamics(
        self, position: NDArray[np.float64], velocity: NDArray[np.float64], force: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """q̈ under forces."""
    def jacobian(self, position: NDArray[np.float64], body: int, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """J(q) of points of a body, row by row."""
    def bodies(self, position: NDArray[np.float64], velocity: NDArray[np.float64]) -> NDArray[np.float64]:
        """13 numbers of each body: placement and velocities."""

@final
class Engine:
    """W worlds of one model. All calls copy between arrays and the blocks in which worlds lie, and leave Python's lock
    free while they compute; arrays are contiguous and of the simulation's precision.
    """
    def __new__(
        cls,
        model: Model,
        *,
        worlds: int,
        time_step: float,
        solver: str,
        substeps: int | None,
        iterations: int,
        integrator: str,
        contacts: bool,
        contact_passes: int,
        contact_iterations: int,
        speed_limit: float,
        sleep_speed: float,
        threads: int,
        double: bool,
        device: str,
    ) -> Self: ...
    def close(self) -> None:
        """Frees the worlds; later calls raise `ClosedError`."""
    def describe(self) -> tuple[str, str, int, str]:
        """Name of the solver, name of the instruction set, number of threads, name of the device."""
    def left_to_processor(self) -> int:
        """How many substeps the device has left to the processor."""
    def step(self, steps: int) -> list[int]:
        """Advances all worlds; the worlds that diverged meanwhile."""
    def begun(self) -> NDArray[np.uint64]:
        """How often each world was set, reset or restored."""
    def times(self) -> NDArray[np.float64]:
        """Time of every world [s]."""
    def diverged(self) -> list[tuple[int, float]]:
        """The worlds that have diverged, and when [s]."""
    def read(self, quantity: str, out: NDArray[Any]) -> None:
        """Copies a quantity of all worlds into an array."""
    def read_columns(self, quantity: str, table: NDArray[Any], column: int) -> None:
        """Copies a quantity of all worlds into columns of a table."""
    def quantity_on_device(self, quantity: str, shape: tuple[int, ...]) -> DeviceArray:
        """Where a quantity of all worlds lies on a card, as an array of this shape."""
    def control_on_device(self, control: str, shape: tuple[int, ...]) -> DeviceArray:
        """Where a control of all worlds lies on a card, as an array of this shape."""
    def read_control(self, control: str, out: NDArray[Any]) -> None:
        """Copies a control of all worlds into an array."""
    def write_control(self, control: str, numbers: NDArray[Any]) -> None:
        """Sets a control of all worlds from an array."""
    def set_joint_state(
        self,
        worlds: NDArray[np.int64],
        position: NDArray[np.float64],
        velocity: NDArray[np.float64],
        keep: bool,
    ) -> None:
        """Sets joint coordinates and velocities of some worlds, a row for each; with `keep` they keep their times and
        controls.
        """
    def set_joint_velocities(self, worlds: NDArray[np.int64], velocity: NDArray[np.float64]) -> None:
        """Sets joint velocities of some worlds, a row for each; all else stays."""
    def reset(self, worlds: NDArray[np.int64]) -> None:
        """Brings some worlds to their initial state."""
    def snapshot(self) -> bytes:
        """The whole state of all worlds, to the bit."""
    def restore(self, bytes: bytes) -> None:
        """Returns to a snapshot."""
    def asleep(self, world: int) -> list[bool]:
        """Which bodies of a world sleep."""
    def contacts(self, worlds: NDArray[np.int64]) -> dict[str, NDArray[Any]]:
        """The contacts of the last step in some worlds, as a dictionary of arrays with a row for each."""
    def cast_rays(
        self,
        worlds: NDArray[np.int64],
        origins: NDArray[np.float64],
        directions: NDArray[np.float64],
        max_distance: float,
    ) -> dict[str, NDArray[Any]]:
        """What rays meet first, the same number in each of some worlds: arrays with a row for each ray."""
    def cast_shapes(
        self,
        worlds: NDArray[np.int64],
        geometry: Geometry,
        positions: NDArray[np.float64],
        orientations: NDArray[np.float64],
        directions: NDArray[np.float64],
        max_distance: float,
        seen: tuple[bool, bool, int | None, list[int]],
    ) -> dict[str, NDArray[Any]]:
        """What a shape first touches that is swept along lines, the same number in each of some worlds: arrays with a row for
        each sweep.
        """
    def nearest(
        self,
        worlds: NDArray[np.int64],
        points: NDArray[np.float64],
        count: int,
        max_distance: float,
        seen: tuple[bool, bool, int | None, list[int]],
    ) -> dict[str, NDArray[Any]]:
        """The nearest shapes to points, the same number of points in each of some worlds: arrays with so many rows for each
        point.
        """
    def closest_points(
        self,
        worlds: NDArray[np.int64],
        points: NDArray[np.float64],
        max_distance: float,
        seen: tuple[bool, bool, int | None, list[int]],
    ) -> dict[str, NDArray[Any]]:
        """The nearest points of all shapes within a distance of points, the same number of points in each of some worlds: arrays
        with a row for each shape, and that of its point.
        """
    def overlaps(
        self,
        worlds: NDArray[np.int64],
        geometry: Geometry,
        positions: NDArray[np.float64],
        orientations: NDArray[np.float64],
        seen: tuple[bool, bool, int | None, list[int]],
    ) -> dict[str, NDArray[Any]]:
        """The shapes that a shape overlaps in some places, the same number of places in each of some worlds: arrays with a row
        for each shape, and that of its place.
        """
    def read_parameter(self, name: str, worlds: NDArray[np.int64]) -> NDArray[np.float64]:
        """A parameter of some worlds, shape (worlds, rows · numbers)."""
    def write_parameter(self, name: str, worlds: NDArray[np.int64], numbers: NDArray[np.float64]) -> None:
        """Gives some worlds other numbers of a parameter, a row for each world; none where one is refused."""
    def write_parameters(self, worlds: NDArray[np.int64], parameters: list[tuple[str, NDArray[np.float64]]]) -> None:
        """Gives some worlds other numbers of several parameters, of each a row for each world, also where they can be had only
        together; none where one is refused.
        """
    def linearize(self, world: int) -> dict[str, NDArray[np.float64]]:
        """A time step linearised at the state of a world: arrays by name."""
    def watch(
        self,
        *,
        contacts: bool,
        persisting_contacts: bool,
        sensors: bool,
        limits: bool,
        sleep: bool,
        divergence: bool,
    ) -> None:
        """Chooses which events are told."""
    def drain_events(self) -> list[tuple[int, float, Any, dict[str, Any]]]:
        """The events since the last call: world, time [s], kind, and what belongs to the kind."""

@final
class Measurement:
    """What a sensor measures, of a model whose names it was given."""
    @staticmethod
    def joint_position(model: Model, names: list[str] | None) -> Measurement: ...
    @staticmethod
    def joint_velocity(model: Model, names: list[str] | None) -> Measurement: ...
    @staticmethod
    def joint_effort(model: Model, names: list[str] | None) -> Measurement: ...
    @staticmethod
    def actuator_force(model: Model, names: list[str] | None) -> Measurement: ...
    @staticmethod
    def center_of_mass(model: Model, body: str | None) -> Measurement: ...
    @staticmethod
    def described(model: Model, name: str) -> Measurement:
        """What a sensor of the model's file measures."""
    @staticmethod
    def imu(model: Model, place: Place) -> Measurement: ...
    @staticmethod
    def force_torque(model: Model, joint: str, frame: Frame | None) -> Measurement: ...
    @staticmethod
    def touch(model: Model, body: str) -> Measurement: ...
    @staticmethod
    def contact_force(model: Model, body: str, axes: str) -> Measurement: ...
    @staticmethod
    def frame_pose(model: Model, place: Place, relative_to: Place) -> Measurement: ...
    @staticmethod
    def frame_velocity(model: Model, place: Place, axes: str) -> Measurement: ...
    @staticmethod
    def rangefinder(model: Model, place: Place, max_range: float) -> Measurement: ...
    @staticmethod
    def lidar(
        model: Model, place: Place, azimuths: list[float], elevations: list[float], max_range: float
    ) -> Measurement: ...
    @staticmethod
    def camera(view: View, rgb_noise: float, depth_noise: float, device: str) -> Measurement: ...

@final
class Disturbance:
    """Noise and cutoff of a sensor that is measured in Python."""
    def __new__(
        cls, name: str, seed: int, levels: Sequence[float | list[float]], cutoff: float | None, numbers: int
    ) -> Self: ...
    @property
    def is_none(self) -> bool:
        """Whether readings are what is measured."""
    def apply(
        self, samples: list[tuple[int, int, int, float]], numbers: NDArray[np.float64], walk: NDArray[np.float64]
    ) -> None:
        """Turns what was measured, shape (worlds, numbers), into what is read in those worlds of which there are samples:
        world, how often it has begun anew, which sample, and time since the one before [s].
        """

@final
class SensorArray:
    """The sensors of one simulation."""
    def __new__(cls, engine: Engine, sensors: list[tuple[Any, ...]], seed: int) -> Self: ...
    def step(self, engine: Engine, steps: int) -> list[int]:
        """Advances the simulation and misses no sample; the worlds that diverged meanwhile."""
    def update(self, engine: Engine) -> None:
        """Samples what is due now, as after a reset."""
    def resample(self, engine: Engine) -> None:
        """The same, and samples anew what was sampled just now."""
    def reading(self, name: str) -> tuple[NDArray[Any], NDArray[np.float64]]:
        """The reading of a sensor, shape (worlds, …), and the time of each world's sample [s]."""
    def images(self, name: str) -> tuple[dict[str, NDArray[Any]], NDArray[np.float64]]:
        """The images of a camera by channel, and the time of each world's image [s]."""
    def save(self) -> bytes:
        """What the sensors carry along, beside a snapshot of their simulation."""
    def restore(self, bytes: bytes) -> None:
        """Puts back what `save` gave."""

@final
class View:
    """A camera, and what is wanted of it."""
    def __new__(
        cls,
        model: Model,
        *,
        width: int,
        height: int,
        field_of_view: float,
        focal: Vector | None,
        principal: Vector | None,
        near: float,
        far: float,
        body: str | None,
        mode: str,
        position: Vector,
        orientation: Vector,
        channels: list[str],
        samples: int,
        occlusion: int,
        light: Any,
        checker: float | None,
    ) -> Self: ...

def render_view(
    engine: Engine, model: Model, view: View, worlds: NDArray[np.int64], device: str
) -> dict[str, NDArray[Any]]:
    """What a camera sees in some worlds, by channel."""

def framing(
    engine: Engine, model: Model, world: int, width: int, height: int
) -> tuple[list[float], list[float], float]:
    """Position [m] and orientation of a free camera that has all bodies of a world in its image."""

def png(rgb: NDArray[np.uint8]) -> bytes:
    """Colours of one world, shape (height, width, 3), as a picture in a file."""

def looking(eye: Vector, target: Vector, up: Vector) -> list[float]:
    """Orientation of a camera at `eye` that has `target` in the middle of its image and `up` upwards."""

@final
class Skin:
    """What a body looks like on a page; made by `kinetarium.Skin`."""
    @staticmethod
    def color(red: float, green: float, blue: float, opacity: float) -> Skin:
        """One colour and opacity, sRGB, each from 0 to 1."""
    @staticmethod
    def named(name: str) -> Skin:
        """One that has a name."""
    @staticmethod
    def file(path: PathLike[str] | str, fitted: bool) -> Skin:
        """A picture or a model in a file, fitted to the body's shapes or as large as in the file."""

@final
class Viewer:
    """A page about a simulation, served in the background until it is closed or the simulation is gone."""
    @property
    def url(self) -> str:
        """Where the page is, with its token where there is one."""
    @property
    def is_open(self) -> bool:
        """Whether it still serves."""
    def dress(self, bodies: Sequence[str] | None, skin: Skin) -> None:
        """Has bodies wear a skin, by their names; without names, all of them."""
    def close(self) -> None:
        """Stops serving."""

def show(engine: Engine, address: str | None = None, token: str | None = None) -> Viewer:
    """Serves a page about a simulation at an address, or at any free port of the loopback address."""

def run_program(arguments: Sequence[str]) -> int:
    """The program `kinetarium` with a command line, its name first; returns its exit code."""

def n_pendula(links: int = ...) -> Model:
    """A chain of links on hinges, hanging from the world."""

def ball_joint() -> Model:
    """A body on a ball joint with drives."""

def prismatic() -> Model:
    """A slide with a drive."""

def balls() -> Model:
    """Five balls that bounce, each by its restitution."""

def billiards() -> Model:
    """Elastic balls on a smooth table."""

def dominoes(count: int = ...) -> Model:
    """A row of dominoes, the first of which falls."""

def pyramid(rows: int = ...) -> Model:
    """A pyramid of boxes."""

def pile(count: int = ...) -> Model:
    """A heap of solids of all kinds."""

def card_house(storeys: int = ...) -> Model:
    """A house of cards."""

def arch(stones: int = ...) -> Model:
    """An arch of stones that hold each other."""

def ragdolls(people: int = ...) -> Model:
    """People made of capsules and hinges, falling."""

def rings(count: int = ...) -> Model:
    """Rings of triangles on a peg, and a chain of them."""

def linkage(pairs: int = ...) -> Model:
    """A machine that walks on closed loops of bars."""

def room() -> Model:
    """A room with things in it."""

def rover() -> Model:
    """A vehicle with wheels on springs."""
