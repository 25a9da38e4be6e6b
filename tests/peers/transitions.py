"""Writes MuJoCo's derivatives of a time step, for the Rust tests to compare with.

For each model of `MODELS`, `<out>/<model>.json` holds random states with A and B of `mjd_transitionFD`
(central differences), and the mean time of one call. Contacts and fluid drag are switched off, and no limit
is active in any state.

The step is Euler's: Kinetarium's semi-implicit Euler and MuJoCo's Euler ("eulerdamp") both take dampers at the speeds
that the step ends with, and springs that it resolves, as all of these are, at the coordinates that it starts with.
"""

import argparse
import json
import time
from pathlib import Path

import mujoco
import numpy as np
from reference_dynamics import ASSETS, load, random_controls, random_joint_position

MODELS = [
    "ant",
    "half_cheetah",
    "hopper",
    "humanoid",
    "inverted_double_pendulum",
    "inverted_pendulum",
    "reacher",
    "walker2d",
]
STATES = 20
WIDTH = 1e-6  # of the differences


def transition(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[np.ndarray, np.ndarray, float]:
    """A, B, and the time of the call [s]."""
    n = 2 * model.nv + model.na
    a, b = np.zeros((n, n)), np.zeros((n, model.nu))
    start = time.perf_counter()
    mujoco.mjd_transitionFD(model, data, WIDTH, True, a, b, None, None)
    return a, b, time.perf_counter() - start


def describe(path: Path) -> dict:
    """The states of one model; the seed is fixed by its name."""
    model, _ = load(path)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
    rng = np.random.default_rng(list(path.stem.encode()))
    data = mujoco.MjData(model)
    states, seconds = [], []
    for _ in range(STATES):
        data.qpos[:] = np.concatenate([random_joint_position(model, j, rng) for j in range(model.njnt)])
        data.qvel[:] = rng.normal(size=model.nv)
        data.ctrl[:] = random_controls(model, rng)
        mujoco.mj_forward(model, data)
        if data.nefc:
            raise RuntimeError(f"{data.nefc} constraint rows are active where none should be")
        a, b, passed = transition(model, data)
        seconds.append(passed)
        states.append(
            {
                "qpos": data.qpos.tolist(),
                "qvel": data.qvel.tolist(),
                "ctrl": data.ctrl.tolist(),
                "a": a.flatten().tolist(),
                "b": b.flatten().tolist(),
            }
        )
    return {
        "model": path.stem,
        "path": str(path),
        "mujoco": mujoco.__version__,
        "timestep": model.opt.timestep,
        "seconds": float(np.median(seconds)),
        "states": states,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="folder the JSON files go to")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name in MODELS:
        target = arguments.out / f"{name}.json"
        target.write_text(json.dumps(describe((ASSETS / name).with_suffix(".xml"))))
        print(target)


if __name__ == "__main__":
    main()
