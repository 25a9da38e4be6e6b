"""Many worlds of a task, as Gymnasium's `VectorEnv`."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from kinetarium.arrays import whole
from kinetarium.envs.single import RENDER_MODES, check_render_mode
from kinetarium.envs.task import Array, Task, make_task

Info = dict[str, Any]


class VectorTask(gymnasium.vector.VectorEnv[Array, Array, Array]):
    """A task with many worlds in one simulation: what `gymnasium.make_vec("kinetarium/…")` gives.

    Parameters
    ----------
    task:
        A class derived from `Task`, or its name "module:Class".
    num_envs:
        Number of worlds.
    max_episode_steps:
        Steps after which an episode is truncated; −1: never. None: as the environment is registered, and never where
        it is not.
    autoreset_mode:
        "NextStep": the step after the end of an episode begins a new one instead, with reward 0. "SameStep":
        the step that ends an episode begins a new one, too; the end is in `infos["final_obs"]` and
        `infos["final_info"]`. "Disabled": `reset` with a mask `options["reset_mask"]`, which must precede the next
        step.
    width, height:
        Of pictures [pixel].

    Other keywords are the task's options. World k draws from a generator of its own, seeded with `seed` + k,
    as `gymnasium.vector.SyncVectorEnv` does: it does the same whatever the number of worlds.
    """

    metadata = {"render_modes": RENDER_MODES}  # noqa: RUF012 — as Gymnasium declares it

    def __init__(
        self,
        task: str | type[Task],
        num_envs: int = 1,
        *,
        max_episode_steps: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
        width: int = 480,
        height: int = 480,
        **options: Any,
    ) -> None:
        self.closed = True  # until there is something to close: older releases of Gymnasium close what was refused
        check_render_mode(render_mode)
        check_steps(max_episode_steps)
        self.render_mode = render_mode
        self.width, self.height = whole("width", width, 1), whole("height", height, 1)
        self.task = make_task(task, num_envs, **options)
        self.closed = False
        self.num_envs = num_envs
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {
            "render_modes": RENDER_MODES,
            "render_fps": round(1 / self.task.dt),
            "autoreset_mode": self.autoreset_mode,
        }
        self.single_observation_space = self.task.observation_space
        self.single_action_space = self.task.action_space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._steps = max_episode_steps
        self._elapsed = np.zeros(num_envs, np.int64)
        self._ended = np.zeros(num_envs, bool)
        self._generators: list[np.random.Generator] = []

    @property
    def _limit(self) -> float:
        """Steps of an episode; the registration is known only after the constructor."""
        steps = self.spec.max_episode_steps if self._steps is None and self.spec is not None else self._steps
        return np.inf if steps is None or steps == -1 else steps

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, Info]:
        """New episodes in all worlds, or in those of a mask `options["reset_mask"]`.

        World k's generator begins with `seed` + k, or with the k-th of a list, if given; where that is `None` it goes
        on. Seeds that are no whole numbers, or negative, raise `gymnasium.error.Error`, lists of another length than
        `num_envs` `ValueError`.
        """
        mask = np.ones(self.num_envs, bool)
        if options is not None and "reset_mask" in options:
            mask = np.asarray(options["reset_mask"])
            if mask.shape != (self.num_envs,) or mask.dtype != bool or not mask.any():
                raise ValueError(
                    f"the mask of worlds to reset must be bool of shape ({self.num_envs},), not all false"
                )
        self._seed(seed, mask)
        self._begin(mask)
        info = self.task.whereabouts(self.task.seen)
        return self.task.observe(), _masked(info, mask)

    def step(self, actions: Array) -> tuple[Array, Array, Array, Array, Info]:
        """One action in each world, shape (num_envs, numbers): observations, rewards, which episodes ended by
        failing and which by time, infos, as arrays with a row for each world.

        Raises `ValueError` for actions that are not finite numbers; those out of range act as its ends. Raises
        `gymnasium.error.ResetNeeded` before the first `reset`, and where episodes ended that nothing begins anew.
        """
        if not self._generators:
            raise gymnasium.error.ResetNeeded("call reset before step")
        if self.autoreset_mode is AutoresetMode.DISABLED and self._ended.any():
            raise gymnasium.error.ResetNeeded(
                f"the episodes of worlds {np.flatnonzero(self._ended).tolist()} have ended: call "
                'reset(options={"reset_mask": mask}) with their mask before step'
            )
        begins = self._ended & (self.autoreset_mode is AutoresetMode.NEXT_STEP)
        reward, failed, info = self.task.act(np.asarray(actions), *self._beginners(begins))
        self._elapsed = np.where(begins, 0, self._elapsed + 1)
        reward, failed = np.where(begins, 0.0, reward), failed & ~begins
        truncated = (self._elapsed >= self._limit) & ~begins
        self._ended = failed | truncated
        if self.autoreset_mode is AutoresetMode.SAME_STEP and self._ended.any():
            return self._ended_and_begun(reward, failed, truncated, info)
        return self.task.observe(), reward, failed, truncated, self._told(info, ~begins)

    def _ended_and_begun(
        self, reward: Array, failed: Array, truncated: Array, info: Info
    ) -> tuple[Array, Array, Array, Array, Info]:
        """A step after which some worlds began another episode."""
        ended = self._ended
        last = self.task.observe()
        final = np.full(self.num_envs, None, dtype=object)
        for world in np.flatnonzero(ended):
            final[world] = last[world]
        self._begin(ended)
        infos = self._told(info, ~ended) | {
            "final_obs": final,
            "_final_obs": ended,
            "final_info": _masked(info, ended),
            "_final_info": ended,
        }
        return self.task.observe(), reward, failed, truncated, infos

    def _told(self, info: Info, stepped: Array) -> Info:
        """What a step told of the worlds that it stepped, and where all are now."""
        now = self.task.whereabouts(self.task.seen)
        return _masked(info, stepped) | _masked(now, np.ones(self.num_envs, bool))

    def _beginners(self, mask: Array) -> tuple[Array, list[np.random.Generator]]:
        worlds = np.flatnonzero(mask)
        return worlds, [self._generators[k] for k in worlds]

    def _begin(self, mask: Array) -> None:
        self.task.begin(*self._beginners(mask))
        self._elapsed[mask] = 0
        self._ended = self._ended & ~mask

    def _seed(self, seed: Any, mask: Array) -> None:
        if seed is None and self._generators:
            return
        if np.ndim(seed) == 0:
            self._np_random, first = seeding.np_random(_plain(seed))
            self._np_random_seed = first
            seeds = [first + k for k in range(self.num_envs)]
        else:
            seeds = [_plain(one) for one in seed]
        if len(seeds) != self.num_envs:
            raise ValueError(f"there are {len(seeds)} seeds for {self.num_envs} worlds")
        goes_on = [bool(self._generators) and (seeds[k] is None or not mask[k]) for k in range(self.num_envs)]
        self._generators = [
            self._generators[k] if goes_on[k] else seeding.np_random(seeds[k])[0] for k in range(self.num_envs)
        ]

    def render(self) -> tuple[Array, ...] | None:
        """Colours of each world, uint8 of shape (height, width, 3), from cameras that go along with the robots;
        `None` without `render_mode`."""
        if self.render_mode is None:
            return None
        return tuple(self.task.picture(world, self.width, self.height) for world in range(self.num_envs))

    def close_extras(self, **kwargs: Any) -> None:
        """Frees the worlds."""
        self.task.simulation.close()


def check_steps(steps: int | None) -> None:
    """`ValueError` for numbers of steps that no episode has."""
    if steps is not None and steps != -1 and (not isinstance(steps, (int, np.integer)) or steps < 1):
        raise ValueError(f"max_episode_steps is {steps}: it must be 1 or more, -1 for no end, or be left out")


def _plain(seed: Any) -> Any:
    """A seed as Gymnasium takes it, which refuses numpy's integers as it does what is no integer."""
    return int(seed) if isinstance(seed, np.integer) else seed


def _masked(info: Info, mask: Array) -> Info:
    """Copies of values with, under the same name after a `_`, for which worlds they are; nothing, if for none."""
    told: Info = {}
    if not mask.any():
        return told
    for name, values in info.items():
        told[name] = np.zeros_like(values)
        told[name][mask] = values[mask]
        told[f"_{name}"] = mask.copy()
    return told
