"""MuJoCo's side of `cargo xtask bench`.

`prepare` writes the chain models and `cases.json` (what to simulate, and where the tip of a chain must be
after one second); `measure` runs every case once and prints one JSON record a line. Contacts and constraints
are off; batches go through `mujoco.rollout`. Every run starts anew after `RESTART_STEPS`, so that none leaves
the range in which explicit steps are stable.
"""

import argparse
import json
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import gymnasium
import mujoco
import mujoco.rollout
import numpy as np

LINK_LENGTH = 0.2  # m
CHAIN_RADIUS = 0.02  # m
LINK_MASS = 1.0  # kg
CHAIN_LINKS = (10, 30)
CHAIN_STEP = 2e-3  # s
HUMANOID_STEP = 3e-3  # s
REFERENCE_STEP = 2e-5  # s
TIP_TIME = 1.0  # s

WORLDS = 4096
THREADS = 2
ROLLOUT_STEPS = 20  # steps per call of rollout, which bounds the size of its output
RESTART_STEPS = 80
MEASURED_SECONDS = 1.0

INTEGRATORS = {"euler": mujoco.mjtIntegrator.mjINT_EULER, "rk4": mujoco.mjtIntegrator.mjINT_RK4}


def chain_mjcf(links: int) -> str:
    """Uniform rods hung in series on hinges about y, lying along x; gravity along -z."""
    across = LINK_MASS * LINK_LENGTH**2 / 12
    along = LINK_MASS * CHAIN_RADIUS**2 / 2
    inertia = f'mass="{LINK_MASS}" diaginertia="{along} {across} {across}"'
    opening = "".join(
        f'<body name="link{i}" pos="{LINK_LENGTH if i else 0} 0 0">'
        f'<joint name="hinge{i}" type="hinge" axis="0 1 0"/>'
        f'<inertial pos="{LINK_LENGTH / 2} 0 0" {inertia}/>\n'
        for i in range(links)
    )
    return (
        f'<mujoco model="chain_{links}">\n'
        f'<option timestep="{CHAIN_STEP}" gravity="0 0 -9.81"/>\n'
        f"<worldbody>\n{opening}{'</body>' * links}\n</worldbody>\n"
        "</mujoco>\n"
    )


def load(path: str, integrator: str, timestep: float) -> mujoco.MjModel:
    """Loads a model with contacts and constraints switched off."""
    model = mujoco.MjModel.from_xml_path(path)
    model.opt.integrator = INTEGRATORS[integrator]
    model.opt.timestep = timestep
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    return model


def tip_position(model: mujoco.MjModel, tip: dict) -> np.ndarray:
    """The tip [m] after `TIP_TIME`, started from the model's own configuration at rest."""
    data = mujoco.MjData(model)
    for _ in range(round(TIP_TIME / model.opt.timestep)):
        mujoco.mj_step(model, data)
    mujoco.mj_kinematics(model, data)
    body = data.body(tip["body"])
    return body.xpos + body.xmat.reshape(3, 3) @ np.array(tip["offset"])


def chain_case(links: int, out: Path) -> dict:
    """Writes a chain's model and works out where its tip goes (RK4 at `REFERENCE_STEP`)."""
    path = out / f"chain_{links}.xml"
    path.write_text(chain_mjcf(links))
    tip = {"body": f"link{links - 1}", "offset": [LINK_LENGTH, 0, 0], "time": TIP_TIME}
    reference = tip_position(load(str(path), "rk4", REFERENCE_STEP), tip)
    tip["reference"] = reference.tolist()
    return {
        "case": path.stem,
        "path": str(path.resolve()),
        "timestep": CHAIN_STEP,
        "methods": ["euler", "rk4"],
        "tip": tip,
    }


def humanoid_case() -> dict:
    """Gymnasium's humanoid, driven by constant random torques."""
    path = Path(gymnasium.__file__).parent / "envs/mujoco/assets/humanoid.xml"
    return {
        "case": "humanoid",
        "path": str(path),
        "timestep": HUMANOID_STEP,
        "methods": ["euler"],
        "tip": None,
    }


def prepare(folder: Path) -> None:
    """Writes the models and `cases.json` into the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    cases = [chain_case(links, folder) for links in CHAIN_LINKS] + [humanoid_case()]
    (folder / "cases.json").write_text(json.dumps(cases, indent=1))


def repetitions_per_second(run_once: Callable[[], None]) -> float:
    """Calls the function once to warm up, then for `MEASURED_SECONDS`."""
    run_once()
    begin, repetitions = time.perf_counter(), 0
    while (elapsed := time.perf_counter() - begin) < MEASURED_SECONDS:
        run_once()
        repetitions += 1
    return repetitions / elapsed


def batch_speed(model: mujoco.MjModel) -> float:
    """World-steps per second of `WORLDS` worlds on `THREADS` threads, each started a little differently."""
    rng = np.random.default_rng(1)
    data = [mujoco.MjData(model) for _ in range(THREADS)]
    full_physics = mujoco.mjtState.mjSTATE_FULLPHYSICS
    start = np.empty(mujoco.mj_stateSize(model, full_physics))
    mujoco.mj_getState(model, data[0], start, full_physics)
    initial = np.tile(start, (WORLDS, 1))
    initial[:, -model.nv :] += 0.01 * rng.normal(size=(WORLDS, model.nv))
    states = np.zeros((WORLDS, ROLLOUT_STEPS, start.size))
    sensors = np.zeros((WORLDS, ROLLOUT_STEPS, model.nsensordata))

    control = np.repeat(0.1 * rng.normal(size=(WORLDS, 1, model.nu)), ROLLOUT_STEPS, axis=1)

    with mujoco.rollout.Rollout(nthread=THREADS) as pool:

        def run_once() -> None:
            current = initial
            for _ in range(RESTART_STEPS // ROLLOUT_STEPS):
                pool.rollout(model, data, current, control, state=states, sensordata=sensors)
                current = states[:, -1].copy()

        return WORLDS * RESTART_STEPS * repetitions_per_second(run_once)


def single_speed(model: mujoco.MjModel) -> float:
    """Steps per second of one world on one thread, stepped inside MuJoCo without returning to Python."""
    data = mujoco.MjData(model)

    def run_once() -> None:
        mujoco.mj_resetData(model, data)
        mujoco.mj_step(model, data, nstep=RESTART_STEPS)

    return RESTART_STEPS * repetitions_per_second(run_once)


def load_seconds(path: str) -> float:
    """From the file to the end of the first step [s]."""
    begin = time.perf_counter()
    model = mujoco.MjModel.from_xml_path(path)
    mujoco.mj_step(model, mujoco.MjData(model))
    return time.perf_counter() - begin


def world_bytes(path: str) -> int:
    """Size of one world's data [byte], its arena for contacts left out."""
    return mujoco.MjData(mujoco.MjModel.from_xml_path(path)).nbuffer


def measure(folder: Path) -> Iterator[dict]:
    """Runs every case once."""
    for case in json.loads((folder / "cases.json").read_text()):
        name = case["case"]
        yield {"kind": "load", "case": name, "seconds": load_seconds(case["path"])}
        yield {"kind": "memory", "case": name, "bytes": world_bytes(case["path"])}
        for method in case["methods"]:
            model = load(case["path"], method, case["timestep"])
            tip = case["tip"]
            error = tip and float(np.linalg.norm(tip_position(model, tip) - tip["reference"]))
            shared = {"kind": "speed", "case": name, "method": method, "tip_error": error}
            yield shared | {"worlds": WORLDS, "threads": THREADS, "steps_per_second": batch_speed(model)}
            yield shared | {"worlds": 1, "threads": 1, "steps_per_second": single_speed(model)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", choices=["prepare", "measure"])
    parser.add_argument("folder", type=Path, help="where cases.json and the models are")
    arguments = parser.parse_args()
    if arguments.command == "prepare":
        prepare(arguments.folder)
        return
    for record in measure(arguments.folder):
        print(json.dumps(record), flush=True)


if __name__ == "__main__":
    main()
