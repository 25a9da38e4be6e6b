"""Sensors that a file describes, beside MuJoCo's `sensordata`."""

import dataclasses
import pickle

import numpy as np
import pytest

import kinetarium as kn
from kinetarium.errors import FileError, UnknownNameError

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is what is compared with")

ROBOT = """
<mujoco>
  <option gravity="0 0 -9.81" timestep="0.002"/>
  <default>
    <geom density="500"/>
    <site size="0.5"/>
  </default>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
    <site name="ceiling" pos="0 0 6" euler="180 0 0"/>
    <body name="torso" pos="0 0 3">
      <freejoint name="float"/>
      <geom name="chest" type="box" size="0.1 0.2 0.3" pos="0.1 0 0.05" euler="10 20 30"/>
      <site name="back" pos="-0.1 0.02 0.1" euler="20 -40 70"/>
      <body name="frame" pos="0.1 0.2 0.3" euler="5 10 15">
        <site name="mark" pos="0.01 0.02 0.03" euler="-10 50 0"/>
      </body>
      <body name="arm" pos="0.3 0 0.1">
        <joint name="shoulder" type="ball" damping="0.1"/>
        <geom type="capsule" fromto="0 0 0 0.4 0 0.1" size="0.05"/>
        <site name="elbow" pos="0.4 0 0.1" euler="0 30 0"/>
        <body name="hand" pos="0.4 0 0.1">
          <joint name="twist" axis="1 0 0" damping="0.2"/>
          <joint name="bend" axis="0 1 0" pos="0 0 0.01"/>
          <geom type="ellipsoid" size="0.1 0.05 0.2" pos="0 0 -0.1"/>
          <site name="palm" pos="0 0 -0.2" euler="90 0 20"/>
        </body>
      </body>
    </body>
    <body name="crane" pos="4 0 3">
      <joint name="lift" type="slide" axis="0 0 1" damping="3"/>
      <geom type="box" size="0.3 0.1 0.1" euler="0 0 30"/>
      <site name="cab" euler="0 0 45"/>
      <body name="hook" pos="0.4 0 0">
        <joint name="swing" axis="0 1 0"/>
        <geom type="sphere" size="0.1" pos="0 0 -0.3"/>
        <site name="tip" pos="0 0 -0.4" euler="180 0 0"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="twister" joint="twist" gear="3"/>
    <position name="lifter" joint="lift" kp="200" kv="5" gear="2" forcerange="-80 80"/>
    <velocity name="swinger" joint="swing" kv="2"/>
  </actuator>
  <sensor>
    <jointpos name="q twist" joint="twist"/>
    <jointpos name="q bend" joint="bend"/>
    <jointpos joint="lift"/>
    <jointvel name="v bend" joint="bend"/>
    <jointvel joint="lift"/>
    <jointactuatorfrc name="effort" joint="lift"/>
    <jointactuatorfrc joint="twist"/>
    <actuatorfrc name="lifting" actuator="lifter"/>
    <actuatorfrc actuator="twister"/>
    <actuatorfrc actuator="swinger" cutoff="0.3"/>
    <ballquat name="turn" joint="shoulder"/>
    <ballangvel joint="shoulder" cutoff="0.7"/>
    <accelerometer name="acc" site="palm"/>
    <accelerometer name="acc frame" site="mark"/>
    <accelerometer name="at rest" site="ceiling"/>
    <gyro name="gyro" site="palm" noise="0" cutoff="1.5"/>
    <gyro site="mark"/>
    <velocimeter name="speed" site="back"/>
    <force name="pull" site="elbow"/>
    <torque name="wrench" site="elbow"/>
    <force site="tip"/>
    <torque site="cab"/>
    <touch name="touch" site="palm"/>
    <rangefinder name="aside" site="mark"/>
    <rangefinder name="hanging" site="tip" cutoff="2.5"/>
    <framepos name="p" objtype="site" objname="palm"/>
    <framepos objtype="xbody" objname="hand" reftype="site" refname="back"/>
    <framepos objtype="body" objname="hand"/>
    <framepos objtype="geom" objname="chest" reftype="xbody" refname="hook"/>
    <framepos objtype="site" objname="mark"/>
    <framequat name="turned" objtype="site" objname="mark"/>
    <framequat objtype="xbody" objname="hand" reftype="site" refname="back"/>
    <framelinvel name="v" objtype="site" objname="palm"/>
    <framelinvel objtype="body" objname="hand"/>
    <framelinvel objtype="geom" objname="chest"/>
    <frameangvel name="w" objtype="xbody" objname="arm"/>
    <subtreecom name="all" body="world"/>
    <subtreecom name="arm" body="arm"/>
    <subtreecom body="torso"/>
  </sensor>
</mujoco>
"""


@pytest.fixture
def moving():
    """The robot in some worlds that have made a step, and MuJoCo's readings at the same states."""
    worlds = 12
    model = kn.parse(ROBOT)
    sim = kn.Simulation(model, worlds, solver="featherstone", dtype="float64", sensors=kn.sensors.from_model(model))
    random = np.random.default_rng(0)
    q = np.tile(model.initial_position, (worlds, 1)) + random.uniform(-0.5, 0.5, (worlds, model.coordinates))
    for start in (3, 7):
        q[:, start : start + 4] /= np.linalg.norm(q[:, start : start + 4], axis=1, keepdims=True)
    sim.set_state(q, random.normal(0, 1, (worlds, model.degrees_of_freedom)))
    sim.controls.actuator = random.uniform(-1, 1, (worlds, 3))
    sim.step()

    other = mujoco.MjModel.from_xml_string(ROBOT)
    data = mujoco.MjData(other)
    w_first = [0, 1, 2, 6, 3, 4, 5, 10, 7, 8, 9, 11, 12, 13, 14]
    readings = []
    for world in range(worlds):
        data.qpos[:] = sim.state.joint_position[world, w_first]
        data.qvel[:], data.ctrl[:] = sim.state.joint_velocity[world], sim.controls.actuator[world]
        mujoco.mj_forward(other, data)
        assert data.ncon == 0
        readings.append(data.sensordata.copy())
    parts = [slice(a, a + n) for a, n in zip(other.sensor_adr, other.sensor_dim, strict=True)]
    kinds = [mujoco.mjtSensor(kind) for kind in other.sensor_type]
    return sim, [(kind, np.array(readings)[:, part]) for kind, part in zip(kinds, parts, strict=True)]


def test_readings_are_mujocos(moving):
    sim, others = moving
    assert len(sim.sensors) == len(others) == 39
    for (name, found), (kind, expected) in zip(sim.sensors.items(), others, strict=True):
        if kind in (mujoco.mjtSensor.mjSENS_FRAMEQUAT, mujoco.mjtSensor.mjSENS_BALLQUAT):
            expected = expected[:, [1, 2, 3, 0]]
            expected *= np.sign((expected * found).sum(axis=1, keepdims=True))
        if kind == mujoco.mjtSensor.mjSENS_RANGEFINDER:
            expected = np.where(expected < 0, {"aside": np.inf, "hanging": 2.5}[name], expected)
        assert found.shape == expected.shape, name
        # Accelerations up to 10² of bodies down to 5 kg, solved for in roundings of 2⁻⁵³.
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9, err_msg=name)
        if kind != mujoco.mjtSensor.mjSENS_TOUCH:
            assert np.abs(found).max() > 0.05, name
    aside = sim.sensors["aside"]
    assert np.isinf(aside).any() and np.isfinite(aside).any()
    # The cutoffs are met.
    assert (np.abs(sim.sensors["gyro"]) == 1.5).any() and (sim.sensors["hanging"] == 2.5).any()


def test_sensors_of_a_file_are_as_others(moving):
    sim, _ = moving
    listed = kn.sensors.from_model(sim.model)
    assert [s.name for s in listed[:3]] == ["q twist", "q bend", "jointpos"]
    assert "jointpos" in sim.sensors and "subtreecom" in sim.sensors
    own = dataclasses.replace(listed[12], name="noisy", source="acc", rate=50, noise=kn.sensors.Noise(deviation=0.1))
    sim = kn.Simulation(sim.model, worlds=3, sensors=[own])
    assert sim.sensors["noisy"].shape == (3, 3)
    assert np.unique(sim.sensors["noisy"][:, 0]).size == 3
    twin = pickle.loads(pickle.dumps(sim))
    assert (twin.sensors["noisy"] == sim.sensors["noisy"]).all()
    with pytest.raises(UnknownNameError, match=r"no sensor of the model \"none\"; there are q twist"):
        kn.Simulation(sim.model, sensors=[kn.sensors.Described("none")])


def test_noise_interval_and_touch_are_the_files():
    text = """
    <mujoco>
      <worldbody>
        <geom type="plane" size="0 0 1"/>
        <body name="box" pos="0 0 0.1">
          <freejoint/>
          <geom type="box" size="0.1 0.1 0.1" mass="2"/>
          <site name="all" size="0.5"/>
        </body>
      </worldbody>
      <sensor>
        <gyro name="noisy" site="all" noise="0.2" interval="0.01"/>
        <touch name="touch" site="all"/>
      </sensor>
    </mujoco>
    """
    model = kn.parse(text)
    assert model.sensors == [("noisy", 100.0, 0.2, None), ("touch", None, 0.0, None)]
    assert any("touch: of all contacts of the body" in warning for warning in model.warnings)
    sim = kn.Simulation(model, worlds=400, solver="featherstone", sensors=kn.sensors.from_model(model), seed=4)
    sim.step(1000)
    # 1200 draws: known to 1/√2400 = 2 %; four times that.
    assert sim.sensors["noisy"].std() == pytest.approx(0.2, rel=0.08)
    np.testing.assert_allclose(sim.sensors["touch"], 2 * 9.81, rtol=1e-2)


def test_unknown_objects_are_named_with_what_is_alike():
    with pytest.raises(FileError, match="names `plam`, but no site has this name; did you mean `palm`"):
        kn.parse(ROBOT.replace('<gyro site="mark"/>', '<gyro site="plam"/>'))
