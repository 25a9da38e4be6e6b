"""Arrays of all worlds: what is set arrives, and nothing else; names; memory that others take."""

import copy
import inspect
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import kinetarium as kn
from kinetarium.errors import BusyError, ShapeError, UnknownNameError
from kinetarium.tables import tables_of


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


def test_a_sensor_changes_nothing_while_it_measures():
    changes = (
        lambda s: setattr(s.state, "joint_position", 0.5),
        lambda s: s.state.joint_velocity.__setitem__((0, 0), 0.5),
        lambda s: setattr(s.parameters, "gravity", 0.0),
        lambda s: s.parameters.body_mass.__setitem__((0, 0), 5.0),
        lambda s: setattr(s.controls, "force", 1.0),
    )
    for change in changes:
        sensor = kn.sensors.Custom("own", lambda s, change=change: (s.time[0] > 0 and change(s), s.time)[1])
        sim = kn.Simulation(kn.examples.n_pendula(2), sensors=[sensor])
        twin = kn.Simulation(kn.examples.n_pendula(2))
        with pytest.raises(BusyError, match="it may only read it"):
            sim.step()
        twin.step()
        assert sim.snapshot() == twin.snapshot()
        assert (sim.parameters.body_mass == twin.parameters.body_mass).all()
        assert (sim.parameters.gravity == twin.parameters.gravity).all()
        change(sim)


def test_a_mask_chooses_items(sim):
    chosen = np.zeros((4, 3), bool)
    chosen[2, 1] = chosen[3, 0] = True
    expected = np.where(chosen, 0.25, sim.state.joint_position)
    sim.state.joint_position[chosen] = 0.25
    assert (sim.state.joint_position == expected).all()


def test_controls_are_taken_without_a_copy(sim):
    force = sim.controls.force
    for taken in (np.from_dlpack(force), np.asarray(memoryview(force)), np.from_dlpack(force[1:])):
        assert np.shares_memory(taken, force) and taken.dtype == sim.dtype
    np.asarray(memoryview(force))[2] = 1.0  # what is written there acts
    sim.step(10)
    v = sim.state.joint_velocity
    assert (v[2] != v[0]).all() and (v[3] == v[0]).all()
    own = sim.state.read("joint_position")
    assert np.shares_memory(np.from_dlpack(own), own)


def test_what_is_read_is_taken_as_a_copy(sim):
    """Whoever takes memory may write to it, as torch does, and it would be in vain."""
    for array in (
        sim.state.joint_position,
        sim.state.body_position[:, "link1"],
        sim.state.body_orientation.T,
        sim.parameters.gravity,
        sim.state.time,
    ):
        before, taken = np.array(array), np.from_dlpack(array)
        assert (taken == before).all() and taken.dtype == array.dtype
        assert not np.shares_memory(taken, array)
        assert taken.ctypes.data % 64 == 0
        assert not np.asarray(memoryview(array)).flags.writeable and array.__array_interface__["data"][1]
        with pytest.raises(BufferError, match="read-only"):
            array.__dlpack__(copy=False)


def test_memory_lies_where_it_is_shared(sim):
    """jax copies what does not lie on 64 bytes."""
    for array in (
        sim.controls.force,
        sim.controls.actuator,
        sim.state.read("body_position"),
        sim.state.read("momentum"),
    ):
        assert array.ctypes.data % 64 == 0 and array.flags.c_contiguous and array.flags.writeable


def test_times_are_read_only(sim):
    sim.step(5)
    for array in (sim.state.time, sim.state.diverged, sim.time):
        with pytest.raises(ShapeError, match="follows from the steps: copy the array"):
            array[0] = 1
        with pytest.raises(ValueError, match="read-only"):
            array.fill(1)
        own = array.copy()
        own[0] = 1
    assert (sim.time == sim.time[0]).all() and not sim.state.diverged.any()


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


def test_what_does_not_fit_is_told_with_the_shapes(sim):
    for array in (sim.controls.force, sim.state.joint_position, sim.state.joint_position.copy()):
        before = np.array(array)
        for key, value, told in (
            (slice(None), [1, 2], r"the value has the shape \(2,\), which does not broadcast to \(\d+, 3\)"),
            ((slice(None), ["hinge0", "hinge2"]), [1, 2, 3], r"\(3,\), which does not broadcast to \(\d+, 2\)"),
            (0, [[1, 2], [3]], "the value is no array"),
            ((0, "hinge1"), "fast", "the value is of dtype <U4: give real numbers"),
        ):
            with pytest.raises(ShapeError, match=told):
                array[key] = value
        assert (array == before).all()
    with pytest.raises(ShapeError, match=r"\(2,\), which does not broadcast to \(3,\)"):
        sim.controls.force[0][:] = [1, 2]
    with pytest.raises(ValueError, match="read-only"):
        sim.state.joint_position[0][:] = [1, 2, 3]


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


def test_attributes_tell_what_they_are(sim):
    for table in (sim.state, sim.controls, sim.parameters):
        for name, attribute in tables_of(type(table)).items():
            assert inspect.isdatadescriptor(attribute) and "shape (worlds" in inspect.getdoc(attribute), name
            assert getattr(table, name).shape == attribute.shape(sim._worlds), name


TYPED = """import numpy as np
import kinetarium as kn

sim = kn.Simulation(kn.examples.n_pendula(3), worlds=2)
sim.controls.force = 0.0
sim.controls.force = [0.0, 1.0, 2.0]
sim.controls.force += 1.0
sim.controls.force[:, "hinge0"] = 1.0
sim.state.joint_position = 0
sim.parameters.gravity = (0, -9.81, 0)
sim.step(np.int64(3))
array: kn.NamedArray = sim.state.joint_position.copy()
sim.state.body_position = 0.0  # type: ignore[assignment]
sim.state.joint_positions  # type: ignore[attr-defined]
"""


def test_types_allow_what_runs(tmp_path, request):
    pytest.importorskip("mypy")
    (tmp_path / "program.py").write_text(TYPED, encoding="utf-8")
    exec(TYPED.split("sim.state.body_position")[0], {})
    cache = request.config.cache.mkdir("mypy")
    options = ["--strict", "--follow-imports=silent", f"--cache-dir={cache}"]
    package = Path(kn.__file__).parents[1]
    environment = os.environ | ({} if package.name == "site-packages" else {"MYPYPATH": str(package)})
    command = [sys.executable, "-m", "mypy", *options, "program.py"]
    found = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environment)
    assert found.returncode == 0, found.stdout + found.stderr
