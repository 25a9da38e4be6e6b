"""Draws the learning curves of the documentation from their tables, `docs/learning/*.csv`.

    python python/tools/plot_learning.py

`python/examples/ppo.py` writes such a table, `<environment>-<seed>.csv`.
"""

from __future__ import annotations

import csv
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

TABLES = Path(__file__).parents[2] / "docs/learning"
UPDATES = 10
"""That are averaged over, in episodes."""


def smoothed(path: Path) -> tuple[list[int], list[float]]:
    """Steps, and the mean return of the episodes of the last updates."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    steps, returns = [], []
    for end in range(1, len(rows) + 1):
        last = [row for row in rows[max(0, end - UPDATES) : end] if int(row["episodes"])]
        episodes = sum(int(row["episodes"]) for row in last)
        if episodes:
            steps.append(int(rows[end - 1]["steps"]))
            returns.append(sum(float(row["return"]) * int(row["episodes"]) for row in last) / episodes)
    return steps, returns


def draw(robot: str) -> None:
    """One picture of a robot's runs on both sides."""
    figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
    for version, name, colour in ("v0", "Kinetarium", "tab:blue"), ("v5", "Gymnasium", "tab:orange"):
        for path in sorted(TABLES.glob(f"{robot}-{version}-*.csv")):
            axes.plot(*smoothed(path), color=colour, linewidth=1, label=name)
            name = "_"
    axes.set(xlabel="steps of all worlds", ylabel="return", title=robot)
    axes.legend()
    axes.grid(alpha=0.3)
    figure.savefig(TABLES / f"{robot}.png", dpi=120)
    plt.close(figure)


if __name__ == "__main__":
    for robot in ("InvertedDoublePendulum", "Hopper", "Ant"):
        draw(robot)
