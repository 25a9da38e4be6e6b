"""One world of a task, as Gymnasium's `Env`."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np

from kinetarium.envs.task import Array, Task, make_task


class SingleTask(gymnasium.Env[Array, Array]):
    """A task with one world: what `gymnasium.make("kinetarium/…")` gives, within its wrappers.

    `task` is a class derived from `Task`, or its name "module:Class"; other keywords are the task's options.
    """

    def __init__(self, task: str | type[Task], *, render_mode: str | None = None, **options: Any) -> None:
        refuse_to_render(render_mode)
        self.task = make_task(task, 1, **options)
        self.metadata = {"render_modes": [], "render_fps": round(1 / self.task.dt)}
        self.observation_space = self.task.observation_space
        self.action_space = self.task.action_space
        self.render_mode = None

    @property
    def dt(self) -> float:
        """Time of an action [s]."""
        return self.task.dt

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """A new episode; the generator begins with `seed`, if given."""
        super().reset(seed=seed)
        self.task.begin(np.zeros(1, np.int64), [self.np_random])
        return self.task.observe()[0], _first(self.task.whereabouts(self.task.seen))

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """One action. Raises `ValueError` for actions that are not finite; those out of range act as its
        ends."""
        reward, failed, info = self.task.act(np.asarray(action)[None])
        return self.task.observe()[0], float(reward[0]), bool(failed[0]), False, _first(info)

    def close(self) -> None:
        """Frees the world."""
        self.task.simulation.close()


def _first(info: dict[str, Array]) -> dict[str, Any]:
    return {name: values[0] for name, values in info.items()}


def refuse_to_render(mode: str | None) -> None:
    """`TypeError` for any mode: there are no pictures yet. Libraries that ask for them go on without at
    that."""
    if mode is not None:
        raise TypeError(
            f'render_mode is "{mode}": there are no pictures from Python yet; leave it out, and look at a '
            "robot's file with the program `kinetarium`"
        )
