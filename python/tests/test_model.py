"""Models from files and builders."""

import numpy as np
import pytest

import kinetarium as kn
from kinetarium.errors import FileError, ModelError, UnknownNameError

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
    with pytest.raises(FileError, match="known are named, exact, hull"):
        kn.parse(HOPPER, meshes="some")


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
    with pytest.raises(UnknownNameError, match='no option "dampening"; known are parent'):
        thing.revolute("j", body, (0, 0, 1), dampening=1.0)
    with pytest.raises(ModelError, match="not both"):
        thing.ball("j", body, position=(0, 0, 0), child_frame=((0, 0, 0), (0, 0, 0, 1)))
    with pytest.raises(ModelError, match="inertia and no mass"):
        thing.body("c", inertia=np.eye(3))
    with pytest.raises(ModelError, match="4 points"):
        kn.Geometry.hull([(0, 0, 0), (1, 0, 0)])
    with pytest.raises(ModelError, match="unknown axis"):
        kn.Builder("x", up_axis="x")
    with pytest.raises(TypeError):
        thing.body("d", shapes=["box"])
    other = kn.Builder("other").object("o").body("b")
    lonely = kn.Builder("lonely")
    lonely.object("a")
    with pytest.raises(ModelError):
        lonely.body_row(other, 4)


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
