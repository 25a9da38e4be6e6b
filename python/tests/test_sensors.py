"""Sensors against closed forms, their rates, their noise, and what is refused."""

import copy
import pickle
import threading

import numpy as np
import pytest

import kinetarium as kn
from kinetarium import sensors
from kinetarium.errors import BusyError, ClosedError, SensorError, ShapeError, UnknownNameError


def box_on_floor():
    world = kn.Builder("box")
    room = world.object("room")
    room.scenery(kn.Geometry.plane())
    room.body("box", [kn.Geometry.box((0.1, 0.1, 0.1))], position=(0, 0.1, 0), mass=2.0)
    return world.build()


def test_a_box_at_rest_feels_its_weight():
    sim = kn.Simulation(
        box_on_floor(),
        worlds=3,
        solver="featherstone",
        sensors=[
            sensors.Imu("imu", "box"),
            sensors.Touch("touch", "box"),
            sensors.ContactForce("contact", "box", axes="world"),
            sensors.FramePose("pose", "box", position=(0, 0.1, 0)),
            sensors.Rangefinder("range", None, position=(-1, 0.1, 0), max_range=5.0),
            sensors.Lidar(
                "lidar",
                None,
                position=(0, 1, 0),
                orientation=(-np.sqrt(0.5), 0, 0, np.sqrt(0.5)),  # its z is up
                azimuths=(0.0, 1.0),
                elevations=(-np.pi / 2, 1.0),
                max_range=7,
            ),
        ],
    )
    sim.step(1000)
    read = sim.sensors
    assert read["imu"].shape == (3, 6)
    # At rest the proper acceleration is +g upwards, and nothing turns.
    np.testing.assert_allclose(read["imu"], [[0, 9.81, 0, 0, 0, 0]] * 3, atol=2e-2)
    np.testing.assert_allclose(read["touch"], [[2.0 * 9.81]] * 3, rtol=1e-2)
    np.testing.assert_allclose(read["contact"], [[0, 2.0 * 9.81, 0]] * 3, atol=0.2)
    np.testing.assert_allclose(read["pose"], [[0, 0.2, 0, 0, 0, 0, 1]] * 3, atol=1e-3)
    np.testing.assert_allclose(read["range"], [[0.9]] * 3, atol=1e-3)
    assert read["lidar"].shape == (3, 2, 2)
    np.testing.assert_allclose(read["lidar"][:, 0], 0.8, atol=1e-3)
    np.testing.assert_allclose(read["lidar"][:, 1], 7.0)


def test_rates_hold_from_sample_to_sample():
    sim = kn.Simulation(
        kn.examples.n_pendula(2),
        worlds=2,
        dt=0.002,
        sensors=[
            sensors.JointPosition("slow", rate=50),
            sensors.JointPosition("fast"),
            sensors.Custom("own", lambda s: s.state.joint_position[:, 0], rate=50),
            sensors.Custom("each", lambda s: s.time),
        ],
    )
    slow, own = [], []
    for _ in range(40):
        sim.step()
        slow.append(sim.sensors["slow"][0, 0])
        own.append(sim.sensors["own"][0])
        assert sim.sensors["fast"][0, 0] == sim.state.joint_position[0, 0]
        assert (sim.sensors["each"] == sim.time).all()
    changes = np.flatnonzero(np.diff(slow)) + 2  # steps done when the reading changed
    assert changes.tolist() == [10, 20, 30, 40]
    assert (np.flatnonzero(np.diff(own)) + 2).tolist() == [10, 20, 30, 40]
    assert sim.sensors.time("slow")[0] == pytest.approx(0.08)
    whole = kn.Simulation(kn.examples.n_pendula(2), worlds=2, dt=0.002, sensors=sim.sensors.list)
    whole.step(40)
    for name in sim.sensors:
        assert (whole.sensors[name] == sim.sensors[name]).all(), name


def test_noise_is_seeded_and_as_large_as_stated():
    noise = sensors.Noise(deviation=0.1, bias=0.5)

    def readings(worlds, threads=0, seed=3):
        sim = kn.Simulation(
            box_on_floor(),
            worlds=worlds,
            threads=threads,
            solver="featherstone",
            sensors=[sensors.FramePose("pose", "box", noise=noise)],
            seed=seed,
        )
        found = []
        for _ in range(200):
            sim.step()
            found.append(sim.sensors["pose"][:, 0])
        return np.array(found)

    many = readings(64)
    assert (readings(4, threads=1) == many[:, :4]).all()
    assert (readings(4, seed=4) != many[:, :4]).any()
    # 200 · 64 samples: the deviation is known to 1/√(2 · 12800) = 0.6 %, the bias's of 64 draws to 9 %.
    within = (many - many.mean(axis=0)).std()
    assert within == pytest.approx(0.1, rel=0.03)
    assert many.mean(axis=0).std() == pytest.approx(0.5, rel=0.4)


def test_worlds_that_are_reset_are_sampled_alone():
    called = []

    def angle(sim):
        called.append(float(sim.time.max()))
        return sim.state.joint_position[:, "hinge0"]

    sim = kn.Simulation(
        kn.examples.n_pendula(1),
        worlds=3,
        dt=0.002,
        sensors=[sensors.Custom("own", angle, rate=10), sensors.JointPosition("angle", rate=10)],
    )
    begin = sim.sensors["own"][0]
    for step in range(1, 101):  # 0.2 s
        sim.step()
        if step % 10 == 0:
            sim.reset([1])
        assert (sim.sensors["own"] == sim.sensors["angle"][:, 0]).all()
        assert (sim.sensors.time("own") == sim.sensors.time("angle")).all()
    # At the start, at 0.1 and 0.2 s, and at each of the ten resets.
    assert len(called) == 13
    assert sim.sensors["own"][1] == begin and (sim.sensors["own"][[0, 2]] != begin).all()
    assert sim.sensors.time("own").round(6).tolist() == [0.2, 0.0, 0.2]


def test_one_sensor_and_one_name_need_no_list():
    sim = kn.Simulation(kn.examples.n_pendula(2), sensors=sensors.JointPosition("q", "hinge1"))
    assert sim.sensors["q"].shape == (1, 1)


def test_sensors_may_come_from_an_iterator():
    sim = kn.Simulation(kn.examples.n_pendula(2), sensors=(sensors.JointPosition(name) for name in "ab"))
    assert list(sim.sensors) == ["a", "b"] and sim.sensors["b"].shape == (1, 2)


@pytest.mark.parametrize(
    "sensor",
    [
        sensors.JointPosition("angles", noise=sensors.Noise(deviation=0.1)),
        sensors.Custom("angles", lambda sim: sim.state.joint_position, noise=sensors.Noise(deviation=0.1)),
    ],
)
def test_a_copy_that_is_reset_at_once_begins_another_episode(sensor):
    sim = kn.Simulation(kn.examples.n_pendula(2), worlds=2, sensors=sensor)
    first = sim.sensors["angles"]
    sim.step(3)
    twin = copy.copy(sim)
    for s in (sim, twin):
        s.reset([1])
    np.testing.assert_array_equal(twin.sensors["angles"], sim.sensors["angles"])
    assert (twin.sensors["angles"][1] != first[1]).all()


@pytest.mark.parametrize(
    "sensor",
    [
        sensors.JointPosition("angles", noise=sensors.Noise(deviation=0.1, walk=0.5)),
        sensors.Custom("angles", lambda sim: sim.state.joint_position, noise=sensors.Noise(deviation=0.1, walk=0.5)),
    ],
)
def test_samples_are_taken_anew(sensor):
    seldom = sensors.JointPosition("seldom", rate=50)
    sim = kn.Simulation(kn.examples.n_pendula(2), worlds=2, sensors=[sensor, seldom], dtype="float64")
    sim.step(3)
    before, first = sim.sensors["angles"], sim.sensors["seldom"]
    sim.state.joint_position[1] += 0.25
    assert (sim.sensors["angles"] == before).all()
    sim.sensors.resample()
    assert sim.sensors["angles"] - before == pytest.approx(np.array([[0.0, 0.0], [0.25, 0.25]]))
    assert (sim.sensors["seldom"] == first).all() and (sim.sensors.time("seldom") == 0).all()
    sim.sensors.resample()
    after = sim.sensors["angles"]
    assert after - before == pytest.approx(np.array([[0.0, 0.0], [0.25, 0.25]]))
    sim.step()
    assert (sim.sensors["angles"] != after).all()


def test_samples_are_taken_anew_under_the_controls_as_they_stand():
    def acceleration(sim):
        return sim.state.joint_acceleration

    given = [sensors.JointEffort("effort"), sensors.Custom("acceleration", acceleration)]
    sim = kn.Simulation(kn.examples.n_pendula(2), sensors=given)
    still = sim.sensors["acceleration"]
    sim.controls.force[0] = 3.0
    sim.sensors.resample()
    assert sim.sensors["effort"] == pytest.approx(np.array([[3.0, 3.0]]))
    assert (sim.sensors["acceleration"] != still).any()
    readings = sim.sensors
    del sim, given
    with pytest.raises(ClosedError, match="gone"):
        readings.resample()


def test_what_resets_no_world_samples_none():
    sim = kn.Simulation(
        kn.examples.n_pendula(1),
        worlds=2,
        sensors=[
            sensors.Custom("own", lambda s: s.state.joint_position, rate=10),
            sensors.JointPosition("q", rate=10),
        ],
    )
    for _ in range(12):
        sim.step(10)  # 0.24 s
        sim.reset(sim.state.diverged)
    assert sim.sensors.time("own").round(6).tolist() == sim.sensors.time("q").round(6).tolist() == [0.2, 0.2]
    assert (sim.sensors["own"] == sim.sensors["q"]).all()


def test_sensors_see_the_controls_of_a_keyframe():
    model = kn.parse("""
        <mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>
          <actuator><motor name="m" joint="j"/></actuator>
          <keyframe><key name="pushed" qpos="0.5" ctrl="3"/></keyframe></mujoco>""")
    sim = kn.Simulation(
        model,
        worlds=2,
        sensors=[sensors.ActuatorForce("m"), sensors.Custom("own", lambda s: np.array(s.controls.actuator))],
    )
    sim.reset([1], keyframe="pushed")
    assert sim.sensors["m"].tolist() == sim.sensors["own"].tolist() == [[0], [3]]


def test_another_thread_cannot_change_what_a_sensor_measures():
    measuring, done = threading.Event(), threading.Event()

    def slow(sim):
        if sim.time[0] > 0:
            measuring.set()
            assert done.wait(20)
        return sim.time

    sim = kn.Simulation(kn.examples.n_pendula(1), sensors=[sensors.Custom("slow", slow, rate=100)])
    thread = threading.Thread(target=sim.step, args=[10])
    thread.start()
    assert measuring.wait(20)
    for change in [sim.step, sim.reset, lambda: sim.set_state([0.0]), lambda: sim.restore(b"")]:
        with pytest.raises(BusyError, match="another thread"):
            change()
    done.set()
    thread.join()
    assert sim.step().size == 0 and sim.time[0] == pytest.approx(0.022)


def test_a_diverged_world_keeps_what_was_measured():
    sim = kn.Simulation(
        kn.examples.n_pendula(1), worlds=2, sensors=[sensors.Custom("own", lambda s: s.state.joint_velocity)]
    )
    sim.set_state(np.zeros((2, 1)), [[0.0], [1e4]])
    sim.controls.force[1] = 1e9
    assert sim.step(3).tolist() == [1]
    assert np.isfinite(sim.sensors["own"]).all()
    assert sim.sensors.time("own")[1] < sim.sensors.time("own")[0] == pytest.approx(0.006)


def test_noise_of_custom_sensors_is_that_of_others():
    noise = sensors.Noise(deviation=0.1, bias=[0.2, 0.5], walk=0.3)

    def readings(sensor, worlds=5):
        sim = kn.Simulation(kn.examples.n_pendula(2), worlds=worlds, dtype="float64", sensors=[sensor], seed=7)
        found = [sim.sensors["q"]]
        for step in range(30):
            sim.step()
            if step == 15:
                sim.reset([2])
            found.append(sim.sensors["q"])
        return np.array(found)

    def custom(**options):
        return sensors.Custom("q", lambda s: s.state.joint_position, rate=100, **options)

    own = readings(custom(noise=noise, cutoff=1.0))
    np.testing.assert_allclose(
        own, readings(sensors.JointPosition("q", rate=100, noise=noise, cutoff=1.0)), atol=1e-5
    )
    assert np.abs(own).max() == 1.0
    assert (readings(custom(noise=noise, cutoff=1.0), worlds=9)[:, :5] == own).all()
    steps = readings(custom(noise=sensors.Noise(deviation=0.1, step=0.25))) / 0.25
    assert (steps == steps.round()).all() and len(np.unique(steps)) > 2


def test_a_custom_sensor_that_changes_the_simulation_is_told():
    greedy = []
    sim = kn.Simulation(
        kn.examples.n_pendula(1), sensors=[sensors.Custom("own", lambda s: s.step() if greedy else s.time)]
    )
    greedy.append(True)
    with pytest.raises(BusyError, match="measure"):
        sim.step()
    greedy.clear()
    sim.step()
    assert sim.sensors["own"] == sim.time == pytest.approx(0.004)


def test_cameras_and_copies():
    camera = kn.Camera(32, 24, channels=("depth", "body")).looking((0, 0.1, 3), (0, 0.1, 0))
    sim = kn.Simulation(
        box_on_floor(),
        worlds=2,
        sensors=[sensors.Camera("eye", camera=camera, rate=25), sensors.Touch("touch", "box")],
    )
    sim.step(50)
    images = sim.sensors["eye"]
    assert images.depth.shape == (2, 24, 32) and images.rgb is None
    assert images.depth[0, 12, 16] == pytest.approx(2.9, abs=1e-2)
    assert images.body[0, 12, 16] == 0 and images.body[0, 0, 0] == -1
    # The measurements themselves cannot be pickled with a function in them, but these can.
    twin = pickle.loads(pickle.dumps(sim))
    assert (twin.sensors["eye"].depth == images.depth).all()
    twin.step(7)
    sim.step(7)
    assert (twin.sensors["touch"] == sim.sensors["touch"]).all()


def test_images_have_seeded_noise():
    camera = kn.Camera(32, 24, channels=("rgb", "depth")).looking((0, 0.1, 3), (0, 0.1, 0))

    def images(seed=0, **noise):
        eye = sensors.Camera("eye", camera=camera, **noise)
        return kn.Simulation(box_on_floor(), worlds=2, sensors=[eye], seed=seed).sensors["eye"]

    exact, noisy = images(), images(rgb_noise=0.02, depth_noise=0.1)
    seen = np.isfinite(exact.depth)
    # The standard deviation of some hundreds of numbers is known to 4 %.
    assert (noisy.depth[seen] - exact.depth[seen]).std() == pytest.approx(0.1, rel=0.2)
    off = noisy.rgb.astype(float) - exact.rgb
    assert off[(exact.rgb > 20) & (exact.rgb < 235)].std() == pytest.approx(255 * 0.02, rel=0.2)
    assert (np.isfinite(noisy.depth) == seen).all()
    assert (images(rgb_noise=0.02).rgb == noisy.rgb).all()
    assert (images(seed=1, rgb_noise=0.02).rgb != noisy.rgb).any()
    with pytest.raises(SensorError, match="noise of its depth"):
        images(depth_noise=-1.0)


@pytest.mark.parametrize(
    ("list_of", "error", "message"),
    [
        ([sensors.Touch("a", "box"), sensors.Touch("a", "box")], SensorError, '"a"'),
        ([sensors.Touch("a", "bax")], UnknownNameError, 'did you mean "box"'),
        ([sensors.Touch("", "box")], SensorError, "name"),
        ([sensors.Touch("a", "box", rate=-1.0)], SensorError, "rate"),
        ([sensors.Touch("a", "box", noise=sensors.Noise(deviation=-1))], SensorError, "deviation"),
        ([sensors.Imu("a", "box", noise=sensors.Noise(bias=[1.0, 2.0]))], SensorError, "6"),
        ([sensors.Rangefinder("a", "box", max_range=-1)], SensorError, "range"),
        ([sensors.Imu("a", "box", orientation=[0] * 4)], SensorError, r"at \[0, 0, 0\], turned by \[0, 0, 0, 0\]"),
        ([sensors.Custom("a", lambda s: 1.0)], ShapeError, "1 rows"),
        ([sensors.Custom("a", lambda s: s.time, rate=0)], SensorError, "rate"),
        ([sensors.Custom("a", lambda s: s.time, cutoff=-1)], SensorError, "cutoff"),
        ([sensors.Custom("a", lambda s: s.time, noise=sensors.Noise(step=[1, 2]))], SensorError, "2 numbers"),
        ([sensors.Custom("a", lambda s: s.time, noise=0.1)], SensorError, "give a Noise"),
        ([sensors.Custom("a", lambda s: s.step())], BusyError, "measure"),
        ([sensors.Custom("a", lambda s: s.reset())], BusyError, "measure"),
        ([sensors.Touch("a", "box", noise=0.1)], SensorError, "give a Noise"),
        ([sensors.Camera("a", camera=3)], SensorError, "give a Camera, or its name"),
        ([sensors.Camera("a", camera="front")], UnknownNameError, "front"),
        (["touch"], SensorError, "no sensor"),
        ([sensors.ForceTorque("a", "hinge")], UnknownNameError, "hinge"),
    ],
)
def test_bad_sensors_are_refused(list_of, error, message):
    with pytest.raises(error, match=message):
        kn.Simulation(box_on_floor(), sensors=list_of)


def test_a_sensor_may_not_change_what_it_measures():
    def reset(sim):
        sim.reset()
        return sim.time

    with pytest.raises(BusyError, match="may only read it"):
        kn.Simulation(box_on_floor(), sensors=[sensors.Custom("a", reset)])

    def step(sim):
        if sim.time[0] > 0.0:
            sim.step()
        return sim.time

    sim = kn.Simulation(box_on_floor(), sensors=[sensors.Custom("a", step)])
    with pytest.raises(BusyError, match="may only read it"):
        sim.step(5)
    sim.reset()
    assert sim.time[0] == 0.0


def test_unknown_readings_are_told():
    sim = kn.Simulation(box_on_floor(), sensors=[sensors.Touch("touch", "box")])
    with pytest.raises(UnknownNameError, match="tuch"):
        sim.sensors["tuch"]
    assert list(sim.sensors) == ["touch"] and len(sim.sensors) == 1
    assert "touch" in sim.sensors and "tuch" not in sim.sensors
    assert sim.sensors.get("touch").shape == (1, 1) and sim.sensors.get("tuch") is None
    assert repr(sim.sensors) == "<Sensors: touch>"
    with pytest.raises(AttributeError, match='Sensors has no attribute "touch"'):
        sim.sensors.touch = 1


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sensors.Imu("imu", "b", position=(0, 0)), r'position of sensor "imu" is \(0, 0\): give 3 numbers'),
        (lambda: sensors.Lidar("l", orientation="up"), "orientation of sensor \"l\" is 'up': give 4 numbers"),
        (lambda: sensors.ForceTorque("f", "j", frame=((0, 0, 0),)), 'frame of sensor "f" is .*: give a position and'),
        (lambda: sensors.ForceTorque("f", "j", frame=((0, 0, 0), [1])), r'orientation of sensor "f" is \[1\]'),
        (lambda: sensors.Noise("a"), "the noise's deviation is 'a': give a number, or one for each"),
        (lambda: sensors.Noise(bias=[[1.0], 2.0]), "the noise's bias is .*: give a number, or one for each"),
    ],
)
def test_what_is_no_number_is_told_at_once(make, message):
    with pytest.raises(SensorError, match=message):
        make()
