"""Arrays of all worlds: what is set arrives, and nothing else; names; memory that others take."""

import copy

import numpy as np
import pytest

import kinetarium as kn
from kinetarium.errors import UnknownNameError


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


def test_several_names_come_in_any_form(sim):
    force, q = sim.controls.force, sim.state.joint_position
    expected = np.asarray(q)[:, [2, 0]]
    for names in (["hinge2", "hinge0"], ("hinge2", "hinge0"), np.array(["hinge2", "hinge0"])):
        assert (q[:, names] == expected).all()
        force[...] = 0.0
        force[:, names] = (1.0, 2.0)
        assert (force == (2.0, 0.0, 1.0)).all()
    with pytest.raises(UnknownNameError, match='did you mean "hinge1"'):
        force[:, ("hinge0", "hinge_1")]


def test_copies_keep_names(sim):
    for array in (sim.state.joint_position, sim.controls.force):
        for own in (
            array.copy(),
            array.astype(float),
            array.astype(array.dtype, copy=False),
            copy.copy(array),
            copy.deepcopy(array),
            array.copy().copy(order="F"),
        ):
            assert (own[:, "hinge1"] == np.asarray(array)[:, 1]).all()
    own = sim.state.joint_position.copy()
    own[:, "hinge0"] = 0.5
    assert (own[:, 0] == 0.5).all() and not (sim.state.joint_position[:, 0] == 0.5).any()


def test_what_has_no_names_says_so(sim):
    for array in (
        sim.state.body_position[0:2],
        sim.controls.force[0],
        sim.controls.force.T,
        sim.state.joint_position.copy()[1:],
        sim.state.momentum,
    ):
        for key in ("link1", ["link1"], (0, "link1")):
            with pytest.raises(UnknownNameError, match=r"has no names: give numbers instead of .*, or all indices"):
                array[key]
    with pytest.raises(UnknownNameError, match="has no names"):
        sim.controls.force[0]["hinge0"] = 1.0


def test_arithmetic_gives_plain_numbers(sim):
    for array in (sim.state.joint_position, sim.controls.force, sim.controls.force[0]):
        assert type(array + 1) is np.ndarray and type(np.sin(array)) is np.ndarray
        assert type(array.sum()) is sim.dtype.type and type(array.max(axis=0)) in (np.ndarray, sim.dtype.type)
    assert repr(sim.controls.force[0, 1:]).startswith("array(")
