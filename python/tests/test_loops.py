"""Closed loops and couplings against MuJoCo, whose constraints are made as stiff as it lets them be."""

import mujoco
import numpy as np
import pytest

import kinetarium as kn

# A leg on a floating base whose rod closes a loop, a gripper whose jaws mirror each other, and an arm, the joints
# of which are coupled, that carries a load.
MECHANISM = """
<mujoco>
  <option timestep="{h}" gravity="0 0 -9.81" iterations="200" tolerance="1e-14"><flag contact="disable"/></option>
  <default>
    <geom density="800" type="capsule" size="0.02"/>
    <equality solref="{stiff} 1" solimp="0.9999 0.9999 0.001"/>
  </default>
  <worldbody>
    <body name="base" pos="0 0 1">
      <freejoint/>
      <geom type="box" size="0.12 0.08 0.05"/>
      <body name="thigh" pos="0 0.1 0">
        <joint name="hip" axis="0 1 0"/>
        <geom fromto="0 0 0 0.05 0 -0.3"/>
        <body name="shin" pos="0.05 0 -0.3">
          <joint name="knee" axis="0 1 0"/>
          <geom fromto="0 0 0 -0.08 0 -0.3"/>
          <body name="foot" pos="-0.08 0 -0.3">
            <joint name="ankle" axis="0 1 0" damping="0.05"/>
            <geom fromto="-0.05 0 0 0.12 0 0"/>
          </body>
        </body>
        <body name="rod" pos="-0.05 0 -0.02">
          <joint name="pivot" type="ball"/>
          <geom fromto="0 0 0 -0.06 0 -0.45" size="0.008"/>
        </body>
      </body>
      <body name="left_jaw" pos="0.12 0 0">
        <joint name="left" type="slide" axis="0 1 0"/>
        <geom fromto="0 0.02 0 0.08 0.02 0" size="0.01"/>
      </body>
      <body name="right_jaw" pos="0.12 0 0">
        <joint name="right" type="slide" axis="0 1 0"/>
        <geom fromto="0 -0.02 0 0.08 -0.02 0" size="0.01"/>
      </body>
      <body name="arm" pos="-0.1 0 0.05">
        <joint name="shoulder" axis="0 0 1"/>
        <geom fromto="0 0 0 -0.1 0 0.2" size="0.015"/>
        <body name="wrist" pos="-0.1 0 0.2">
          <joint name="elbow" axis="1 0 0"/>
          <geom fromto="0 0 0 0 0.1 0.1" size="0.012"/>
        </body>
      </body>
    </body>
    <body name="load" pos="-0.2 0.1 1.35"><freejoint/><geom type="box" size="0.04 0.05 0.06"/></body>
  </worldbody>
  <equality>
    <connect name="push" body1="rod" body2="foot" anchor="-0.06 0 -0.45"/>
    <weld name="grip" body1="wrist" body2="load"/>
    <joint name="mirror" joint1="left" joint2="right" polycoef="0 -1 0 0 0"/>
    <joint name="follow" joint1="elbow" joint2="shoulder" polycoef="0 0.5 0 0 0"/>
  </equality>
  <actuator>
    <motor joint="hip" gear="8"/><motor joint="knee" gear="6"/>
    <motor joint="left" gear="5"/><motor joint="shoulder" gear="1"/>
  </actuator>
</mujoco>
"""


def apart(tmp_path, h, dtype="float64", worlds=1):
    """How far the bodies of both engines are from each other after 0.3 s, and from where they began [m]."""
    # MuJoCo lets no time constant be shorter than two steps.
    text = MECHANISM.format(h=h, stiff=2 * h)
    file = tmp_path / "mechanism.xml"
    file.write_text(text)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    sim = kn.Simulation(kn.load(file), worlds=worlds, dt=h, dtype=dtype)
    assert sim.solver == "featherstone"
    mujoco.mj_kinematics(model, data)
    start = data.xpos[1:].copy()
    for step in range(round(0.3 / h)):
        t = step * h
        control = 0.5 * np.array([np.sin(9 * t), np.cos(7 * t), np.sin(11 * t), np.cos(5 * t)])
        data.ctrl[:] = control
        sim.controls.actuator = np.broadcast_to(control, (worlds, 4))
        mujoco.mj_step(model, data)
        assert not sim.step().size
    mujoco.mj_kinematics(model, data)
    position = np.asarray(sim.state.body_position)
    assert (position == position[0]).all()
    return np.abs(position[0] - data.xpos[1:]).max(), np.abs(data.xpos[1:] - start).max()


def test_loops_move_as_mujocos(tmp_path):
    # Both step by semi-implicit Euler, so that the constraints alone are what differs: MuJoCo's give way by some
    # acceleration times the square of their time constant, 2 h.
    coarse, way = apart(tmp_path, 4e-4)
    fine, _ = apart(tmp_path, 2e-4)
    assert fine < 2e-4 and way > 0.3
    assert coarse / fine == pytest.approx(4.0, abs=1.0)


def test_loops_in_lanes_and_single_precision(tmp_path):
    # Rounding of f32 grows for 750 steps.
    found, _ = apart(tmp_path, 4e-4, dtype="float32", worlds=17)
    assert found < 2e-3
