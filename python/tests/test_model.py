"""Models from files and builders."""

import copy
import pickle

import numpy as np
import pytest

import kinetarium as kn
from kinetarium.errors import FileError, ModelError, ShapeError, UnknownNameError

HOPPER = """
<mujoco model="one leg">
  <worldbody>
    <geom name="floor" type="plane" size="5 5 .1"/>
    <body name="leg" pos="0 0 1">
      <joint name="hip" type="hinge" axis="0 1 0" range="-60 60" limited="true"/>
      <geom name="shin" type="capsule" fromto="0 0 0 0 0 -.5" size=".05"/>
    </body>
  </worldbody>
  <actuator><motor name="hip" joint="hip" gear="30" ctrlrange="-1 1" ctrllimited="true"/></actuator>
</mujoco>
"""


def test_a_file_is_read_with_its_names(tmp_path):
    path = tmp_path / "leg.xml"
    path.write_text(HOPPER)
    model = kn.load(path)
    assert model == kn.load(str(path))
    assert (model.body_names, model.joint_names, model.actuator_names) == (["leg"], ["hip"], ["hip"])
    assert model.up_axis == "z" and model.coordinates == model.degrees_of_freedom == 1
    assert model.control_range.tolist() == [[-1.0, 1.0]]
    assert np.degrees(model.dof_range).round(9).tolist() == [[-60.0, 60.0]]
    assert model.shape_bodies == [-1, 0]
    assert "one leg" in repr(model)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<mujoco><worldbody><body><joint type='wheel'/></body></worldbody></mujoco>", "wheel"),
        ("<mujoco><worldbody>", "text:1"),
        ("<sdf/>", "<mujoco>"),
        ("", "text"),
    ],
)
def test_broken_files_name_the_place(text, message):
    with pytest.raises(FileError, match=message):
        kn.parse(text)
    with pytest.raises(FileError, match=r"missing\.xml"):
        kn.load("missing.xml")
    with pytest.raises(UnknownNameError, match="there are named, exact, hull"):
        kn.parse(HOPPER, meshes="some")


def test_messages_name_options_as_python_has_them():
    with pytest.raises(FileError, match=r"or load leniently \(lenient=True\)"):
        kn.parse("<mujoco><worldbody><body gravcomp='1'><freejoint/><geom size='1'/></body></worldbody></mujoco>")


def test_a_builder_makes_what_it_is_told():
    world = kn.Builder("crane", gravity=(0, -3.7, 0), time_step=0.004)
    crane = world.object("crane")
    steel = kn.Material(0.3, restitution=0.1, softness=kn.Softness.spring(1e5, 1e2), combine="minimum")
    mast = crane.body("mast", [kn.Geometry.box((0.1, 1.0, 0.1))], position=(0, 1, 0), static=True)
    arm = crane.body(
        "arm",
        [kn.Shape(kn.Geometry.capsule(0.05, 0.5), name="rod", material=steel, color=(1, 0, 0, 1))],
        position=(0.5, 2, 0),
        orientation=(0, 0, np.sqrt(0.5), np.sqrt(0.5)),
        mass=3.0,
    )
    hook = crane.body("hook", mass=0.5, inertia=np.eye(3) * 0.01, position=(1, 1.5, 0))
    hinge = crane.revolute(
        "hinge",
        arm,
        (0, 0, 1),
        parent=mast,
        position=(0, 2, 0),
        limit=kn.Limit(-1, 1),
        drive=kn.Drive(500.0, 50.0, target_position=0.3),
        armature=0.01,
    )
    crane.ball("rope", hook, parent=arm, position=(1, 2, 0), damping=0.05)
    crane.position_servo("servo", hinge, stiffness=100.0, control_range=(-1, 1))
    model = world.build()
    assert model.body_names == ["mast", "arm", "hook"]
    assert model.joint_kinds == ["revolute", "ball"]
    assert model.parameter("body_mass")[1, 0] == pytest.approx(3.0)
    assert model.parameter("drive_stiffness")[0, 0] == 500.0
    assert model.time_step == 0.004 and model.parameter("gravity").ravel().tolist() == [0, -3.7, 0]
    assert (world.body_row(hook), world.joint_row(hinge)) == (2, 0)
    sim = kn.Simulation(model, worlds=3)
    assert sim.step(1000).size == 0
    # Held by drive and servo near their targets: stiffness · (0.3 − q) + 100 (0 − q) against a weight.
    assert (np.abs(sim.state.joint_position[:, "hinge"]) < 0.3).all()


def test_replicas_are_placed_one_by_one():
    world = kn.Builder("balls")
    ball = world.object("ball")
    handle = ball.body("ball", [kn.Geometry.sphere(0.1)])
    ball.replicate(3)
    ball.replicas().translate_by((0, 1, 0))
    ball.replica(2).move_on_axis_to((1, 0, 0), 4.0)
    model = world.build()
    assert model.body_names == ["ball_0", "ball_1", "ball_2"]
    sim = kn.Simulation(model)
    assert sim.state.body_position[0, world.body_row(handle, 2)].tolist() == [4.0, 1.0, 0.0]
    with pytest.raises(ModelError, match="replica"):
        ball.replica(3)
    with pytest.raises(ModelError, match="direction"):
        ball.replicas().move_on_axis_by((0, 0, 0), 1.0)


@pytest.mark.parametrize("solver", ["featherstone", "xpbd", "impulse"])
def test_a_ring_of_triangles_falls_around_a_peg(solver):
    ring = kn.Geometry.revolution([(0.15, 0.0), (0.12, 0.03), (0.09, 0.0), (0.12, -0.03)], 16)
    world = kn.Builder("peg")
    ground = world.object("ground")
    ground.scenery(kn.Geometry.plane())
    ground.scenery(kn.Geometry.capsule(0.05, 0.4))
    world.object("thing").body("ring", [ring], position=(0.02, 0.5, 0.0))
    sim = kn.Simulation(world.build(), solver=solver, dt=0.002)
    sim.step(1000)
    x, y, z = sim.state.body_position[0, "ring"]
    assert abs(y - 0.03) < 1e-3 and np.hypot(x, z) < 0.041
    with pytest.raises(ModelError, match="at least 3 of each"):
        kn.Geometry.revolution([(1, 0), (2, 0)])


def test_faults_of_builders_are_told():
    world = kn.Builder("bad")
    thing = world.object("thing")
    body = thing.body("b", [kn.Geometry.sphere(-1.0)], mass=1.0, inertia=np.eye(3))
    with pytest.raises(ModelError, match="radius"):
        world.build()
    with pytest.raises(UnknownNameError, match='no option of joints "dampening"; did you mean "damping"'):
        thing.revolute("j", body, (0, 0, 1), dampening=1.0)
    with pytest.raises(ModelError, match="not both"):
        thing.ball("j", body, position=(0, 0, 0), child_frame=((0, 0, 0), (0, 0, 0, 1)))
    with pytest.raises(ModelError, match="inertia and no mass"):
        thing.body("c", inertia=np.eye(3))
    with pytest.raises(ModelError, match="4 points"):
        kn.Geometry.hull([(0, 0, 0), (1, 0, 0)])
    with pytest.raises(UnknownNameError, match='no axis "x"; there are y, z'):
        kn.Builder("x", up_axis="x")
    with pytest.raises(TypeError):
        thing.body("d", shapes=["box"])


def test_each_degree_of_freedom_has_what_it_is_given():
    world = kn.Builder("disc")
    thing = world.object("thing")
    disc = thing.body("disc", kn.Geometry.sphere(0.1))
    axes = [kn.Axis.linear((1, 0, 0)), kn.Axis.angular((0, 0, 1), anchor=(0, 0.5, 0), reference=0.25)]
    thing.d6(
        "root",
        disc,
        axes,
        damping=0.5,
        limit=None,
        dofs=[
            kn.Dof("slide", limit=(-1, 2), friction_loss=0.1),
            kn.Dof("turn", drive=kn.Drive(10.0, 1.0), stiffness=3.0, rest=0.2, armature=0.01),
        ],
    )
    model = world.build()
    assert model.dof_names == ["slide", "turn"]
    assert model.dof_range.tolist() == [[-1.0, 2.0], [-np.inf, np.inf]]
    for name, numbers in [
        ("damping", [0.5, 0.5]),
        ("friction_loss", [0.1, 0.0]),
        ("drive_stiffness", [0.0, 10.0]),
        ("stiffness", [0.0, 3.0]),
        ("rest", [0.0, 0.2]),
        ("armature", [0.0, 0.01]),
    ]:
        assert model.parameter(name).ravel().tolist() == numbers
    assert model.initial_position.tolist() == [0.0, 0.25]  # the references
    sim = kn.Simulation(model, dtype="float64")
    sim.state.joint_position[0] = (0.0, 0.25 + np.pi / 2)
    assert np.allclose(sim.state.body_position[0, "disc"], (0.5, 0.5, 0.0))  # about the anchor


@pytest.mark.parametrize(
    ("kind", "options", "message"),
    [
        ("ball", {"dofs": [kn.Dof()]}, '"j": its list of degrees of freedom .* has 1 entries; it needs 3'),
        ("ball", {"damping": 1, "dofs": [kn.Dof(), kn.Dof(damping=2), kn.Dof()]}, "damping is given .* number 1"),
        ("ball", {"rest": 0.1}, "a rest and no stiffness"),
        ("plane_xz", {"dofs": [kn.Dof(rest=0.1)] * 3}, "a rest and no stiffness"),
        ("fixed", {"limit": kn.Limit(-1, 1)}, "no degree of freedom that its limit"),
        ("fixed", {"damping": 1.0}, "no degree of freedom that its damping"),
        ("free", {"position": (0, 0, 0), "child_frame": [(0, 0, 0), (0, 0, 0, 1)]}, "not both"),
    ],
)
def test_options_of_joints_that_make_no_sense(kind, options, message):
    thing = kn.Builder("bad").object("thing")
    body = thing.body("b", kn.Geometry.sphere(0.1))
    with pytest.raises(ModelError, match=message):
        getattr(thing, kind)("j", body, **options)
    assert thing.joints == []


def test_what_is_refused_leaves_nothing_behind():
    world = kn.Builder("retries")
    thing = world.object("thing")
    body = thing.body("b", [kn.Geometry.sphere(0.1)])
    for wrong in ({"dampening": 1}, {"damping": "much"}, {"limit": "far"}, {"initial": "now"}, {"dofs": [1]}):
        with pytest.raises((TypeError, UnknownNameError), match=next(iter(wrong))):
            thing.revolute("j", body, (0, 0, 1), **wrong)
    hinge = thing.revolute("j", body, (0, 0, 1))
    for wrong, message in [
        ({"inertia": np.eye(3)}, "an inertia and no mass"),
        ({"center": (5, 0, 0), "mass": 1.0}, "a center and no inertia"),
        ({"static": True, "mass": 1.0}, "static: leave out mass"),
        ({"membership": -1}, "membership is -1"),
    ]:
        with pytest.raises(ModelError, match=message):
            thing.body("c", **wrong)
    with pytest.raises(TypeError, match='shape 1 of body "c" is of type str'):
        thing.body("c", [kn.Geometry.sphere(0.1), "box"])
    thing.body("c", kn.Geometry.sphere(0.1))
    for refuse, message in [
        (lambda: thing.motor("m", hinge, dof=-1), "dof is -1"),
        (lambda: thing.position_servo("m", hinge, stiffness=-1.0), "stiffness is -1"),
        (lambda: thing.velocity_servo("m", hinge, damping=-1.0), "damping is -1"),
        (lambda: thing.exclude(body, body), 'both of its bodies are "b"'),
        (lambda: thing.replicate(-1), "count is -1"),
        (lambda: thing.replica(-1), "replica is -1"),
        (lambda: world.body_row(body, -1), "replica is -1"),
        (lambda: kn.Builder("x", worlds=-1), "worlds is -1"),
        (lambda: kn.examples.n_pendula(-1), "example n_pendula: links is -1"),
        (lambda: kn.Shape(kn.Geometry.sphere(0.1), collides_with=2**32), "collides_with is 4294967296"),
    ]:
        with pytest.raises(ModelError, match=message):
            refuse()
    for k, two in enumerate([(-1, 1), [-1, 1], np.array([-1.0, 1.0])]):
        thing.motor(f"motor {k}", hinge, control_range=two, force_range=two)
    model = world.build()
    assert (model.joint_names, model.body_names) == (["j", "c_free"], ["b", "c"])
    assert model.control_range.tolist() == [[-1.0, 1.0]] * 3


def test_sizes_that_are_no_numbers_are_told_as_such():
    world = kn.Builder("fog")
    world.object("fog").body("fog", kn.Geometry.sphere(np.nan))
    with pytest.raises(ModelError, match=r"radius .* is NaN"):
        world.build()


def test_handles_of_other_builders_are_refused():
    theirs = kn.Builder("theirs").object("o")
    body = theirs.body("b", kn.Geometry.sphere(0.1))
    joint = theirs.revolute("j", body, (0, 0, 1))
    world = kn.Builder("mine")
    mine = world.object("o")
    own = mine.body("b", kn.Geometry.sphere(0.1))
    hinge = mine.revolute("j", own, (0, 0, 1))
    for refuse in [
        lambda: mine.ball("k", body),
        lambda: mine.ball("k", own, parent=body),
        lambda: mine.motor("m", joint),
        lambda: mine.couple("c", hinge, joint),
        lambda: mine.exclude(own, body),
        lambda: world.body_row(body),
        lambda: world.joint_row(joint),
    ]:
        with pytest.raises(ModelError, match="of this builder has this handle"):
            refuse()
    assert own != body and len({own, body, mine.bodies[0]}) == 2
    assert world.build().joint_names == ["j"]


def test_builders_can_be_set_and_copied():
    world = kn.Builder("one")
    world.up_axis = "z"
    assert (world.up_axis, world.gravity) == ("z", (0, 0, -9.81))
    world.gravity = np.array([0, 0, -1.62])
    world.time_step, world.worlds = 0.01, 8
    with pytest.raises(UnknownNameError, match="there are y, z"):
        world.up_axis = "x"
    arm = world.object("arm")
    link = arm.body("link", kn.Geometry.sphere(0.1))

    other, other_arm, other_link = copy.deepcopy((world, arm, link))
    other_arm.revolute("hinge", other_link, (0, 0, 1))
    assert [o.name for o in copy.copy(other).objects] == ["arm"] and other.objects[0].bodies == [link]
    assert (world.build().joint_names, other.build().joint_names) == (["link_free"], ["hinge"])
    model = other.build()
    assert (model.up_axis, model.time_step, model.worlds) == ("z", 0.01, 8)
    assert model.parameter("gravity").ravel().tolist() == [0, 0, -1.62]
    assert repr(other) == '<Builder "one": 1 objects, 1 bodies, 1 joints>'
    assert repr(other_arm) == '<Object "arm": 1 bodies, 1 joints, 1 replicas>'
    assert (repr(link), repr(other_arm.joints)) == ('<Body "link">', '[<Joint "hinge">]')


def changed_and_made_so():
    """A crane that is changed after it was made, and one that was made like that."""
    ball, box = kn.Geometry.sphere(0.1), kn.Geometry.box((0.1, 0.2, 0.3))
    axes = [kn.Axis.linear((1, 0, 0)), kn.Axis.angular((0, 0, 1))]
    first, last = kn.Builder("crane"), kn.Builder("crane")
    crane = first.object("crane")
    foot = crane.body("foot", ball, position=(1, 0, 0))
    load = crane.body("load", ball, mass=2.0, orientation=(0, 0, 1, 0), membership=4)
    hook = crane.body("hook", ball)
    slide = crane.d6("slide", load, axes, damping=0.5, limit=(-1, 1), position=(0, 1, 0))
    hinge = crane.revolute("hinge", hook, (0, 0, 1), parent=load, parent_frame=((0, -1, 0), (0, 0, 0, 1)))
    first.change_body(foot, static=True, world=-1)
    first.change_body(load, [box], position=(0, 1, 2), collides_with=8, group=3)
    first.change_body(hook, mass=3.0, inertia=np.eye(3), center=(0, 0, 1))
    first.change_joint(slide, parent=foot, dofs=[kn.Dof("along", damping=1.5), kn.Dof()], orientation=(0, 1, 0, 0))
    first.change_joint(slide, armature=0.25, initial=(0.5, 0.25), linear_compliance=1e-6, enabled=False)
    first.change_joint(hinge, child_frame=((0, 1, 0), (0, 0, 0, 1)), stiffness=4.0, drive=kn.Drive(1.0), limit=(0, 2))
    first.change_joint(hinge, rest=0.5, angular_compliance=1e-5, bodies_collide=True)

    crane = last.object("crane")
    foot = crane.body("foot", ball, position=(1, 0, 0), static=True, world=-1)
    load = crane.body(
        "load", [ball, box], mass=2.0, position=(0, 1, 2), orientation=(0, 0, 1, 0), membership=4, collides_with=8,
        group=3,
    )  # fmt: skip
    hook = crane.body("hook", ball, mass=3.0, inertia=np.eye(3), center=(0, 0, 1))
    crane.d6(
        "slide", load, axes, parent=foot, position=(0, 1, 0), orientation=(0, 1, 0, 0), limit=(-1, 1), armature=0.25,
        dofs=[kn.Dof("along", damping=1.5), kn.Dof(damping=0.5)], initial=(0.5, 0.25), linear_compliance=1e-6,
        enabled=False,
    )  # fmt: skip
    crane.revolute(
        "hinge", hook, (0, 0, 1), parent=load, parent_frame=((0, -1, 0), (0, 0, 0, 1)), limit=(0, 2), stiffness=4.0,
        child_frame=((0, 1, 0), (0, 0, 0, 1)), rest=0.5, drive=kn.Drive(1.0), angular_compliance=1e-5,
        bodies_collide=True,
    )  # fmt: skip
    return first, last


def test_axes_may_be_of_any_length():
    def build(length):
        world = kn.Builder("axes")
        thing = world.object("thing")
        axis = length * np.array([1.0, 1.0, 0.0])
        parent = None
        for k, joint in enumerate(("revolute", "prismatic", "d6")):
            axes = [kn.Axis.angular(axis), kn.Axis.linear(axis)] if joint == "d6" else axis
            body = thing.body(f"b{k}", kn.Geometry.sphere(0.1))
            getattr(thing, joint)(f"j{k}", body, axes, parent=parent)
            parent = body
        return world.build()

    unit = build(np.sqrt(0.5))
    for length in (1.0, 7e-5, 3e8):
        assert kn.Dynamics(build(length)).mass_matrix(np.zeros(4)) == pytest.approx(
            kn.Dynamics(unit).mass_matrix(np.zeros(4))
        )
    assert kn.Axis.linear((0, 4, 3)).direction == pytest.approx((0, 0.8, 0.6))
    for nowhere in (0.0, np.nan):
        with pytest.raises(ModelError, match="axis direction"):
            build(nowhere)


def test_a_limit_is_taken_away():
    world = kn.Builder("free")
    thing = world.object("thing")
    hinge = thing.revolute("hinge", thing.body("b", kn.Geometry.sphere(0.1)), (0, 0, 1), limit=(-1, 1), damping=0.5)
    world.change_joint(hinge, damping=None, armature=0.1)
    assert world.build().dof_range.tolist() == [[-1, 1]]
    world.change_joint(hinge, limit=None)
    assert world.build().dof_range.tolist() == [[-np.inf, np.inf]]
    assert world.build().parameter("damping").tolist() == [[0.5]]
    world.change_joint(hinge, limit=None, dofs=[kn.Dof(limit=(0, 2))])
    assert world.build().dof_range.tolist() == [[0, 2]]


def hinged(**options):
    world = kn.Builder("door", gravity=(0, 0, 0))
    thing = world.object("door")
    hinge = thing.revolute("hinge", thing.body("leaf", kn.Geometry.box((0.1,) * 3), mass=1.0), (0, 0, 1), **options)
    return world, thing, hinge


@pytest.mark.parametrize("solver", ["featherstone", "xpbd", "impulse"])
@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_an_infinite_end_of_a_limit_is_none(solver, dtype):
    for limit, way in ((0, np.inf), 1), ((-np.inf, 0), -1):
        model = hinged(limit=limit)[0].build()
        assert model.dof_range.tolist() == [list(limit)]
        sim = kn.Simulation(model, worlds=2, dt=0.002, solver=solver, dtype=dtype)
        sim.set_state([[0.1], [-0.1]], [[1.0], [-1.0]])
        assert not sim.step(500).size
        free, stopped = (0, 1) if way > 0 else (1, 0)
        assert sim.state.joint_position[free, 0] == pytest.approx(1.1 * way, abs=1e-3)
        assert way * sim.state.joint_position[stopped, 0] > -0.1


def test_ranges_with_infinite_ends():
    world, thing, hinge = hinged(limit=kn.Limit(-np.inf, 2, stiffness=5))
    thing.motor("motor", hinge, control_range=(0, np.inf), force_range=(-np.inf, 3))
    thing.motor("free", hinge, control_range=(-np.inf, np.inf))
    model = world.build()
    assert model.dof_range.tolist() == [[-np.inf, 2]]
    assert model.control_range.tolist() == [[0, np.inf], [-np.inf, np.inf]]
    sim = kn.Simulation(model, dt=0.002)
    sim.controls.actuator[:] = 1, 0
    sim.step()
    assert sim.state.joint_velocity[0, 0] > 0
    world.change_joint(hinge, dofs=[kn.Dof(limit=(-np.inf, np.inf))])
    plain, thing, hinge = hinged()
    thing.motor("motor", hinge, control_range=(0, np.inf), force_range=(-np.inf, 3))
    thing.motor("free", hinge)
    assert world.build() == plain.build()
    for limit in (np.inf, np.inf), (np.nan, 1):
        with pytest.raises(ModelError, match=r"limit is (inf|NaN); give a finite number"):
            hinged(limit=limit)[0].build()


@pytest.mark.parametrize("solver", ["featherstone", "xpbd", "impulse"])
def test_drives_of_hinges_without_end_go_the_shorter_way_round(solver):
    def after(**options):
        sim = kn.Simulation(hinged(drive=kn.Drive(10, 2), **options)[0].build(), dt=0.002, solver=solver)
        sim.controls.target_position = 4.0
        sim.step(3000)
        return sim.state.joint_position[0, 0]

    assert after() == pytest.approx(4 - 2 * np.pi, abs=1e-3)
    for limit in (-10, 10), (-10, np.inf):
        assert after(limit=limit) == pytest.approx(4, abs=1e-3)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: kn.Material(-1.0), "material: friction is -1; it must not be negative"),
        (lambda: kn.Material(static_friction=-1.0), "material: static friction is -1"),
        (lambda: kn.Material(rolling_friction=-1.0), "material: rolling friction .* is -1"),
        (lambda: kn.Material(restitution=-0.1), "material: restitution is -0.1"),
        (lambda: kn.Limit(1, -1), "limit: the lower end of its range, 1, is above the upper end, -1"),
        (lambda: kn.Limit(-1, 1, stiffness=-2), "limit: stiffness is -2"),
        (lambda: kn.Drive(-1.0), "drive: stiffness is -1"),
        (lambda: kn.Drive(effort_limit=-1.0), "drive: effort limit is -1"),
        (
            lambda: kn.Shape(kn.Geometry.sphere(1), name="s", orientation=[0] * 4),
            'shape "s": orientation has length zero',
        ),
    ],
)
def test_parts_that_make_no_sense_are_refused_when_they_are_made(make, message):
    with pytest.raises(ModelError, match=message):
        make()


def an_object():
    thing = kn.Builder("bad").object("thing")
    return thing, thing.body("b", kn.Geometry.sphere(0.1))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: kn.Geometry.box((1, 2)), r"box: half is \(1, 2\): give 3 numbers"),
        (
            lambda: kn.Geometry.ellipsoid(np.eye(2)),
            r"ellipsoid: half is an array of the shape \(2, 2\) .*: give 3 numbers",
        ),
        (lambda: kn.Geometry.hull([(0, 0)]), r"hull: points is \[\(0, 0\)\]: give rows of 3 numbers"),
        (lambda: kn.Geometry.mesh(np.eye(2), [[0, 1, 2]]), r"mesh: vertices is an array of the shape \(2, 2\)"),
        (lambda: kn.Geometry.mesh(np.eye(3), [[0, 1.5, 2]]), "mesh: triangles is .*: give rows of 3 whole numbers"),
        (lambda: kn.Geometry.mesh(np.eye(3), [[0, 1, 2**70]]), "mesh: triangles is .*: give rows of 3 whole numbers"),
        (lambda: kn.Geometry.revolution([(1, 0, 0)]), "revolution: profile is .*: give rows of 2 numbers"),
        (
            lambda: kn.Geometry.height_field(np.zeros((3, 3, 3)), (1, 1)),
            r"heights is .* the shape \(along z, along x\)",
        ),
        (lambda: kn.Geometry.height_field(np.zeros((3, 3)), 1.0), r"spacing is 1\.0: give 2 numbers"),
        (lambda: kn.Shape(kn.Geometry.sphere(1), name="s", position=(1, 0)), r'shape "s": position is \(1, 0\)'),
        (lambda: kn.Shape(kn.Geometry.sphere(1), orientation="up"), 'shape "": orientation is .up.: give 4 numbers'),
        (lambda: kn.Shape(kn.Geometry.sphere(1), color=(1, 0, 0)), r"color is \(1, 0, 0\): give 4 numbers"),
        (lambda: kn.Builder("w", gravity=(0, 1)), r'builder "w": gravity is \(0, 1\): give 3 numbers'),
        (lambda: setattr(kn.Builder("w"), "gravity", 9.81), r'builder "w": gravity is 9\.81: give 3 numbers'),
        (lambda: kn.Axis.linear((1, 0)), r"axis: direction is \(1, 0\)"),
        (lambda: kn.Axis.angular((1, 0, 0), anchor=(1,)), r"axis: anchor is \(1,\)"),
        (
            lambda: an_object()[0].body("c", inertia=[1, 2, 3]),
            'body "c": option inertia is .*: give 3 rows of 3 numbers',
        ),
        (lambda: an_object()[0].replicas().translate_by([1] * 100), "placement: shift is .*…: give 3 numbers"),
        (lambda: an_object()[0].replicas().rotate_around_to((0, 0, 0), (0, 1), 1.0), "placement: axis"),
        (lambda: (t := an_object())[0].revolute("j", t[1], (0, 1)), r'joint "j": axis is \(0, 1\): give 3 numbers'),
        (
            lambda: (t := an_object())[0].ball("j", t[1], child_frame=(0, 0, 0)),
            "child_frame is .* position and a quat",
        ),
        (lambda: (t := an_object())[0].ball("j", t[1], child_frame=((0, 0), [0] * 4)), "child_frame: position is"),
    ],
)
def test_what_has_not_so_many_numbers_is_told(make, message):
    with pytest.raises(ShapeError, match=message) as told:
        make()
    assert isinstance(told.value, ValueError) and isinstance(told.value, kn.KinetariumError)


def test_ranges_and_triangles_that_make_no_sense_are_told():
    with pytest.raises(ModelError, match=r"triangle 1 of the mesh is \[0, 1, -1\]: .* counted from 0"):
        kn.Geometry.mesh(np.eye(3), [[0, 1, 2], [0, 1, -1]])
    thing, body = an_object()
    hinge = thing.revolute("j", body, [0, 0, 1])
    with pytest.raises(ShapeError, match=r'actuator "m": control_range is \(1, 2, 3\): give 2 numbers'):
        thing.motor("m", hinge, control_range=(1, 2, 3))
    with pytest.raises(ShapeError, match=r'actuator "m": force_range is 5: give 2 numbers'):
        thing.position_servo("m", hinge, stiffness=1.0, force_range=5)


def test_axes_of_fields_are_as_documented():
    heights = np.zeros((21, 11))
    heights[20, 0] = 1.0  # of most z and least x
    field = kn.Geometry.height_field(heights, (0.5, 0.25))
    assert field.half_extents == pytest.approx((2.5, 0.5, 2.5))
    assert field.vertices[field.vertices[:, 1].argmax()] == pytest.approx((-2.5, 1.0, 2.5))


def test_bodies_of_other_worlds_do_not_touch():
    def builder(number):
        world = kn.Builder("apart")
        things = world.object("things")
        for k, own in enumerate([0, number]):
            things.body(f"ball{k}", kn.Geometry.sphere(0.1), position=(0.15 * k, 0, 0), mass=1.0, world=own)
        return world

    for number, touching in [(0, True), (1, False), (-1, True)]:
        sim = kn.Simulation(builder(number).build(), worlds=2, solver="featherstone")
        sim.step()
        assert [len(sim.contacts(world)) > 0 for world in (0, 1)] == [touching] * 2
        assert sim.state.body_position.shape == (2, 2, 3)
    with pytest.raises(ModelError, match=r'body "ball1": world is -2; it must lie from -1'):
        builder(-2).build()


INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
ARM = """
<robot name="arm">
  <link name="base">INERTIAL</link>
  <link name="arm">INERTIAL</link>
  <link name="hand">INERTIAL</link>
  <link name="thumb">INERTIAL</link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="50" velocity="9"/>
  </joint>
  <joint name="wrist" type="continuous"><parent link="arm"/><child link="hand"/><axis xyz="0 0 1"/></joint>
  <joint name="tip" type="TIP"><parent link="hand"/><child link="thumb"/><axis xyz="0 0 1"/>MIMIC</joint>
</robot>
""".replace("INERTIAL", INERTIAL)
FIXED = ARM.replace("TIP", "fixed").replace("MIMIC", "")
MIMIC = ARM.replace("TIP", "continuous").replace("MIMIC", '<mimic joint="wrist"/>')


def test_joints_of_a_file_are_given_drives():
    model = kn.parse(FIXED)
    before = pickle.dumps(model)
    driven = model.with_drives(kn.Drive(100.0, 30.0))
    assert pickle.dumps(model) == before and driven.warnings == model.warnings
    assert driven.parameter("drive_stiffness").ravel().tolist() == [100.0, 100.0]
    assert driven.parameter("effort_limit").ravel().tolist() == [50.0, np.inf]
    sim = kn.Simulation(driven, worlds=2, dt=0.002, dtype="float64")
    sim.controls.target_position[:] = [[1.0, -0.5], [0.0, 0.3]]
    sim.step(3000)
    assert sim.state.joint_position == pytest.approx(np.array([[1.0, -0.5], [0.0, 0.3]]), abs=1e-3)
    sim.parameters.drive_stiffness[1] = 50.0
    own = model.with_drives(kn.Drive(10.0, effort_limit=7.0), ["shoulder"])
    assert own.parameter("drive_stiffness").ravel().tolist() == [10.0, 0.0]
    assert own.parameter("effort_limit")[0] == 7.0
    without = own.with_drives(kn.Drive(), ["shoulder"])
    assert without.parameter("drive_stiffness").ravel().tolist() == [0.0, 0.0]


def test_joints_that_follow_or_float_are_given_no_drives():
    mimic = kn.parse(MIMIC, floating_base=True)
    stiffness = mimic.with_drives(kn.Drive(5.0)).parameter("drive_stiffness").ravel()
    driven = [name for name, k in zip(mimic.dof_names, stiffness, strict=True) if k]
    assert driven == ["shoulder", "wrist"]
    floating = mimic.joint_names[mimic.joint_kinds.index("free")]
    for joints, error, message in [
        (["sholder"], UnknownNameError, "shoulder"),
        ([floating], ModelError, "free"),
    ]:
        with pytest.raises(error, match=message):
            mimic.with_drives(kn.Drive(5.0), joints)
    with pytest.raises(ModelError, match='joint "tip": it has no degree of freedom'):
        kn.parse(FIXED).with_drives(kn.Drive(5.0), ["tip"])
    with pytest.raises(ModelError, match="has actuators: name the joints"):
        kn.parse(HOPPER).with_drives(kn.Drive(5.0))
    named = kn.parse(HOPPER).with_drives(kn.Drive(5.0), ["hip"])
    assert named.parameter("drive_stiffness").tolist() == [[5.0]]


def test_a_quaternion_of_zeros_is_told():
    thing = kn.Builder("turned").object("thing")
    zeros = (0, 0, 0, 0)
    with pytest.raises(ModelError, match='body "b": orientation has length zero'):
        thing.body("b", kn.Geometry.sphere(0.1), orientation=zeros)
    body = thing.body("b", kn.Geometry.sphere(0.1))
    for wrong in ({"orientation": zeros}, {"child_frame": ((0, 0, 0), zeros)}):
        with pytest.raises(ModelError, match='joint "j": orientation has length zero'):
            thing.ball("j", body, **wrong)
    assert thing.joints == []


def test_what_was_made_can_be_changed():
    changed, made_so = (builder.build() for builder in changed_and_made_so())
    assert pickle.dumps(changed) == pickle.dumps(made_so)


def test_changes_that_make_no_sense_are_refused():
    world = kn.Builder("world")
    thing = world.object("thing")
    rock, ball = thing.body("rock", kn.Geometry.sphere(0.1), static=True), thing.body("ball", kn.Geometry.sphere(0.1))
    joint = thing.revolute("j", ball, (0, 0, 1))
    before = pickle.dumps(world.build())
    theirs = kn.Builder("theirs").object("o").body("b")
    for change, message in [
        (lambda: world.change_body(rock, static=False), 'body "rock": it is static, and stays so'),
        (lambda: world.change_body(rock, mass=1.0), 'body "rock": it is static: leave out mass'),
        (lambda: world.change_body(ball, center=(0, 1, 0)), "a center and no inertia"),
        (lambda: world.change_body(ball, ["box"], mass=1.0), 'shape 0 of body "ball" is of type str'),
        (
            lambda: world.change_body(ball, position=(0, 1)),
            r'body "ball": option position is \(0, 1\): give 3 numbers',
        ),
        (lambda: world.change_body(ball, membership=-1), "membership is -1"),
        (lambda: world.change_body(ball, weight=1.0), 'no option of bodies "weight"; there are position'),
        (lambda: world.change_joint(joint, damping=1.0, rest=0.5), "a rest and no stiffness"),
        (lambda: world.change_joint(joint, dofs=[]), 'joint "j": its list of degrees of freedom'),
        (lambda: world.change_joint(joint, parent=theirs, damping=1.0), 'joint "j": no parent body of this builder'),
        (lambda: world.change_body(theirs), 'body "b": no body of this builder has this handle'),
    ]:
        with pytest.raises((ModelError, ShapeError, TypeError, UnknownNameError), match=message):
            change()
    assert pickle.dumps(world.build()) == before


def test_distance_fields_and_hulls():
    x, y, z = (np.arange(n) - (n - 1) / 2 for n in (21, 25, 31))
    distances = np.sqrt((x[:, None, None] * 0.1) ** 2 + (y[:, None] * 0.1) ** 2 + (z * 0.1) ** 2) - 0.8
    distances[:, :, 16:] = np.maximum(distances[:, :, 16:], z[16:] * 0.1 - 0.3)  # a ball with a flat cap
    ball = kn.Geometry.distance_field(distances.astype(np.float32), 0.1)
    low, high = ball.vertices.min(axis=0), ball.vertices.max(axis=0)
    assert np.allclose(low, -0.8, atol=1e-6) and np.allclose(high, (0.8, 0.8, 0.3), atol=1e-2)
    assert ball.triangles.max() < len(ball.vertices)
    hull = ball.convex_hull()
    assert (ball.kind, hull.kind) == ("mesh", "hull") and hull.convex_hull() == hull
    assert np.allclose((hull.vertices.min(axis=0), hull.vertices.max(axis=0)), (low, high))
    assert np.allclose(ball.half_extents, (0.8, 0.8, 0.55), atol=1e-2)
    assert np.allclose(ball.center, (0, 0, -0.25), atol=1e-2)
    with pytest.raises(ShapeError, match=r"shape \[5, 5\]; give an array of three axes"):
        kn.Geometry.distance_field(np.zeros((5, 5)), 0.1)
    with pytest.raises(ModelError, match="both sides"):
        kn.Geometry.distance_field(np.ones((3, 3, 3)), 0.1)
    with pytest.raises(ModelError, match="spacing is 0"):
        kn.Geometry.distance_field(distances, 0.0)
    with pytest.raises(ModelError, match="a sphere has no vertices"):
        kn.Geometry.sphere(1.0).convex_hull()


def test_what_was_given_can_be_read():
    steel = kn.Material(0.3, margin=0.01, softness=kn.Softness.spring(1e5, 1e2), combine="minimum")
    shape = kn.Shape(
        kn.Geometry.box((1, 2, 3)), name="crate", position=(0, 1, 0), material=steel, color=(1, 0, 0, 0.5)
    )
    assert (shape.name, shape.position, shape.orientation) == ("crate", (0, 1, 0), (0, 0, 0, 1))
    assert shape.material == steel and shape.color == (1, 0, 0, 0.5) and shape.membership == 1
    assert (steel.friction, steel.static_friction, steel.margin, steel.combine) == (0.3, None, 0.01, "minimum")
    sticky = kn.Material(0.3, static_friction=0.5)
    assert sticky.static_friction == 0.5 and "static_friction=0.5" in repr(sticky)
    assert pickle.loads(pickle.dumps(sticky)) == sticky != kn.Material(0.3)
    assert shape.geometry.half_extents == (1, 2, 3) and shape.geometry.vertices.shape == (0, 3)
    assert kn.Geometry.plane().half_extents is None
    limit, drive = kn.Limit(-1, 2, damping=3), kn.Drive(4, effort_limit=5)
    assert (limit.lower, limit.upper, limit.stiffness, limit.damping) == (-1, 2, 1e4, 3)
    assert (drive.stiffness, drive.damping, drive.effort_limit) == (4, 0, 5)
    axis = kn.Axis.linear((0, 1, 0), reference=0.5)
    assert (axis.kind, axis.direction, axis.anchor, axis.reference) == ("linear", (0, 1, 0), (0, 0, 0), 0.5)
    dof = kn.Dof("x", limit=limit)
    assert (dof.name, dof.limit, dof.drive, dof.damping) == ("x", limit, None, None)
    names = {"Geometry": kn.Geometry, "Limit": kn.Limit, "Material": kn.Material, "Softness": kn.Softness}
    names |= {"Axis": kn.Axis, "Dof": kn.Dof, "Drive": kn.Drive, "inf": np.inf}
    light = kn.Softness.time(0.02, impedance=0.9, mass=2.0)
    geometries = shape.geometry, kn.Geometry.capsule(0.1, 0.5)
    for made in [steel, steel.softness, light, *geometries, limit, drive, axis, dof]:
        assert eval(repr(made), names) == made
        assert copy.deepcopy(made) == copy.copy(made) == pickle.loads(pickle.dumps(made)) == made
    assert pickle.loads(pickle.dumps({"crate": shape}))["crate"] == copy.deepcopy(shape) == shape
    with pytest.raises(ModelError, match="nothing of this release"):
        kn.Limit._from_bytes(b"")


def test_unknown_names_suggest():
    model = kn.examples.n_pendula(3)
    for look_up, name in [
        (model.body, "lnk1"),
        (model.joint, "hing1"),
        (model.dof, "hinge"),
        (model.keyframe, "x"),
    ]:
        with pytest.raises(UnknownNameError, match="no "):
            look_up(name)


@pytest.mark.parametrize("solver", ["featherstone", "xpbd", "impulse"])
def test_the_friction_of_a_pair_wins_over_that_of_materials(solver):
    world = kn.Builder("blocks")
    floor = world.object("floor").scenery(kn.Geometry.plane())
    blocks = world.object("blocks")
    block = kn.Geometry.box((0.2, 0.1, 0.2))
    first, second = (blocks.body(name, block, position=(0, 0.1, z)) for name, z in (("first", 0), ("second", 1)))
    world.contact_pair(first.shape(), floor, friction=0.05)
    sim = kn.Simulation(world.build(), solver=solver, dt=0.002)
    sim.state.joint_velocity[0, [0, 6]] = 1.0
    sim.step(250)
    slid, stopped = sim.state.body_position[0, [world.body_row(first), world.body_row(second)], 0]
    # v t - mu g t^2 / 2, and v^2 / 2 mu g, within a few steps at the speed
    assert abs(slid - (0.5 - 0.05 * 9.81 * 0.125)) < 0.01
    assert abs(stopped - 1.0 / (2 * 0.5 * 9.81)) < 0.01


def test_contact_pairs_of_builders():
    world = kn.Builder("pairs")
    room = world.object("room")
    floor, wall = room.scenery(kn.Geometry.plane()), room.scenery(kn.Geometry.rectangle(1.0, 0.5))
    rough = kn.Material(0.8, margin=0.01)
    ball = room.body("ball", [kn.Geometry.sphere(0.1), kn.Shape(kn.Geometry.sphere(0.2), material=rough)])
    world.contact_pair(ball.shape(1), wall, restitution=0.5, softness=kn.Softness.spring(1e4, 10.0))
    world.contact_pair(floor, ball.shape(0), rough, rolling_friction=0.02)
    before = copy.copy(world)
    assert (world.shape_row(ball.shape(1)), world.shape_row(wall)) == (1, 3)
    assert ball.shape() == copy.deepcopy(ball).shape(0) and len({floor, copy.copy(floor), wall}) == 2
    assert repr(wall) == '<ShapeHandle 1 of object "room">'
    assert repr(ball.shape(1)) == '<ShapeHandle 1 of body "ball">'
    theirs = kn.Builder("theirs").object("o").body("b", kn.Geometry.sphere(0.1))
    for refuse, message in [
        (lambda: world.contact_pair(theirs.shape(), floor), "no shape of this builder has this handle"),
        (lambda: world.contact_pair(floor, ball.shape(2)), "no shape of this builder has this handle"),
        (lambda: world.contact_pair(floor, floor), "name two different shapes"),
        (lambda: world.contact_pair(ball.shape(), floor), "contact pairs 1 and 2 are of the same two shapes"),
        (lambda: world.shape_row(theirs.shape()), "of this builder has this handle"),
        (lambda: ball.shape(-1), "shape is -1"),
    ]:
        with pytest.raises(ModelError, match=message):
            refuse()
    assert pickle.dumps(world.build()) == pickle.dumps(before.build())
    world.contact_pair(floor, ball.shape(1), friction=-1.0)
    with pytest.raises(ModelError, match='contact pair "2": friction is -1'):
        world.build()
    assert before.build().body_names == ["ball"]


def test_what_rolls_off_a_rectangle_falls():
    world = kn.Builder("table")
    world.object("table").scenery(kn.Geometry.rectangle(0.5, 0.5))
    world.object("ball").body("ball", kn.Geometry.sphere(0.1), position=(0.2, 0.1, 0.0))
    sim = kn.Simulation(world.build(), dt=0.002)
    sim.step(100)
    assert abs(sim.state.body_position[0, "ball", 1] - 0.1) < 1e-3
    sim.state.joint_velocity[0, 0] = 2.0
    sim.step(400)
    assert sim.state.body_position[0, "ball", 1] < -1.0
    for size in (0.0, -1.0, np.nan):
        with pytest.raises(ModelError, match="the rectangle's half sizes"):
            kn.Geometry.rectangle(1.0, size)


def test_meshes_in_pieces():
    cube = "".join(f"v {x} {y} {z}\n" for z in (0, 2) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    cube += "v 0 0 1\nf 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 9\nf 6 7 9\nf 7 8 9\nf 8 5 9\n"
    text = """<mujoco><asset><mesh name="cube" file="cube.obj" scale=".1 .1 .1"/></asset><worldbody><body>
        <freejoint/><geom name="solid" type="mesh" mesh="cube"/></body></worldbody></mujoco>"""
    whole, apart = (kn.parse(text, files={"cube.obj": cube}, meshes=meshes) for meshes in ("exact", "pieces"))
    assert whole.shape_names == ["solid"]
    assert apart.shape_names[:2] == ["solid", "solid_1"]
    assert whole.parameter("body_mass").tolist() == apart.parameter("body_mass").tolist()
