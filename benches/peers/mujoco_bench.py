"""MuJoCo's side of `cargo xtask bench`.

`prepare` writes the chain models and `cases.json` (what to simulate, and where the tip of a chain must be
after one second); `measure` runs every case once and prints one JSON record a line. Batches go through
`mujoco.rollout`. Without contacts, every run starts anew after `RESTART_STEPS`, so
that none leaves the range in which explicit steps are stable; constraints are off, but for joint limits where
these are the case. With contacts, a run is as long as a robot
takes to fall and lie, and is driven by random controls.
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
FALL_STEPS = 400
MEASURED_SECONDS = 1.0

# How exactly robots that touch the ground are simulated: their joints after so long, against finer steps.
ERROR_WORLDS = 256
ERROR_STEPS = 100
FINER = 16

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


def load(path: str, integrator: str, timestep: float, contacts: str = "none") -> mujoco.MjModel:
    """Loads a model whose bodies touch nothing ("none" and "limits", with joint limits), the ground, or all."""
    model = mujoco.MjModel.from_xml_path(path)
    model.opt.integrator = INTEGRATORS[integrator]
    model.opt.timestep = timestep
    if not touches(contacts):
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    if contacts == "none":
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    elif contacts == "ground":
        model.geom_contype[:] = model.geom_bodyid == 0
        model.geom_conaffinity[:] = model.geom_bodyid != 0
    return model


def touches(contacts: str) -> bool:
    """Whether bodies touch anything."""
    return contacts in ("ground", "all")


def random_controls(model: mujoco.MjModel, worlds: int, intervals: int) -> np.ndarray:
    """Controls over the whole range, of intervals of `ROLLOUT_STEPS`."""
    low, high = model.actuator_ctrlrange.T
    rng = np.random.default_rng(1)
    return rng.uniform(low, high, size=(worlds, intervals, model.nu))


def held(controls: np.ndarray) -> np.ndarray:
    """The controls of every step."""
    return np.repeat(controls, ROLLOUT_STEPS, axis=1)


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
        "contacts": "none",
        "tip": tip,
        "controls": [],
    }


def humanoid_case(name: str, contacts: str) -> dict:
    """Gymnasium's humanoid, driven by random torques; constant ones where it touches nothing.

    `controls`, by interval, world and actuator, are those under which its error is measured.
    """
    path = Path(gymnasium.__file__).parent / "envs/mujoco/assets/humanoid.xml"
    model = mujoco.MjModel.from_xml_path(str(path))
    controls = random_controls(model, ERROR_WORLDS, ERROR_STEPS // ROLLOUT_STEPS)
    return {
        "case": name,
        "path": str(path),
        "timestep": HUMANOID_STEP,
        "methods": ["euler"],
        "contacts": contacts,
        "tip": None,
        "controls": controls.swapaxes(0, 1).tolist() if touches(contacts) else [],
    }


def prepare(folder: Path) -> None:
    """Writes the models and `cases.json` into the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    cases = [chain_case(links, folder) for links in CHAIN_LINKS]
    cases.append(humanoid_case("humanoid", "none"))
    cases.append(humanoid_case("humanoid, limits", "limits"))
    cases.append(humanoid_case("humanoid on the ground", "ground"))
    cases.append(humanoid_case("humanoid, all contacts", "all"))
    (folder / "cases.json").write_text(json.dumps(cases, indent=1))


def repetitions_per_second(run_once: Callable[[], None]) -> float:
    """Calls the function once to warm up, then for `MEASURED_SECONDS`."""
    run_once()
    begin, repetitions = time.perf_counter(), 0
    while (elapsed := time.perf_counter() - begin) < MEASURED_SECONDS:
        run_once()
        repetitions += 1
    return repetitions / elapsed


def batch_speed(model: mujoco.MjModel, contacts: str) -> float:
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
    if not touches(contacts):
        steps = RESTART_STEPS
        drawn = 0.1 * rng.normal(size=(WORLDS, 1, model.nu))
        control = np.repeat(drawn, steps, axis=1)
    else:
        steps = FALL_STEPS
        control = held(random_controls(model, WORLDS, steps // ROLLOUT_STEPS))

    with mujoco.rollout.Rollout(nthread=THREADS) as pool:

        def run_once() -> None:
            current = initial
            for i in range(0, steps, ROLLOUT_STEPS):
                part = np.ascontiguousarray(control[:, i : i + ROLLOUT_STEPS])
                pool.rollout(model, data, current, part, state=states, sensordata=sensors)
                current = states[:, -1].copy()

        return WORLDS * steps * repetitions_per_second(run_once)


def single_speed(model: mujoco.MjModel, contacts: str) -> float:
    """Steps per second of one world on one thread, stepped inside MuJoCo without returning to Python."""
    data = mujoco.MjData(model)
    steps = FALL_STEPS if touches(contacts) else RESTART_STEPS
    intervals = steps // ROLLOUT_STEPS
    control = random_controls(model, 1, intervals)[0]
    if not touches(contacts):
        control = np.zeros_like(control)

    def run_once() -> None:
        mujoco.mj_resetData(model, data)
        for torques in control:
            data.ctrl[:] = torques
            mujoco.mj_step(model, data, nstep=ROLLOUT_STEPS)

    return steps * repetitions_per_second(run_once)


def joint_error(case: dict, method: str) -> float:
    """Median over worlds of the root mean square difference [m and rad] of the joints to `FINER` steps."""
    ends = []
    for finer in (1, FINER):
        model = load(case["path"], method, case["timestep"] / finer, case["contacts"])
        data = mujoco.MjData(model)
        end = []
        for control in np.array(case["controls"]).swapaxes(0, 1):
            mujoco.mj_resetData(model, data)
            for torques in control:
                data.ctrl[:] = torques
                mujoco.mj_step(model, data, nstep=ROLLOUT_STEPS * finer)
            end.append(data.qpos.copy())
        ends.append(np.array(end))
    return float(np.median(np.sqrt(np.mean((ends[0] - ends[1]) ** 2, axis=1))))


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
            contacts = case["contacts"]
            model = load(case["path"], method, case["timestep"], contacts)
            tip = case["tip"]
            error = tip and float(np.linalg.norm(tip_position(model, tip) - tip["reference"]))
            if touches(contacts):
                error = joint_error(case, method)
            shared = {"kind": "speed", "case": name, "method": method, "error": error}
            speed = batch_speed(model, contacts)
            yield shared | {"worlds": WORLDS, "threads": THREADS, "steps_per_second": speed}
            speed = single_speed(model, contacts)
            yield shared | {"worlds": 1, "threads": 1, "steps_per_second": speed}


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
