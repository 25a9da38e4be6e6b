"""Simulations as arrays: what goes in comes out, and is the same as in Rust."""

import copy
import gc
import os
import pickle
import subprocess
import sys
import threading
import weakref

import numpy as np
import pytest

import kinetarium as kn
from kinetarium.errors import (
    BusyError,
    ClosedError,
    ForkedError,
    ModelError,
    OutOfRangeError,
    ShapeError,
    SimulationError,
    UnknownNameError,
)


@pytest.fixture(params=["float32", "float64"])
def sim(request):
    return kn.Simulation(kn.examples.n_pendula(3), worlds=20, dt=0.002, dtype=request.param)


def test_a_pendulum_falls_as_the_closed_form_says():
    # A rod of half length l on a hinge, from rest at angle 0: θ'' = −(3 g / 4 l) cos θ along the arc, so that the
    # energy ½ I θ'² = m g l (1 − cos θ)-like sums stay: total energy is constant to the order of the step.
    sim = kn.Simulation(kn.examples.n_pendula(1), dt=1e-4, dtype="float64")
    energy = sim.state.kinetic_energy + sim.state.potential_energy
    sim.step(5000)
    now = sim.state.kinetic_energy + sim.state.potential_energy
    assert sim.state.kinetic_energy[0] > 0.1
    assert np.abs(now - energy).max() < 1e-3 * sim.state.kinetic_energy[0]


def test_shapes_and_dtypes(sim):
    model = sim.model
    shapes = {
        "joint_position": (20, 3),
        "joint_velocity": (20, 3),
        "joint_acceleration": (20, 3),
        "body_position": (20, 3, 3),
        "body_orientation": (20, 3, 4),
        "body_velocity": (20, 3, 3),
        "body_angular_velocity": (20, 3, 3),
        "reaction_force": (20, len(model.joint_names), 3),
        "reaction_torque": (20, len(model.joint_names), 3),
        "kinetic_energy": (20,),
        "potential_energy": (20,),
        "momentum": (20, 3),
        "angular_momentum": (20, 3),
        "capped": (20,),
    }
    sim.step(3)
    for name, shape in shapes.items():
        array = getattr(sim.state, name)
        assert array.shape == shape, name
        assert array.dtype == sim.dtype and array.flags.c_contiguous and np.isfinite(array).all(), name
        out = np.full(shape, np.nan, sim.dtype)
        assert sim.state.read(name, out) is out
        assert (out == array).all(), name


def test_names_index_and_suggest(sim):
    assert (sim.state.body_position[:, "link2"] == sim.state.body_position[:, 2]).all()
    assert (sim.state.joint_position[3, ["hinge2", "hinge0"]] == sim.state.joint_position[3, [2, 0]]).all()
    assert sim.dof("hinge1") == 1
    with pytest.raises(UnknownNameError, match='did you mean "hinge1"'):
        sim.dof("hinge_1")
    with pytest.raises(UnknownNameError, match='"link2"'):
        sim.state.body_position[:, "link2_"]
    with pytest.raises(UnknownNameError, match="axis 2 has no names"):
        sim.state.body_position[0, 0, "x"]


def test_worlds_differ_by_what_they_are_given(sim):
    sim.controls.force[5:, "hinge0"] = 3.0
    sim.step(10)
    v = sim.state.joint_velocity
    assert (v[:5] == v[0]).all() and (v[5:] == v[5]).all() and (v[0] != v[5]).all()
    sim.controls.force = 0.0
    assert not sim.controls.force.any()
    sim.controls.force += 1.0
    assert (sim.controls.force == 1.0).all()
    sim.reset(np.arange(20) < 7)
    assert (sim.controls.force[:7] == 0).all() and (sim.controls.force[7:] == 1).all()
    assert (sim.time[:7] == 0).all() and (sim.time[7:] > 0).all()


def test_items_of_the_state_are_written_through(sim):
    sim.step(4)
    time = sim.time
    q = sim.state.joint_position
    q[2, "hinge1"] = 0.25
    assert sim.state.joint_position[2, 1] == 0.25
    sim.state.joint_velocity[:, 0] = 1.5
    assert (sim.state.joint_velocity[:, 0] == 1.5).all()
    assert (sim.time == time).all()
    with pytest.raises(ShapeError, match="follows from the joints"):
        sim.state.body_position[0] = 1.0


def test_an_item_is_set_in_the_present_and_nothing_else(sim):
    q, v = sim.state.joint_position, sim.state.joint_velocity
    sim.step(30)
    now = sim.snapshot()
    with pytest.raises(SimulationError, match="this joint_position was read before the simulation was stepped"):
        q[0, 0] = 0.1
    assert sim.snapshot() == now and q[0, 0] != 0.1
    assert sim.state.read("joint_position", q) is q
    other = sim.state.joint_position
    other[2, "hinge0"] = 0.5
    q[2, "hinge1"] = 0.25
    after = sim.state.joint_position
    assert after[2, 0] == 0.5 and after[2, 1] == 0.25
    assert (np.delete(after, 2, axis=0) == np.delete(other, 2, axis=0)).all()
    assert (sim.state.joint_velocity != v).any(axis=1).all()
    sim.reset([3])
    with pytest.raises(SimulationError, match="or reset"):
        after[0, 0] = 0.1


def test_a_refused_item_is_not_kept(sim):
    q = sim.state.joint_position
    with pytest.raises(SimulationError, match="world 1"):
        q[1, 0] = np.nan
    q[1, 1] = 0.5
    assert (sim.state.joint_position == q).all()
    mass = sim.parameters.body_mass
    with pytest.raises(ModelError, match="world 4"):
        mass[2:5, "link1"] = (5.0, 2.0, -1.0)
    mass[2, "link0"] = 3.0
    assert (sim.parameters.body_mass == mass).all() and mass[2].tolist() == [3.0, 1.0, 1.0]


def test_what_would_be_set_in_vain_is_refused(sim):
    for array in (sim.state.joint_position, sim.state.body_position, sim.parameters.gravity):
        before = np.array(array)
        for write in (
            lambda a: a[0].__setitem__(0, 0.7),
            lambda a: a.fill(1.0),
            lambda a: a.put(0, 1.0),
            lambda a: np.copyto(a, 1.0),
            lambda a: np.add(a, 1.0, out=a),
            lambda a: a.flat.__setitem__(0, 1.0),
            lambda a: np.asarray(a).__setitem__(0, 1.0),
        ):
            with pytest.raises(ValueError, match="read-only"):
                write(array)
        assert (array == before).all()
        own = array.copy()
        own[0] = 7.0
        own += 1.0
        assert (own[0] == 8.0).all() and (array == before).all()
    plain = sim.state.read("joint_position")
    plain[0] = 7.0


def test_what_is_assigned_in_place_arrives(sim):
    sim.state.joint_position[3, "hinge1"] += 0.5
    sim.state.joint_position[:, 2] += np.linspace(0.0, 1.0, 20)
    sim.state.joint_velocity += 2.0
    sim.parameters.gravity[4] *= 0.5
    sim.parameters.body_mass *= 2.0
    assert sim.state.joint_position[3, 1] == 0.5 and sim.state.joint_position[19, 2] == 1.0
    assert (sim.state.joint_velocity == 2.0).all()
    assert sim.parameters.gravity[4, 1] == sim.parameters.gravity[5, 1] / 2
    assert (sim.parameters.body_mass[:, :, None] == 2 * sim.model.parameter("body_mass")).all()
    observed = sim.state.joint_position
    observed -= observed  # numbers of one's own from here on
    assert type(observed) is np.ndarray and not observed.any() and sim.state.joint_position.all(axis=1).any()


def test_a_joint_stands_for_its_columns():
    sim = kn.Simulation(kn.examples.rover(), worlds=3, solver="featherstone")
    sim.controls.force[:, "table_free"] = np.arange(6.0)
    assert (sim.controls.force[1, 6:12] == np.arange(6.0)).all() and sim.controls.force.sum() == 3 * 15.0
    assert (sim.state.joint_position[:, "table_free"] == sim.state.joint_position[:, 6:13]).all()
    columns = sim.state.joint_position[0, ["hinge", "table_free", "neck_1"]]
    assert (columns == sim.state.joint_position[0, [0, 6, 7, 8, 9, 10, 11, 12, 5]]).all()
    assert sim.parameters.damping[:, "wheels"].shape == (3, 3) and sim.parameters.damping[:, "wheels_1"].shape == (3,)
    with pytest.raises(UnknownNameError, match='did you mean "chair_free"'):
        sim.controls.force[:, "char_free"]


def test_accelerations_are_told_by_the_controls_as_they_stand(sim):
    twin = copy.copy(sim)
    rest = sim.state.joint_acceleration
    for s in (sim, twin):
        s.controls.force[1, "hinge0"] = 2.0
    pushed = sim.state.joint_acceleration
    assert pushed[1, "hinge0"] != rest[1, "hinge0"] and (pushed[0] == rest[0]).all()
    assert (sim.state.reaction_force[1] != sim.state.reaction_force[0]).any()
    sim.snapshot()
    assert (sim.state.joint_acceleration == pushed).all()
    table = np.zeros((sim.worlds, 3))
    twin.state.read_columns("joint_acceleration", table)
    assert (table == pushed).all()
    sim.reset()
    assert (sim.state.joint_acceleration == rest).all()
    sim.controls.force[0, 0] = np.nan
    with pytest.raises(SimulationError, match="world 0: force"):
        sim.state.read("joint_acceleration")
    assert np.isfinite(sim.state.joint_position).all()


def test_a_sensor_measures_by_the_controls_of_the_step():
    def measure(sim):
        sim.controls.force[0] += 1.0  # as a thread might that decides meanwhile
        return sim.state.joint_acceleration

    sim = kn.Simulation(kn.examples.n_pendula(2), sensors=kn.sensors.Custom("acceleration", measure))
    one = sim.sensors["acceleration"]
    plain = kn.Simulation(kn.examples.n_pendula(2))
    assert (one == plain.state.joint_acceleration).all()


def test_quaternions_are_set_as_a_whole():
    sim = kn.Simulation(kn.examples.ball_joint(), worlds=2, dtype="float64")
    q = sim.state.joint_position
    for column in range(4):
        q[1, column] = 0.5
    np.testing.assert_allclose(sim.state.joint_position[1], 0.5, atol=1e-15)
    with pytest.raises(SimulationError, match='world 1: the quaternion of joint "shoulder" is zero'):
        q[1] = 0.0


def test_a_simulation_goes_with_the_last_reference():
    sim = kn.Simulation(kn.examples.n_pendula(2), worlds=2, sensors=[kn.sensors.JointPosition("q")])
    sim.controls.force[...] = 1.0
    sim.step()
    kept = sim.state.joint_position, sim.parameters.gravity, sim.controls.force, sim.sensors["q"]
    gone = weakref.ref(sim), weakref.ref(sim._worlds)
    gc.disable()
    try:
        del sim
        assert [one() for one in gone] == [None, None]
    finally:
        gc.enable()
    for array in kept[:2]:
        with pytest.raises(ClosedError, match="is gone"):
            array[0] = 1.0


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked here")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_forked_process_is_told():
    sim = kn.Simulation(kn.examples.n_pendula(2), worlds=512, threads=2)
    sim.step()
    child = os.fork()
    if child == 0:
        told = 0
        for use in (sim.step, sim.snapshot, lambda: sim.state.joint_position, lambda: pickle.dumps(sim)):
            try:
                use()
            except ForkedError:
                told += 1
        sim.close()
        os._exit(told)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 4
    sim.step()


class Robot(kn.Simulation):
    """One of a user's own."""

    def __init__(self, extra=1):
        super().__init__(kn.examples.n_pendula(1))
        self.extra = extra


def test_copies_keep_what_is_a_subclass_s_own_and_what_is_watched():
    robot = Robot(extra=7)
    robot.reward = [1.0]
    robot.watch("divergence")
    robot.controls.force[...] = 1e30
    for twin in (copy.deepcopy(robot), pickle.loads(pickle.dumps(robot))):
        assert type(twin) is Robot and twin.extra == 7 and twin.reward == [1.0]
        twin.step(5)
        assert [event.kind for event in twin.events()] == ["diverged"]


def test_what_tables_are_is_told(sim):
    assert repr(sim.state) == "<State of 'chain_3': 20 worlds, 3 coordinates, 3 degrees of freedom, 3 bodies>"
    assert "force (20, 3)" in repr(sim.controls) and "actuator (20, 0)" in repr(sim.controls)
    assert "body_mass" in repr(sim.parameters)
    assert sim.contacts() != sim.contacts()


def test_a_step_does_not_depend_on_threads_or_worlds():
    model = kn.examples.n_pendula(3)
    few = kn.Simulation(model, worlds=2, threads=1)
    many = kn.Simulation(model, worlds=40, threads=2)
    for sim in (few, many):
        sim.state.joint_velocity[1] = (0.1, 0.2, 0.3)
        sim.step(100)
    assert (few.state.joint_position == many.state.joint_position[:2]).all()


def test_copies_and_pickles_go_on_alike(sim):
    sim.controls.force[:, 1] = np.linspace(0, 1, 20)
    sim.parameters.gravity[3] = (0, -1.6, 0)
    sim.step(20)
    twins = [copy.deepcopy(sim), pickle.loads(pickle.dumps(sim))]
    for one in (sim, *twins):
        one.step(30)
    for twin in twins:
        assert (twin.state.joint_position == sim.state.joint_position).all()
        assert (twin.time == sim.time).all()
        assert (twin.parameters.gravity == sim.parameters.gravity).all()
    assert pickle.loads(pickle.dumps(sim.model)) == sim.model


def drives():
    """Three worlds of two arms, with drives of stiffness 10, 0 and damping 0, 5."""
    world = kn.Builder("drives")
    arms = world.object("arms")
    for k, drive in enumerate([kn.Drive(10.0), kn.Drive(0.0, 5.0)]):
        arm = arms.body(f"arm{k}", kn.Geometry.sphere(0.1), position=(0.5, 0, k))
        arms.revolute(f"hinge{k}", arm, (0, 0, 1), position=(0, 0, k), drive=drive)
    return kn.Simulation(world.build(), worlds=3, solver="featherstone")


def test_copies_keep_parameters_that_depend_on_each_other():
    sim = drives()
    # Neither table alone can be the last.
    sim.parameters.drive_damping[1] = (1.0, 5.0)
    sim.parameters.drive_stiffness[1] = (0.0, 2.0)
    sim.parameters.drive_damping[1] = (1.0, 0.0)
    twins = [copy.copy(sim), copy.deepcopy(sim), pickle.loads(pickle.dumps(sim))]
    for one in (sim, *twins):
        one.step(30)
    for twin in twins:
        for table in ("drive_stiffness", "drive_damping"):
            assert (getattr(twin.parameters, table) == getattr(sim.parameters, table)).all()
        assert (twin.state.joint_position == sim.state.joint_position).all()


def test_save_and_load(sim, tmp_path):
    sim.step(10)
    sim.save(tmp_path / "s.kin")
    sim.step(10)
    later = sim.state.joint_position
    sim.load(tmp_path / "s.kin")
    assert (sim.time == 10 * 0.002).all()
    sim.step(10)
    assert (sim.state.joint_position == later).all()
    for form in (bytearray, memoryview):
        sim.restore(form(sim.snapshot()))
    with pytest.raises(SimulationError, match="cut off"):
        sim.restore(sim.snapshot()[:-10])
    for other in (b"x" * 200, b"abc"):
        with pytest.raises(SimulationError, match=r"no snapshot: .* give the bytes of one, as they were written$"):
            sim.restore(other)


def test_parameters_of_one_world(sim):
    mass = sim.parameters.body_mass
    mass[4, "link1"] = 2 * mass[4, "link1"]
    sim.step(50)
    v = sim.state.joint_velocity
    assert (v[4] != v[0]).any() and (v[5] == v[0]).all()
    sim.parameters.gravity = np.zeros((20, 3))
    assert (sim.parameters.gravity == 0).all()
    with pytest.raises(kn.errors.ModelError, match="mass"):
        sim.parameters.body_mass[3, 0] = -1.0
    assert (sim.parameters.body_mass[3] == sim.model.parameter("body_mass")[:, 0]).all()


def test_parameters_are_given_together(sim):
    mass = np.array([[1.5], [2.5]])
    sim.parameters.update({"body_mass": mass, "gravity": (0.0, -1.62, 0.0)}, worlds=[4, 2])
    assert (sim.parameters.body_mass[[4, 2]] == mass).all()
    assert (sim.parameters.gravity[[4, 2]] == (0, -1.62, 0)).all()
    assert (sim.parameters.gravity[3] == sim.model.parameter("gravity")[0]).all()
    before = sim.parameters.body_mass
    sim.parameters.update({"body_mass": 3.0}, worlds=[])
    for error, tables, message in [
        (UnknownNameError, {"body_mas": 1.0}, 'did you mean "body_mass"'),
        (ShapeError, {"body_mass": np.ones((3, 3))}, r"does not broadcast to \(2, 3\)"),
        (ModelError, {"gravity": 0.0, "body_mass": -1.0}, "mass"),
    ]:
        with pytest.raises(error, match=message):
            sim.parameters.update(tables, worlds=[0, 2])
    assert (sim.parameters.body_mass == before).all() and (sim.parameters.gravity[2] == (0, -1.62, 0)).all()


def test_parameters_that_can_be_had_only_together():
    sim = drives()
    with pytest.raises(SimulationError, match="another structure"):
        sim.parameters.drive_stiffness[1, 0] = 0.0
    sim.parameters.update({"drive_stiffness": (0.0, 2.0), "drive_damping": (1.0, 0.0)}, worlds=[False, True, False])
    assert sim.parameters.drive_stiffness.tolist() == [[10.0, 0.0], [0.0, 2.0], [10.0, 0.0]]
    assert sim.parameters.drive_damping.tolist() == [[0.0, 5.0], [1.0, 0.0], [0.0, 5.0]]


def test_targets_without_a_drive_are_refused(sim):
    for name in ("target_position", "target_velocity"):
        target = getattr(sim.controls, name)
        for key in ((3, "hinge1"), (3, 1), slice(3, None)):
            with pytest.raises(SimulationError, match=rf'world 3: {name} is 0.5 for "hinge\d", .* model.with_drives'):
                target[key] = 0.5
        with pytest.raises(SimulationError, match="has no drive"):
            setattr(sim.controls, name, 0.5)
        assert (target == 0).all()
        with pytest.raises(SimulationError, match="has no drive"):
            target[:, 1] += 1.0
        target[:] = 0.0
    sim.step()


def test_targets_of_drives_beside_joints_without_any_are_set():
    sim = kn.Simulation(kn.examples.n_pendula(3).with_drives(kn.Drive(200.0, 20.0), ["hinge1"]), worlds=4)
    target = sim.controls.target_position
    target[:, "hinge1"] = 0.25
    target[2:, 1] += 0.25
    sim.controls.target_position += [0.0, 0.5, 0.0]
    with pytest.raises(SimulationError, match='for "hinge0"'):
        target[1] = [1.0, 1.0, 0.0]
    with pytest.raises(SimulationError, match='for "hinge2"'):
        sim.controls.target_position = [0.0, 1.0, 1.0]
    assert target[:, 1].tolist() == [0.75, 0.75, 1.0, 1.0] and target.flags.writeable
    assert sim.controls.target_position is target
    sim.step(5)
    assert (sim.state.joint_position[:, "hinge1"] > 0).all()


def test_one_world_or_several_are_asked(balls):
    ball, place = kn.Geometry.sphere(0.2), (0.0, 0.5, 0.0)
    calls = [
        lambda **where: balls.contacts(**where),
        lambda **where: balls.cast_rays((0, 9, 0), (0, -1, 0), **where),
        lambda **where: balls.cast_shape(ball, (0, 9, 0), (0, -1, 0), **where),
        lambda **where: balls.nearest(place, **where),
        lambda **where: balls.closest_points(place, **where),
        lambda **where: balls.overlaps(ball, place, **where),
    ]
    for call in calls:
        one = call(world=1)
        assert np.array_equal(one.distance, call(worlds=1).distance)
        assert np.array_equal(call().distance, call(world=0).distance)
        for worlds in ([2], 0, None):
            with pytest.raises(SimulationError, match=r"both world=1 and worlds=.* are given: leave one out"):
                call(world=1, worlds=worlds)


def test_contacts_rays_and_events():
    sim = kn.Simulation(kn.examples.dominoes(3))
    sim.watch("contacts", "sleep")
    sim.step(100)
    contacts = sim.contacts()
    assert len(contacts) > 0 and contacts.force.shape == (len(contacts), 3)
    weight = 9.81 * sim.model.total_mass
    assert contacts.force[:, 1].sum() == pytest.approx(weight, rel=0.5)
    kinds = {event.kind for event in sim.events()}
    assert "contact_begins" in kinds
    assert sim.events() == []
    hits = sim.cast_rays([[0, 5, 0], [0, 5, 50]], (0, -1, 0))
    assert hits.distance.shape == (2,) and hits.distance[1] == pytest.approx(5.0, abs=1e-6)
    assert hits.body[1] == -1
    missed = sim.cast_rays((0, 5, 0), (0, 1, 0))
    assert missed.shape[0] == missed.body[0] == -1 and np.isinf(missed.distance[0])


@pytest.fixture
def balls():
    """Two balls of 2 kg in four worlds, which hover above a floor, but for world 1, where they lie."""
    world = kn.Builder("balls")
    things = world.object("things")
    things.scenery(kn.Shape(kn.Geometry.plane(), name="floor"))
    for k in range(2):
        shape = kn.Shape(kn.Geometry.sphere(0.5), name="" if k else "ball")
        things.body(f"ball{k}", shape, position=(3 * k, 0.5, 0), mass=2.0)
    sim = kn.Simulation(world.build(), worlds=4, solver="featherstone", dtype="float64")
    sim.state.joint_position[[0, 2, 3], 1::7] += 2.0
    sim.step()
    return sim


def test_contacts_of_many_worlds(balls):
    every, one = balls.contacts(worlds=None), balls.contacts(1)
    assert len(one) == 2 and one.world.tolist() == [1, 1] and len(balls.contacts()) == 0
    some = balls.contacts(worlds=[3, 1, 0])
    for contacts in (every, some):
        for column in ("world", "shapes", "position", "normal", "distance", "force", "torque", "feature"):
            assert (getattr(contacts, column) == getattr(one, column)).all()
    assert len(balls.contacts(worlds=[False] * 4)) == 0
    with pytest.raises(OutOfRangeError, match="world 4"):
        balls.contacts(worlds=[4])


def test_contacts_between_shapes_by_name(balls):
    contacts = balls.contacts(world=1)
    ball, floor = balls.shape("ball"), balls.model.shape("floor")
    assert (ball, floor) == (0, 2)
    assert len(contacts.between("floor", "ball")) == len(contacts.between(ball, floor)) == 1
    assert len(contacts.between("ball", 1)) == 0
    wrench = contacts.wrench("floor", "ball")
    assert wrench.shape == (6,) and wrench[1] > 0
    assert (contacts.wrench("ball", "floor") == -wrench).all() and (contacts.wrench(floor, ball) == wrench).all()
    assert (contacts.wrench("ball", 1) == 0).all()
    of_worlds = balls.contacts(worlds=[3, 1, 1]).wrench("floor", "ball")
    assert (of_worlds == [np.zeros(6), wrench, wrench]).all()
    assert balls.contacts(worlds=[]).wrench("floor", "ball").shape == (0, 6)
    for error, shape, message in [
        (UnknownNameError, "bal", 'no shape named "bal"; did you mean "ball"'),
        (UnknownNameError, "", "no shape"),
        (OutOfRangeError, 99, "shape 99 does not exist: the model has 3"),
        (OutOfRangeError, -1, "shape -1"),
        (TypeError, 1.5, "its name or its row"),
    ]:
        for call in (contacts.wrench, contacts.between):
            with pytest.raises(error, match=message):
                call("floor", shape)


def test_rays_are_cast_in_many_worlds(balls):
    origins, down = [[0, 9, 0], [3, 9, 0], [6, 9, 0]], (0, -2, 0)
    every = balls.cast_rays(origins, down, worlds=None)
    assert every.distance.shape == (4, 3) and every.normal.shape == (4, 3, 3)
    assert (every.shape == [0, 1, 2]).all() and (every.body == [0, 1, -1]).all()
    for world in range(4):
        one = balls.cast_rays(origins, down, world=world)
        for name in ("distance", "shape", "body", "position", "normal"):
            assert (getattr(one, name) == getattr(every, name)[world]).all()
    own = balls.cast_rays(np.array([[[0, 9, 0]], [[6, 9, 0]]]), down, worlds=[2, 1])
    assert own.shape.tolist() == [[0], [2]]
    assert balls.cast_rays(origins, down, worlds=[]).distance.shape == (0, 3)
    with pytest.raises(OutOfRangeError, match="world 4"):
        balls.cast_rays(origins, down, worlds=[4])


def test_diverged_worlds_harm_no_other():
    sim = kn.Simulation(kn.examples.n_pendula(2), worlds=20, speed_limit=50.0)
    sim.controls.force[7] = 1e20
    lost = sim.step(10)
    assert lost.tolist() == [7]
    assert sim.state.diverged.sum() == 1 and np.isfinite(sim.state.joint_position).all()
    sim.controls.force[7] = 0
    sim.reset([7])
    assert sim.step(10).size == 0 and not sim.state.diverged.any()


@pytest.mark.parametrize(
    ("wrong", "error", "message"),
    [
        (
            lambda s: s.controls.force.__setitem__((0, 0), np.nan) or s.step(),
            SimulationError,
            "world 0: force",
        ),
        (lambda s: setattr(s.controls, "force", np.zeros((3, 3))), ShapeError, "does not broadcast"),
        (lambda s: setattr(s.controls, "force", "much"), ShapeError, "real numbers"),
        (lambda s: s.set_state(np.zeros(7)), ShapeError, "joint_position"),
        (lambda s: s.set_state([np.inf, 0, 0]), SimulationError, "finite"),
        (lambda s: s.reset([20]), OutOfRangeError, "world 20 does not exist"),
        (lambda s: s.reset([[0], [1, 2]]), ShapeError, "a mask or a list"),
        (lambda s: s.reset([-1]), OutOfRangeError, "world -1"),
        (lambda s: s.reset(np.zeros(3, bool)), ShapeError, "mask"),
        (lambda s: s.reset([0.5]), ShapeError, "whole numbers"),
        (lambda s: s.step(-1), SimulationError, "negative"),
        (lambda s: s.state.read("joint_positon"), UnknownNameError, 'did you mean "joint_position"'),
        (lambda s: s.state.read("momentum", np.zeros((20, 3), int)), ShapeError, "out is int64"),
        (lambda s: s.state.read("momentum", np.zeros((3, 20), s.dtype).T), ShapeError, "contiguous"),
        (lambda s: s.state.read("momentum", _read_only((20, 3), s.dtype)), ShapeError, "written"),
        (lambda s: s.contacts(99), OutOfRangeError, "world 99"),
        (lambda s: s.cast_rays((0, 0, 0), (0, 0, 0)), SimulationError, "direction"),
        (lambda s: s.controls.on_device("forces"), UnknownNameError, 'did you mean "force"'),
        (lambda s: s.watch("contact"), UnknownNameError, 'did you mean "contacts"'),
        (lambda s: s.watch("everything"), UnknownNameError, "known are contacts"),
        (lambda s: s.linearize(50), OutOfRangeError, "world 50"),
        # Worlds before the one that is refused are left alone, too.
        (lambda s: s.set_state(_with(s, np.nan)), SimulationError, r"world 12: joint position\[1\] is nan"),
        (lambda s: s.set_state(_with(s, 2e9)), SimulationError, r"world 12: joint position\[1\] is 2e\+09"),
        (lambda s: setattr(s.state, "joint_velocity", _with(s, np.inf)), SimulationError, "world 12: joint velocity"),
        (lambda s: s.state.joint_position.__setitem__(..., _with(s, np.nan)), SimulationError, "world 12"),
        (lambda s: setattr(s.parameters, "body_mass", _with(s, -1.0)), ModelError, "world 12"),
        (lambda s: s.reset(keyframe="home"), UnknownNameError, "home"),
        (lambda s: s.cast_rays(np.zeros((2, 5, 3)), (0, 1, 0)), ShapeError, r"it must be \(queries, …\)"),
        (lambda s: s.render(worlds=[]), ShapeError, "at least one"),
        (lambda s: s.framing(width=0), SimulationError, "width is 0"),
        (lambda s: s.step("2"), TypeError, "steps is '2': it must be a whole number"),
        (lambda s: s.step(1.5), TypeError, "whole number"),
        (lambda s: s.restore(5), TypeError, "bytes-like"),
        (lambda s: setattr(s.state, "body_position", 1.0), ShapeError, "follows from the joints"),
        (lambda s: setattr(s.state, "joint_positions", 1.0), AttributeError, 'did you mean "joint_position"'),
        (lambda s: setattr(s.controls, "forces", 1.0), AttributeError, 'did you mean "force"'),
        (lambda s: setattr(s.parameters, "mass", 1.0), AttributeError, 'did you mean "body_mass"'),
        (lambda s: setattr(s, "dtt", 1.0), AttributeError, 'did you mean "dt"'),
        (lambda s: setattr(s, "dt", 1.0), AttributeError, "dt"),
    ],
)
def test_bad_input_is_refused_and_nothing_is_lost(sim, wrong, error, message):
    sim.step(5)
    before, masses = sim.snapshot(), sim.parameters.body_mass
    with pytest.raises(error, match=message):
        wrong(sim)
    sim.controls.force[...] = 0.0
    assert sim.snapshot() == before
    assert (sim.parameters.body_mass == masses).all()


def test_what_was_refused_is_no_change(sim):
    q = sim.state.joint_position
    for refused in (lambda: sim.set_state(np.nan), lambda: sim.step(-1), lambda: sim.reset([99])):
        with pytest.raises((SimulationError, OutOfRangeError)):
            refused()
    q[0, 0] = 0.5
    assert sim.state.joint_position[0, 0] == 0.5


def _with(sim, wrong):
    numbers = np.ones((sim.worlds, 3))
    numbers[12, 1] = wrong
    return numbers


def _read_only(shape, dtype):
    array = np.zeros(shape, dtype)
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"worlds": 0}, "worlds is 0"),
        ({"worlds": -3}, "worlds is -3"),
        ({"worlds": 2**64}, "worlds is 18446744073709551616: it must be below"),
        ({"seed": 2**64}, "seed is 18446744073709551616: it must be below"),
        ({"dt": 0.0}, "time step"),
        ({"dt": np.nan}, "time step"),
        ({"solver": "magic"}, 'no solver "magic"; there are auto'),
        ({"integrator": "verlt"}, 'no integrator "verlt"; did you mean "verlet"'),
        ({"integrator": "verlet", "solver": "xpbd"}, "verlet with the solver xpbd: it must be semi_implicit_euler"),
        ({"contact_passes": 0}, "contact passes is 0"),
        ({"dtype": "int32"}, "float32 or float64"),
        ({"dtype": "flot"}, "dtype is flot: it must be float32 or float64"),
        ({"dtype": None}, "dtype is None: it must be float32 or float64"),
        ({"worlds": 10**9}, "worlds"),
        ({"worlds": "4"}, "worlds is '4': it must be a whole number"),
        ({"worlds": None}, "worlds is None"),
        ({"threads": 1.5}, "threads is 1.5"),
        ({"substeps": -1}, "substeps is -1: it must not be negative"),
        ({"dt": "a"}, "dt is 'a': it must be a number of seconds"),
        ({"dt": [0.1, 0.2]}, r"dt is \[0\.1, 0\.2\]: it must be a number of seconds"),
        ({"seed": -1}, "seed is -1"),
        ({"device": 0}, "device is 0: it must be a text"),
    ],
)
def test_bad_settings(settings, message):
    with pytest.raises((SimulationError, TypeError, UnknownNameError), match=message):
        kn.Simulation(kn.examples.n_pendula(1), **settings)
    with pytest.raises(TypeError, match="give a Model"):
        kn.Simulation("humanoid.xml")


def test_use_after_close(sim):
    sim.controls.force[...] = 1.0
    sim.close()
    sim.close()
    uses = (
        sim.step,
        sim.snapshot,
        lambda: sim.state.joint_position,
        lambda: sim.controls.force,
        lambda: setattr(sim.controls, "force", 1.0),
        lambda: sim.sensors,
        lambda: pickle.dumps(sim),
    )
    for use in uses:
        with pytest.raises(ClosedError, match="closed"):
            use()
    assert "closed" in repr(sim)


def test_two_threads_on_one_simulation():
    sim = kn.Simulation(kn.examples.n_pendula(20), worlds=2000)
    begun, told = threading.Event(), []

    def steps():
        begun.set()
        try:
            sim.step(2000)
        except BusyError as error:
            told.append(error)

    thread = threading.Thread(target=steps)
    thread.start()
    begun.wait()
    while thread.is_alive() and not told:
        try:
            _ = sim.state.joint_position
        except BusyError as error:
            told.append(error)
    thread.join()
    assert told and "another thread" in str(told[0])
    assert np.isfinite(sim.state.joint_position).all()


def test_quantities_are_read_into_columns():
    worlds, quantities = 2100, ("body_orientation", "joint_velocity", "spatial_inertia", "kinetic_energy")
    sim = kn.Simulation(kn.examples.n_pendula(3), worlds=worlds, threads=2)
    sim.controls.force[:, "hinge0"] = np.linspace(-1.0, 1.0, worlds)
    sim.step(20)
    parts = [sim.state.read(quantity).reshape(worlds, -1) for quantity in quantities]
    expected = np.concatenate(parts, axis=1)
    for dtype in (np.float32, np.float64):
        table = np.full((worlds, expected.shape[1] + 3), 7.0, dtype)
        end = 2
        for quantity in quantities:
            end = sim.state.read_columns(quantity, table, end)
        np.testing.assert_array_equal(table[:, 2:end], expected)
        assert end == table.shape[1] - 1
        assert (table[:, :2] == 7.0).all()
        assert (table[:, end] == 7.0).all()


def test_a_table_of_the_wrong_shape_is_refused():
    sim = kn.Simulation(kn.examples.n_pendula(3), worlds=4)
    read = sim.state.read_columns
    for table, column in [
        (np.zeros((4, 2)), 0),
        (np.zeros((4, 5)), 3),
        (np.zeros((4, 5)), -1),
        (np.zeros((3, 5)), 0),
        (np.zeros(12), 0),
    ]:
        with pytest.raises(ShapeError, match=r"it must have 4 rows and columns -?\d to \d"):
            read("joint_position", table, column)
    with pytest.raises(ShapeError, match="float32 or float64"):
        read("joint_position", np.zeros((4, 3), int))
    with pytest.raises(ShapeError, match="contiguous"):
        read("joint_position", np.zeros((3, 4)).T)
    table = np.zeros((4, 3))
    table.flags.writeable = False
    with pytest.raises(ShapeError, match="cannot be written"):
        read("joint_position", table)


@pytest.mark.parametrize("sensors", ["", "JointPosition('q', rate=0.01)", "Custom('q', lambda s: s.time, rate=0.01)"])
def test_a_key_interrupts_many_steps(sensors):
    """As Ctrl-C does: what was stepped until then stays."""
    program = f"""
import signal, threading, time
import kinetarium as kn
from kinetarium.sensors import *
sim = kn.Simulation(kn.examples.n_pendula(3), worlds=256, sensors=[{sensors}])
threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
begin = time.monotonic()
try:
    sim.step(10**9)
except KeyboardInterrupt:
    print(time.monotonic() - begin < 20, sim.time[0] > 0)
"""
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert found.stdout.split() == ["True", "True"], found.stderr
