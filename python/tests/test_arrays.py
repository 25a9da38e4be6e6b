"""Arrays of all worlds: what is set arrives, and nothing else; names; memory that others take."""

import numpy as np
import pytest

import kinetarium as kn


@pytest.fixture(params=["float32", "float64"])
def sim(request):
    return kn.Simulation(kn.examples.n_pendula(3), worlds=4, dt=0.002, dtype=request.param)


def test_what_is_as_it_shall_be_can_be_assigned(sim):
    for name in ("gravity", "body_mass", "body_inertia", "damping", "gear"):
        before = np.array(getattr(sim.parameters, name))
        setattr(sim.parameters, name, before)
        array = getattr(sim.parameters, name)
        array[0] = array[0]
        array[[]] = 1.0
        assert (getattr(sim.parameters, name) == before).all()
    sim.parameters.gravity = (0, -9.81, 0)
    sim.parameters.body_mass *= 1.0
    sim.state.joint_position = sim.state.joint_position
    sim.state.joint_position[[]] = 1.0


def test_items_are_set_to_what_an_older_array_holds(sim):
    for table, name in (
        (sim.state, "joint_position"),
        (sim.state, "joint_velocity"),
        (sim.parameters, "body_mass"),
    ):
        older = getattr(table, name)
        was = older[0, 0]
        getattr(table, name)[0] = 0.5
        older[0, 0] = was
        now = getattr(table, name)
        assert now[0, 0] == was and (now[0, 1:] == 0.5).all(), name


def test_a_mask_chooses_items(sim):
    chosen = np.zeros((4, 3), bool)
    chosen[2, 1] = chosen[3, 0] = True
    expected = np.where(chosen, 0.25, sim.state.joint_position)
    sim.state.joint_position[chosen] = 0.25
    assert (sim.state.joint_position == expected).all()
