"""Worlds on a graphics card: one that KINETARIUM_GPU names, or a program such as Mesa's llvmpipe, or "cuda"."""

import copy
import ctypes
import importlib.util
import os

import numpy as np
import pytest

import kinetarium as kn
from kinetarium import _nvrtc
from kinetarium.errors import DeviceError, UnknownNameError

CARD = os.environ.get("KINETARIUM_GPU")
DEVICE = "cuda" if CARD == "cuda" else f"gpu:{CARD}"
needs_a_card = pytest.mark.skipif(CARD is None, reason="KINETARIUM_GPU names no card")
needs_cuda = pytest.mark.skipif(CARD != "cuda", reason="KINETARIUM_GPU is not cuda")


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


@needs_cuda
def test_simulations_share_what_is_compiled(monkeypatch):
    training = on(DEVICE)
    training.step()
    speeds = training.state.joint_velocity
    # What stands in for NVRTC finds no compiler any more.
    monkeypatch.setenv("PATH", "")
    evaluation = on("auto")
    evaluation.step()
    assert evaluation.device == training.device
    np.testing.assert_array_equal(evaluation.state.joint_velocity, speeds)


@needs_a_card
def test_what_a_card_does_not_take_is_refused():
    with pytest.raises(DeviceError, match="single precision"):
        on(DEVICE, dtype="float64")


@needs_a_card
def test_one_world_of_many_bodies():
    model = kn.examples.ragdolls(2)
    card, cpu = (kn.Simulation(model, worlds=1, device=device) for device in (DEVICE, "cpu"))
    assert (card.solver, cpu.solver, cpu.left_to_processor) == ("impulse", "impulse", 0)
    for sim in (card, cpu):
        sim.step(20)
    np.testing.assert_allclose(card.state.body_position, cpu.state.body_position, atol=1e-3)
    assert 0 <= card.left_to_processor < 20
    with pytest.raises(DeviceError, match="by featherstone or xpbd"):
        card.state.on_device("body_position")


@needs_cuda
def test_auto_leaves_piles_to_the_processor():
    assert "(CUDA)" in on("auto").device
    sim = kn.Simulation(kn.examples.ragdolls(2), device="auto")
    assert (sim.solver, sim.device) == ("impulse", "cpu")


def test_auto_takes_no_program_and_never_fails():
    assert "llvmpipe" not in on("auto").device
    assert on("auto", dtype="float64").device == "cpu"


def test_a_card_that_is_not_there_is_told():
    with pytest.raises(DeviceError, match="no graphics card has `no such card` in its name; found: "):
        on("gpu:no such card")
    with pytest.raises(DeviceError, match="unknown device `tpu`; known are cpu, auto, gpu"):
        on("tpu")


def there(array) -> np.ndarray:
    """The numbers of a card's array: by torch, or where they lie if what stands in for a card uses host memory."""
    if importlib.util.find_spec("torch"):
        import torch

        return torch.as_tensor(array, device="cuda").cpu().numpy()
    interface = array.__cuda_array_interface__
    assert (interface["version"], interface["typestr"], interface["stream"]) == (3, "<f4", None)
    shape, strides = interface["shape"], interface["strides"]
    last = sum((n - 1) * stride for n, stride in zip(shape, strides, strict=True))
    memory = (ctypes.c_byte * (last + 4)).from_address(interface["data"][0])
    return np.ndarray(shape, np.float32, memory, strides=strides)


@needs_cuda
@pytest.mark.parametrize(
    "quantity", ["joint_position", "body_position", "body_orientation", "kinetic_energy", "momentum"]
)
def test_a_card_shares_what_is_reported(quantity):
    card = on(DEVICE)
    card.step(30)
    array = card.state.on_device(quantity)
    read = getattr(card.state, quantity)
    assert array.shape == read.shape
    assert str(list(array.shape)) in repr(array)
    assert not array.__cuda_array_interface__["data"][1], "torch takes no array that is said to be read-only"
    np.testing.assert_array_equal(there(array), read)


@needs_cuda
def test_controls_are_written_on_the_card():
    card, cpu = on(DEVICE), on("cpu")
    pushes = np.random.default_rng(1).normal(size=(40, 3)).astype(np.float32)
    force = card.controls.on_device("force")
    np.testing.assert_array_equal(there(force), cpu.controls.force)
    if importlib.util.find_spec("torch"):
        import torch

        torch.as_tensor(force, device="cuda")[:] = torch.as_tensor(pushes, device="cuda")
    else:
        there(force)[:] = pushes
    cpu.controls.force[:] = pushes
    # What the host sets of others leaves it alone.
    for sim in (card, cpu):
        sim.controls.target_position[:] = 0.0
        sim.step(25)
    np.testing.assert_array_equal(card.state.joint_position, cpu.state.joint_position)


@needs_cuda
def test_what_was_written_on_the_card_is_known():
    card = on(DEVICE)
    force = card.controls.on_device("force")

    def write(x: float) -> None:
        if importlib.util.find_spec("torch"):
            import torch

            torch.as_tensor(force, device="cuda")[:] = x
        else:
            there(force)[:] = x

    def all_of(x: float) -> np.ndarray:
        return np.full((40, 3), x, np.float32)

    write(5.0)
    # A world that is reset starts with the model's controls; the others keep theirs.
    card.reset([3])
    expected = all_of(5.0)
    expected[3] = 0.0
    np.testing.assert_array_equal(there(force), expected)
    taken = card.snapshot()
    # What is written after that acts.
    card.reset([4])
    write(7.0)
    card.step()
    np.testing.assert_array_equal(there(force), all_of(7.0))
    card.restore(taken)
    card.step()
    np.testing.assert_array_equal(there(force), expected)
    # Of a keyframe's controls no array comes, whose numbers would act from then on.
    card.set_state(np.zeros(3))
    np.testing.assert_array_equal(there(force), all_of(0.0))
    write(5.0)
    card.reset([3])
    # From here on the host's acts.
    np.testing.assert_array_equal(card.controls.force, expected)
    write(8.0)
    card.step()
    np.testing.assert_array_equal(there(force), expected)


class Tensor(ctypes.Structure):
    """`DLTensor`."""

    _fields_ = (
        ("data", ctypes.c_void_p),
        ("device_type", ctypes.c_int32),
        ("device_id", ctypes.c_int32),
        ("ndim", ctypes.c_int32),
        ("code", ctypes.c_uint8),
        ("bits", ctypes.c_uint8),
        ("lanes", ctypes.c_uint16),
        ("shape", ctypes.POINTER(ctypes.c_int64)),
        ("strides", ctypes.POINTER(ctypes.c_int64)),
        ("byte_offset", ctypes.c_uint64),
    )


class Managed(ctypes.Structure):
    """`DLManagedTensor`."""

    _fields_ = (
        ("tensor", Tensor),
        ("context", ctypes.c_void_p),
        ("deleter", ctypes.CFUNCTYPE(None, ctypes.c_void_p)),
    )


@needs_cuda
def test_a_reader_of_dlpack_gets_the_same():
    card = on(DEVICE)
    card.step(10)
    array = card.state.on_device("body_position")
    interface = array.__cuda_array_interface__
    assert array.__dlpack_device__() == (2, 0)
    for _ in range(3):
        array.__dlpack__()  # that nobody takes
    capsule = array.__dlpack__(stream=1, max_version=(1, 0), dl_device=(2, 0), copy=False)
    pointer = ctypes.pythonapi.PyCapsule_GetPointer
    pointer.restype, pointer.argtypes = ctypes.c_void_p, (ctypes.py_object, ctypes.c_char_p)
    managed = ctypes.cast(pointer(capsule, b"dltensor"), ctypes.POINTER(Managed)).contents
    tensor = managed.tensor
    assert tensor.data == interface["data"][0]
    assert (tensor.device_type, tensor.device_id, tensor.ndim, tensor.byte_offset) == (2, 0, 3, 0)
    assert (tensor.code, tensor.bits, tensor.lanes) == (2, 32, 1)
    assert tuple(tensor.shape[:3]) == array.shape
    assert tuple(4 * n for n in tensor.strides[:3]) == interface["strides"]
    # As a reader takes it: the simulation's memory lasts until it lets go.
    rename = ctypes.pythonapi.PyCapsule_SetName
    rename.argtypes = (ctypes.py_object, ctypes.c_char_p)
    name = ctypes.c_char_p(b"used_dltensor")
    rename(capsule, name)
    expected = np.array(card.state.body_position)
    card.close()
    del card, capsule
    np.testing.assert_array_equal(there(array), expected)
    managed.deleter(ctypes.addressof(managed))


@needs_a_card
def test_what_is_not_shared_is_told():
    card = on(DEVICE)
    with pytest.raises(UnknownNameError, match="no quantity"):
        card.state.on_device("joint_positions")
    with pytest.raises(UnknownNameError, match="no control"):
        card.controls.on_device("forces")
    with pytest.raises(DeviceError, match=r"ContactWrench cannot be shared .* worked out on the host"):
        card.state.on_device("contact_wrench")
    for sim in [on("cpu"), *([] if CARD == "cuda" else [card])]:
        for ask in (lambda s: s.state.on_device("joint_position"), lambda s: s.controls.on_device("force")):
            with pytest.raises(DeviceError, match="run on the device cuda"):
                ask(sim)
    with pytest.raises(DeviceError, match="double precision"):
        on("cpu", dtype="float64").state.on_device("joint_position")


def test_a_control_that_is_not_shared_still_acts():
    sim, twin = on("cpu"), on("cpu")
    force = sim.controls.force
    with pytest.raises(DeviceError):
        sim.controls.on_device("force")
    for array in (force, twin.controls.force):
        array[:] = 2.0
    for one in (sim, twin):
        one.step()
    np.testing.assert_array_equal(sim.state.joint_velocity, twin.state.joint_velocity)


@pytest.mark.skipif(importlib.util.find_spec("nvidia") is None, reason="no package of NVIDIA's is installed")
def test_the_compiler_that_pip_installed_is_found():
    assert "nvrtc" in _nvrtc.load().name


@pytest.mark.skipif(_nvrtc.has_driver(), reason="there is a driver")
def test_a_driver_that_is_missing_is_told():
    with pytest.raises(DeviceError, match="no CUDA driver was found"):
        on("cuda")
