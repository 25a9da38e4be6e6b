"""Steps of Gymnasium's environments, side by side with MuJoCo's.

    python benches/peers/python_bench.py [--rounds 7]

Prints a Markdown table. An environment step is `frame_skip` time steps and what is observed of them. In each
round all candidates run one after the other for a moment, and their rates are compared within the round, so
that what else the machine does meanwhile falls on all of them; the table has the medians of these ratios.
Needs the package with its extra `gym`, mujoco and imageio.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Callable

import gymnasium
import mujoco
import mujoco.rollout
import numpy as np

import kinetarium.envs

PROCESSES = 2
CASES = [("Humanoid", 4096), ("Ant", 1024), ("Hopper", 64)]

gymnasium.register_envs(kinetarium.envs)
Run = Callable[[], int]


def actions(space: gymnasium.spaces.Box, *shape: int) -> np.ndarray:
    """Random actions within the range."""
    return np.random.default_rng(0).uniform(space.low, space.high, (*shape, *space.shape)).astype(np.float32)


def native(robot: str, worlds: int, **options: object) -> Run:
    """Kinetarium's vector environment."""
    envs = gymnasium.make_vec(f"kinetarium/{robot}-v0", num_envs=worlds, **options)
    envs.reset(seed=0)
    taken = actions(envs.single_action_space, 8, worlds)

    def run() -> int:
        for action in taken:
            envs.step(action)
        return len(taken) * worlds

    return run


def processes(robot: str) -> Run:
    """Gymnasium's environments, one in each of a few processes."""
    envs = gymnasium.make_vec(f"{robot}-v5", num_envs=PROCESSES, vectorization_mode="async")
    envs.reset(seed=0)
    taken = actions(envs.single_action_space, 200, PROCESSES)

    def run() -> int:
        for action in taken:
            envs.step(action)
        return len(taken) * PROCESSES

    return run


def rollouts(robot: str, worlds: int) -> Run:
    """MuJoCo's own threads: the steps alone, without observations, rewards and resets."""
    env = gymnasium.make(f"{robot}-v5").unwrapped
    env.reset(seed=0)
    model, skip = env.model, env.frame_skip
    worlds = min(worlds, 256)
    data = [mujoco.MjData(model) for _ in range(PROCESSES)]
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    state = np.zeros(size)
    mujoco.mj_getState(model, env.data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    states = np.tile(state, (worlds, 1))
    steps = 8
    taken = np.repeat(actions(env.action_space, worlds, steps), skip, axis=1).astype(np.float64)
    pool = mujoco.rollout.Rollout(nthread=PROCESSES)

    def run() -> int:
        pool.rollout(model, data, states, taken)
        return worlds * steps

    return run


def rates(runs: dict[str, Run], rounds: int) -> dict[str, np.ndarray]:
    """Environment steps a second of each candidate in each round."""
    found: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(rounds):
        for name, run in runs.items():
            begun = time.perf_counter()
            steps = 0
            while time.perf_counter() - begun < 0.5:
                steps += run()
            found[name].append(steps / (time.perf_counter() - begun))
    return {name: np.array(rate) for name, rate in found.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    rounds = parser.parse_args().rounds
    warnings.simplefilter("ignore")
    others = ["AsyncVectorEnv, 2 processes", "mujoco.rollout, 2 threads", "itself with semi-implicit Euler"]
    print("| environment | worlds | steps/s | " + " | ".join(f"× {name}" for name in others) + " |")
    print("|---|--:|--:|--:|--:|--:|")
    for robot, worlds in CASES:
        runs = {
            "native": native(robot, worlds),
            "euler": native(robot, worlds, integrator="semi_implicit_euler"),
            "async": processes(robot),
            "rollout": rollouts(robot, worlds),
        }
        for run in runs.values():
            run()
        found = rates(runs, rounds)
        ratio = {name: np.median(found["native"] / found[name]) for name in found}
        ratios = " | ".join(f"{ratio[name]:.2g}" for name in ("async", "rollout", "euler"))
        print(f"| {robot} | {worlds} | {np.median(found['native']):.3g} | {ratios} |", flush=True)


if __name__ == "__main__":
    main()
