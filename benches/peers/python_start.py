"""How long Python takes to its first step, and where the time of a loop goes.

    python benches/peers/python_start.py [--rounds 9]

Prints a Markdown list and a table. Times are medians of fresh processes; those of Kinetarium and MuJoCo alternate.
Needs gymnasium (for its humanoid) and mujoco.
"""

from __future__ import annotations

import argparse
import importlib.util
import subprocess
import sys
import time
from collections import Counter
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
    """An engine whose calls are timed, each by its name."""

    def __init__(self, engine: Any) -> None:
        self._engine, self.seconds = engine, Counter[str]()

    def __getattr__(self, name: str) -> Any:
        call = getattr(self._engine, name)

        def timed(*arguments: Any) -> Any:
            begun = time.perf_counter()
            result = call(*arguments)
            self.seconds[name] += time.perf_counter() - begun
            return result

        return timed


OUTSIDE = "outside the engine"


def profile(steps: int) -> dict[str, float]:
    """Shares of a loop's time by the engine's calls: write all controls, step, read all joints."""
    sim = kn.Simulation(kn.load(humanoid()), worlds=WORLDS, dt=0.003)
    sim.step(100)
    actions = np.random.default_rng(0).uniform(-0.4, 0.4, (WORLDS, len(sim.model.actuator_names)))
    actions = actions.astype(sim.dtype)
    timed = Timed(sim._engine)
    sim._worlds._engine = timed  # type: ignore[assignment]
    begun = time.perf_counter()
    while time.perf_counter() - begun < 2.0:
        sim.controls.actuator[:] = actions
        sim.step(steps)
        _ = sim.state.joint_position, sim.state.joint_velocity
    whole = time.perf_counter() - begun
    shares = {name: seconds / whole for name, seconds in timed.seconds.items()}
    return shares | {OUTSIDE: 1.0 - sum(shares.values())}


def profiles(rounds: int, every: tuple[int, ...]) -> str:
    """Medians, as a table."""
    found = [[profile(steps) for _ in range(rounds)] for steps in every]
    rows = [f"| {WORLDS} humanoids: share of the time | " + " | ".join(f"every {n} steps" for n in every) + " |"]
    rows.append("|---|" + "--:|" * len(every))
    for call in ("step", "write_control", "read", OUTSIDE):
        shares = (median(shares.get(call, 0.0) for shares in column) for column in found)
        rows.append(f"| {call} | " + " | ".join(f"{100 * share:.1f} %" for share in shares) + " |")
    return "\n".join(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9)
    rounds = parser.parse_args().rounds
    pairs = [(start(KINETARIUM), start(MUJOCO)) for _ in range(rounds)]
    for i, what in enumerate(["import", "import, load a humanoid, first step"]):
        ours, theirs = (1e3 * median(pair[j][i] for pair in pairs) for j in range(2))
        print(f"- {what}: {ours:.0f} ms; MuJoCo {theirs:.0f} ms")
    print("\nControls of all worlds are written, and all joints read, after every so many steps:\n")
    print(profiles(3, (1, 5)))


if __name__ == "__main__":
    main()
