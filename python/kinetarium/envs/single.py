"""One world of a task, as Gymnasium's `Env`."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np

from kinetarium.arrays import whole
from kinetarium.envs.task import Array, Task, make_task

RENDER_MODES = ["rgb_array"]


class SingleTask(gymnasium.Env[Array, Array]):
    """A task with one world: what `gymnasium.make("kinetarium/…")` gives, within its wrappers.

    `task` is a class derived from `Task`, or its name "module:Class"; `width` and `height` are those of pictures
    [pixel]; other keywords are the task's options.
    """

    metadata = {"render_modes": RENDER_MODES}  # noqa: RUF012 — as Gymnasium declares it

    def __init__(
        self,
        task: str | type[Task],
        *,
        render_mode: str | None = None,
        width: int = 480,
        height: int = 480,
        **options: Any,
    ) -> None:
        check_render_mode(render_mode)
        self.width, self.height = whole("width", width, 1), whole("height", height, 1)
        self.task = make_task(task, 1, **options)
        self.metadata = {"render_modes": RENDER_MODES, "render_fps": round(1 / self.task.dt)}
        self.observation_space = self.task.observation_space
        self.action_space = self.task.action_space
        self.render_mode = render_mode

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
        """One action. Raises `ValueError` for actions of the wrong shape or that are not finite; those out of range
        act as its ends."""
        action = np.asarray(action)
        if action.shape != self.action_space.shape:
            raise ValueError(f"the action has the shape {action.shape}: it must be {self.action_space.shape}")
        reward, failed, info = self.task.act(action[None])
        return self.task.observe()[0], float(reward[0]), bool(failed[0]), False, _first(info)

    def render(self) -> Array | None:
        """Colours, uint8 of shape (height, width, 3), from a camera that goes along with the robot; `None` without
        `render_mode`."""
        return self.task.picture(0, self.width, self.height) if self.render_mode == "rgb_array" else None

    def close(self) -> None:
        """Frees the world."""
        self.task.simulation.close()


def _first(info: dict[str, Array]) -> dict[str, Any]:
    return {name: values[0] for name, values in info.items()}


def check_render_mode(mode: str | None) -> None:
    """`ValueError` for a mode that there is not."""
    if mode is not None and mode not in RENDER_MODES:
        raise ValueError(f'render_mode is "{mode}": it must be "rgb_array", or be left out')
