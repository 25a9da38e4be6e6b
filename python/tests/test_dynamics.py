"""The equation of motion as functions."""

import copy
import pickle
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import kinetarium as kn
from kinetarium.errors import OutOfRangeError, ShapeError, SimulationError, UnknownNameError

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")

ASSETS = Path(gymnasium.__file__).parent / "envs/mujoco/assets"


@pytest.fixture(scope="module")
def humanoid():
    return kn.load(ASSETS / "humanoid.xml")


@pytest.fixture(scope="module")
def states(humanoid):
    """Some positions, velocities and accelerations of it, a row each."""
    random = np.random.default_rng(0)
    q = np.tile(humanoid.initial_position, (5, 1)) + 0.3 * random.normal(size=(5, humanoid.coordinates))
    q[:, 3:7] /= np.linalg.norm(q[:, 3:7], axis=1, keepdims=True)
    return (
        q,
        random.normal(size=(5, humanoid.degrees_of_freedom)),
        random.normal(size=(5, humanoid.degrees_of_freedom)),
    )


def test_forward_is_the_inverse_of_inverse_dynamics(humanoid, states):
    """M q̈ + b = τ, whichever way it is asked."""
    dynamics, (q, v, a) = kn.Dynamics(humanoid), states
    tau = dynamics.inverse_dynamics(q, v, a)
    np.testing.assert_allclose(dynamics.forward_dynamics(q, v, tau), a, rtol=1e-9, atol=1e-9)
    bias = dynamics.inverse_dynamics(q, v)
    motion = np.einsum("rij,rj->ri", dynamics.mass_matrix(q), a)
    np.testing.assert_allclose(motion + bias, tau, rtol=1e-9, atol=1e-9)


def test_a_batch_is_as_its_states(humanoid, states):
    dynamics, (q, v, a) = kn.Dynamics(humanoid), states
    for row in range(len(q)):
        np.testing.assert_array_equal(dynamics.mass_matrix(q)[row], dynamics.mass_matrix(q[row]))
        np.testing.assert_array_equal(
            dynamics.inverse_dynamics(q, v[0], a)[row], dynamics.inverse_dynamics(q[row], v[0], a[row])
        )
    n = humanoid.degrees_of_freedom
    assert dynamics.mass_matrix(np.tile(q, (2, 3, 1, 1))).shape == (2, 3, 5, n, n)
    assert dynamics.jacobian(q[:0], 0).shape == (0, 6, n)
    points = np.arange(15.0).reshape(5, 3)
    for row, point in enumerate(points):
        np.testing.assert_array_equal(dynamics.jacobian(q, 3, points)[row], dynamics.jacobian(q[row], 3, point))
        np.testing.assert_array_equal(dynamics.jacobian(q[0], 3, points)[row], dynamics.jacobian(q[0], 3, point))
    assert dynamics.bodies(q[0]).position.shape == (len(humanoid.body_names), 3)


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda d: pickle.loads(pickle.dumps(d))])
def test_copies_give_the_same(humanoid, states, copied):
    dynamics = kn.Dynamics(humanoid)
    same = copied(dynamics)
    assert same.model == dynamics.model
    np.testing.assert_array_equal(same.inverse_dynamics(*states), dynamics.inverse_dynamics(*states))


def test_jacobians_are_velocities_of_points(humanoid, states):
    """(ω, ẋ) = J q̇, and ẋ of a point r of the body's frame is v + ω × R r."""
    dynamics, (q, v, _) = kn.Dynamics(humanoid), states
    bodies, body, point = dynamics.bodies(q, v), humanoid.body("left_foot"), np.array([0.1, -0.2, 0.3])
    moving = np.einsum("rij,rj->ri", dynamics.jacobian(q, "left_foot", point), v)
    turning = bodies.angular_velocity[:, body]
    x, w = bodies.orientation[:, body, :3], bodies.orientation[:, body, 3:]
    arm = point + 2 * np.cross(x, np.cross(x, point) + w * point)
    np.testing.assert_allclose(moving[:, :3], turning, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(
        moving[:, 3:], bodies.linear_velocity[:, body] + np.cross(turning, arm), rtol=1e-9, atol=1e-9
    )


def test_all_is_as_in_mujoco():
    path = ASSETS / "hopper.xml"
    model, peer = kn.load(path), mujoco.MjModel.from_xml_path(str(path))
    data, dynamics, random = mujoco.MjData(peer), kn.Dynamics(model), np.random.default_rng(1)
    for _ in range(5):
        data.qpos[:], data.qvel[:] = random.normal(size=(2, peer.nv))
        mujoco.mj_forward(peer, data)
        full = np.zeros((peer.nv, peer.nv))
        mujoco.mj_fullM(peer, data, full)
        np.testing.assert_allclose(dynamics.mass_matrix(data.qpos), full, rtol=1e-9, atol=1e-9)
        bias = dynamics.inverse_dynamics(data.qpos, data.qvel)
        np.testing.assert_allclose(bias, data.qfrc_bias, rtol=1e-9, atol=1e-9)
        moving, turning = np.zeros((2, 3, peer.nv))
        mujoco.mj_jacBody(peer, data, moving, turning, peer.body("foot").id)
        np.testing.assert_allclose(
            dynamics.jacobian(data.qpos, "foot"), np.vstack([turning, moving]), rtol=1e-9, atol=1e-9
        )


def test_a_force_at_a_point_acts_through_the_jacobian():
    """m g at the centre of mass of a free box, upwards, lets it hover."""
    builder = kn.Builder("box", gravity=(0, -9.81, 0))
    solid = builder.object("box")
    box = solid.body("box", [kn.Geometry.box((0.1, 0.2, 0.3))], position=(0, 1, 0), mass=24.0)
    solid.free("free", box)
    model = builder.build()
    sim, dynamics = kn.Simulation(model, worlds=3, dt=0.01, dtype="float64"), kn.Dynamics(model)
    weight = 24.0 * np.array([0.0, 9.81, 0.0])
    jacobian = dynamics.jacobian(sim.state.joint_position, "box")
    sim.controls.force[:] = np.einsum("wij,i->wj", jacobian, np.concatenate([np.zeros(3), weight]))
    sim.step(50)
    np.testing.assert_allclose(sim.state.body_position[:, "box"], [[0, 1, 0]] * 3, atol=1e-9)


def test_what_makes_no_sense_is_told(humanoid):
    dynamics, q = kn.Dynamics(humanoid), humanoid.initial_position
    with pytest.raises(ShapeError, match=r"position has the shape \(3,\), which does not broadcast to \(24,\)"):
        dynamics.mass_matrix([1.0, 2.0, 3.0])
    with pytest.raises(ShapeError, match=r"velocity has the shape \(4,\)"):
        dynamics.inverse_dynamics(q, np.zeros(4))
    with pytest.raises(ShapeError, match=r"does not go together: position \(2, 24\), velocity \(3, 23\)"):
        dynamics.inverse_dynamics(np.tile(q, (2, 1)), np.zeros((3, 23)))
    with pytest.raises(ShapeError, match="position is of dtype"):
        dynamics.mass_matrix(["a"])
    broken = np.tile(q, (4, 1))
    broken[2, 5] = np.nan
    with pytest.raises(SimulationError, match="row 2: number 5 of the coordinates is NaN: give finite numbers"):
        dynamics.mass_matrix(broken)
    broken[2, 3:7] = 0.0
    with pytest.raises(SimulationError, match="row 2: coordinates 3 to 6 are a quaternion, and zero"):
        dynamics.mass_matrix(broken)
    with pytest.raises(ShapeError, match=r"point has the shape \(2,\), which does not broadcast to \(3,\)"):
        dynamics.jacobian(q, 0, [1.0, 2.0])
    with pytest.raises(SimulationError, match="coordinates of the point"):
        dynamics.jacobian(q, 0, [np.inf, 0, 0])
    with pytest.raises(UnknownNameError, match=r'"left_food".*left_foot'):
        dynamics.jacobian(q, "left_food")
    with pytest.raises(OutOfRangeError, match="body 99 does not exist: the model has 13"):
        dynamics.jacobian(q, 99)
    with pytest.raises(OutOfRangeError, match="body -1 does not exist"):
        dynamics.jacobian(q, -1)
    with pytest.raises(SimulationError, match=r"closes a loop .* takes trees alone"):
        kn.Dynamics(kn.examples.linkage())
