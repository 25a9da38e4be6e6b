"""How long Python takes to its first step, and how much of a loop is not the engine's.

    python benches/peers/python_start.py [--rounds 9]

Prints a Markdown list. Times are medians of fresh processes; those of Kinetarium and MuJoCo alternate. Needs
gymnasium (for its humanoid) and mujoco.
"""

from __future__ import annotations

import argparse
import importlib.util
import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

import kinetarium as kn

WORLDS = 4096

KINETARIUM = """
import time; t = time.perf_counter()
import kinetarium; imported = time.perf_counter() - t
sim = kinetarium.Simulation(kinetarium.load({file!r})); sim.step()
print(imported, time.perf_counter() - t)
"""
MUJOCO = """
import time; t = time.perf_counter()
import mujoco; imported = time.perf_counter() - t
model = mujoco.MjModel.from_xml_path({file!r}); data = mujoco.MjData(model); mujoco.mj_step(model, data)
print(imported, time.perf_counter() - t)
"""


def humanoid() -> str:
    """Where Gymnasium keeps its humanoid."""
    spec = importlib.util.find_spec("gymnasium")
    assert spec is not None and spec.origin is not None
    return str(Path(spec.origin).parent / "envs/mujoco/assets/humanoid.xml")


def start(text: str) -> list[float]:
    """Seconds to import, and to the end of the first step, in a process of its own."""
    command = [sys.executable, "-c", text.format(file=humanoid())]
    told = subprocess.run(command, capture_output=True, text=True, check=True)
    return [float(word) for word in told.stdout.split()]


class Timed:
    """An engine whose calls are timed."""

    def __init__(self, engine: Any) -> None:
        self._engine, self.seconds = engine, 0.0

    def __getattr__(self, name: str) -> Any:
        call = getattr(self._engine, name)

        def timed(*arguments: Any) -> Any:
            begun = time.perf_counter()
            result = call(*arguments)
            self.seconds += time.perf_counter() - begun
            return result

        return timed


def outside(steps: int) -> float:
    """Share of a loop's time that is not spent in the engine: write all controls, step, read all joints."""
    sim = kn.Simulation(kn.load(humanoid()), worlds=WORLDS, dt=0.003)
    sim.step(100)
    actions = np.random.default_rng(0).uniform(-0.4, 0.4, (WORLDS, len(sim.model.actuator_names)))
    actions = actions.astype(sim.dtype)
    timed = Timed(sim._engine)
    sim._engine = timed  # type: ignore[assignment]
    begun = time.perf_counter()
    while time.perf_counter() - begun < 2.0:
        sim.controls.actuator[:] = actions
        sim.step(steps)
        _ = sim.state.joint_position, sim.state.joint_velocity
    return 1.0 - timed.seconds / (time.perf_counter() - begun)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9)
    rounds = parser.parse_args().rounds
    pairs = [(start(KINETARIUM), start(MUJOCO)) for _ in range(rounds)]
    for i, what in enumerate(["import", "import, load a humanoid, first step"]):
        ours, theirs = (1e3 * median(pair[j][i] for pair in pairs) for j in range(2))
        print(f"- {what}: {ours:.0f} ms; MuJoCo {theirs:.0f} ms")
    for steps in (1, 5):
        share = 100 * median(outside(steps) for _ in range(3))
        print(
            f"- {WORLDS} humanoids, controls written and joints read after every {steps} steps: "
            f"{share:.1f} % of the time outside the engine"
        )


if __name__ == "__main__":
    main()
