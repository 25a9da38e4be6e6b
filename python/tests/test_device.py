"""Worlds on a graphics card: one that KINETARIUM_GPU names, or a program such as Mesa's llvmpipe, or "cuda"."""

import copy
import os

import numpy as np
import pytest

import kinetarium as kn
from kinetarium.errors import DeviceError

CARD = os.environ.get("KINETARIUM_GPU")
DEVICE = "cuda" if CARD == "cuda" else f"gpu:{CARD}"
needs_a_card = pytest.mark.skipif(CARD is None, reason="KINETARIUM_GPU names no card")


def on(device: str, **settings: object) -> kn.Simulation:
    sim = kn.Simulation(kn.examples.n_pendula(3), worlds=40, dt=0.002, device=device, **settings)
    sim.controls.force[:, "hinge0"] = np.linspace(0.0, 1.0, 40)
    return sim


@needs_a_card
def test_worlds_move_as_on_the_processor():
    card, cpu = on(DEVICE), on("cpu")
    assert CARD.lower() in card.device.lower() and card.device in repr(card)
    assert cpu.device == "cpu"
    for sim in (card, cpu):
        sim.step(50)
        sim.reset([7])
        sim.controls.force[3] = 0.0
        sim.step(50)
    for what in ("joint_position", "joint_velocity"):
        np.testing.assert_allclose(getattr(card.state, what), getattr(cpu.state, what), atol=1e-3)
    np.testing.assert_allclose(card.state.body_position, cpu.state.body_position, atol=1e-4)
    assert card.state.time[7] == cpu.state.time[7] == pytest.approx(0.1)


@needs_a_card
def test_states_go_to_and_fro():
    card = on(DEVICE)
    card.step(20)
    snapshot = card.snapshot()
    twin = copy.deepcopy(card)
    for sim in (card, twin):
        sim.step(20)
    np.testing.assert_array_equal(card.state.joint_position, twin.state.joint_position)
    cpu = on("cpu")
    cpu.restore(snapshot)
    cpu.step(20)
    np.testing.assert_allclose(card.state.joint_position, cpu.state.joint_position, atol=1e-4)


@needs_a_card
def test_what_a_card_does_not_take_is_refused():
    with pytest.raises(DeviceError, match="single precision"):
        on(DEVICE, dtype="float64")
    with pytest.raises(DeviceError, match="`impulse` does not run on"):
        on(DEVICE, solver="impulse")


def test_auto_takes_no_program_and_never_fails():
    assert "llvmpipe" not in on("auto").device
    assert on("auto", dtype="float64").device == "cpu"


def test_a_card_that_is_not_there_is_told():
    with pytest.raises(DeviceError, match="no graphics card has `no such card` in its name; found: "):
        on("gpu:no such card")
    with pytest.raises(DeviceError, match="unknown device `tpu`; known are cpu, auto, gpu"):
        on("tpu")
