"""Bodies about the centres of mass of their trees, beside MuJoCo's."""

import numpy as np
import pytest

import kinetarium as kn

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is what is compared with")

ROBOTS = """
<mujoco>
  <option gravity="0 0 -9.81" timestep="0.002"/>
  <worldbody>
    <body name="torso" pos="0 0 3">
      <freejoint/>
      <geom type="capsule" size="0.1 0.2" euler="20 30 10" pos="0.1 0 0.05"/>
      <body name="arm" pos="0.3 0 0.1">
        <joint type="ball"/>
        <geom type="box" size="0.1 0.2 0.3" pos="0 0.1 -0.3"/>
        <body name="hand" pos="0 0.1 -0.7">
          <joint type="hinge" axis="1 1 0"/>
          <geom type="ellipsoid" size="0.1 0.05 0.2" pos="0 0 -0.1"/>
        </body>
      </body>
    </body>
    <body name="crane" pos="4 0 1">
      <joint type="slide" axis="0 0 1"/>
      <geom type="box" size="0.3 0.1 0.1" euler="0 0 30"/>
      <body name="hook" pos="0.4 0 0">
        <joint type="hinge" axis="0 1 0"/>
        <geom type="sphere" size="0.1" pos="0 0 -0.3"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def test_inertias_velocities_and_centers_are_mujocos(tmp_path):
    path = tmp_path / "robots.xml"
    path.write_text(ROBOTS)
    other = mujoco.MjModel.from_xml_string(ROBOTS)
    data = mujoco.MjData(other)
    worlds = 20
    sim = kn.Simulation(kn.load(str(path)), worlds, solver="featherstone", dtype="float64")
    random = np.random.default_rng(0)
    q = random.uniform(-1, 1, (worlds, other.nq))
    v = random.normal(0, 1, (worlds, other.nv))
    for start in (3, 7):
        q[:, start : start + 4] /= np.linalg.norm(q[:, start : start + 4], axis=1, keepdims=True)
    order = [0, 1, 2, 4, 5, 6, 3, 8, 9, 10, 7, 11, 12, 13]  # quaternions: w last
    sim.set_state(q[:, order], v)
    inertia, velocity = sim.state.spatial_inertia, sim.state.spatial_velocity
    centers = sim.state.center_of_mass
    for world in range(worlds):
        data.qpos[:], data.qvel[:] = q[world], v[world]
        mujoco.mj_forward(other, data)
        # A few roundings of numbers up to 100.
        np.testing.assert_allclose(inertia[world], data.cinert[1:], atol=1e-12 * 100)
        np.testing.assert_allclose(velocity[world], data.cvel[1:], atol=1e-12 * 100)
        np.testing.assert_allclose(centers[world], data.subtree_com[0], atol=1e-12 * 100)
    assert inertia.shape == (worlds, 5, 10) and velocity[:, "hook"].shape == (worlds, 6)


def test_masses_are_the_worlds_own():
    sim = kn.Simulation(kn.examples.n_pendula(2), worlds=3, dtype="float64")
    sim.parameters.body_mass[1] = [1.0, 3.0]
    position = sim.state.body_position
    centers = sim.state.center_of_mass
    np.testing.assert_allclose(centers[1], (position[1, 0] + 3 * position[1, 1]) / 4, atol=1e-14)
    np.testing.assert_allclose(centers[2], position[2].mean(axis=0), atol=1e-14)
    assert sim.state.spatial_inertia[1, "link1", 9] == 3.0
