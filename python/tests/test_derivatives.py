"""A step linearised: closed form, differences, MuJoCo, and a regulator that balances."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import kinetarium as kn
from kinetarium.errors import SimulationError

EXAMPLES = Path(__file__).parents[1] / "examples"


def test_a_pendulum_in_symbols():
    # Semi-implicit Euler of I θ'' = τ(θ) + u: θ̇' = θ̇ + h (τ + u) / I, θ' = θ + h θ̇', so that
    # A = [[1 + h² k, h], [h k, 1]] with k = ∂τ/∂θ / I, and B = [h², h] / I.
    sim = kn.Simulation(kn.examples.n_pendula(1), dt=0.01, dtype="float64")
    step = sim.linearize()
    h = 0.01
    hk = step.state[1, 0]
    np.testing.assert_allclose(step.state, [[1 + h * hk, h], [hk, 1.0]], atol=1e-12)
    np.testing.assert_allclose(step.force[0], h * step.force[1], atol=1e-12)


def test_against_differences():
    model = kn.examples.n_pendula(3)
    rng = np.random.default_rng(1)
    q, v, force = rng.normal(size=(3, 3))

    def after(x, f):
        sim = kn.Simulation(model, dt=0.005, dtype="float64")
        sim.set_state(x[:3], x[3:])
        sim.controls.force = f
        sim.step()
        return np.concatenate([sim.state.joint_position[0], sim.state.joint_velocity[0]])

    sim = kn.Simulation(model, dt=0.005, dtype="float64")
    sim.set_state(q, v)
    sim.controls.force = force
    step = sim.linearize()
    x, e = np.concatenate([q, v]), 1e-6
    a = [(after(x + e * d, force) - after(x - e * d, force)) / (2 * e) for d in np.eye(6)]
    b = [(after(x, force + e * d) - after(x, force - e * d)) / (2 * e) for d in np.eye(3)]
    # Central differences: ε² of truncation, 1e-16 / ε of rounding.
    np.testing.assert_allclose(step.state, np.array(a).T, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(step.force, np.array(b).T, rtol=1e-6, atol=1e-8)


def test_other_solvers_say_so():
    with pytest.raises(SimulationError, match="featherstone"):
        kn.Simulation(kn.examples.n_pendula(2), solver="xpbd").linearize()


def test_the_regulator_balances(capsys):
    runpy.run_path(str(EXAMPLES / "lqr.py"), run_name="__main__")
    told = capsys.readouterr().out
    assert "with the regulator: 64 of 64 worlds upright after 5 s" in told
    assert "without: 0 of 64 worlds upright after 5 s" in told
