"""Arrays as torch and jax take them. `cargo xtask test learning` installs both."""

import numpy as np
import pytest

import kinetarium as kn


@pytest.fixture
def sim():
    return kn.Simulation(kn.examples.n_pendula(3), worlds=16)


def test_torch_shares_what_can_be_written(sim):
    torch = pytest.importorskip("torch", reason="torch is not installed")
    force = torch.from_dlpack(sim.controls.force)
    assert force.data_ptr() == sim.controls.force.ctypes.data
    force[:, 1] = 2.0
    np.testing.assert_array_equal(sim.controls.force[:, 1], 2.0)
    read = sim.state.read("joint_position")
    assert torch.from_dlpack(read).data_ptr() == read.ctypes.data
    shown = sim.state.joint_position
    copied = torch.from_dlpack(shown)
    copied.zero_()
    sim.step()
    assert np.abs(shown).max() > 0 and not np.shares_memory(copied.numpy(), shown)


def test_torch_sets_states_and_controls(sim):
    torch = pytest.importorskip("torch", reason="torch is not installed")
    position = torch.linspace(-1, 1, 48).reshape(16, 3)
    sim.set_state(position, torch.zeros(16, 3))
    np.testing.assert_allclose(sim.state.joint_position, position, rtol=1e-6)
    sim.controls.force[:, "hinge1"] = torch.ones(16)
    np.testing.assert_array_equal(sim.controls.force[:, 1], 1.0)
    sim.reset(worlds=torch.arange(16) > 7)
    np.testing.assert_allclose(sim.state.joint_position[:8], position[:8], rtol=1e-6)
    begun = np.tile(sim.model.initial_position, (8, 1))
    np.testing.assert_allclose(sim.state.joint_position[8:], begun, rtol=1e-6)


def test_jax_takes_what_is_read_without_a_copy(sim):
    jax = pytest.importorskip("jax", reason="jax is not installed")
    read = sim.state.read("joint_position")
    taken = jax.numpy.from_dlpack(read)
    assert taken.unsafe_buffer_pointer() == read.ctypes.data
    height = jax.jit(lambda q: jax.numpy.cos(q).sum(axis=1))(jax.numpy.asarray(sim.state.joint_position))
    np.testing.assert_allclose(height, np.cos(read).sum(axis=1), rtol=1e-6)


def test_jax_sets_states_and_controls(sim):
    jax = pytest.importorskip("jax", reason="jax is not installed")
    position = jax.random.uniform(jax.random.key(0), (16, 3))
    sim.set_state(position)
    np.testing.assert_allclose(sim.state.joint_position, position, rtol=1e-6)
    sim.controls.force[:] = jax.numpy.full((16, 3), 0.5)
    np.testing.assert_array_equal(sim.controls.force, 0.5)
    sim.reset(worlds=jax.numpy.arange(16) > 7)
    np.testing.assert_allclose(sim.state.joint_position[:8], position[:8], rtol=1e-6)
