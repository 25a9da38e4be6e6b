"""A robot with one leg in a plane."""

from __future__ import annotations

from typing import Any

import numpy as np

from kinetarium.envs.options import Range, ends, flag, number, within
from kinetarium.envs.task import Array, Seen, Task


class Hopper(Task):
    """As Gymnasium's Hopper-v5: paid for speed, for standing, and for little torque."""

    file, frame_skip, turning = "hopper.xml", 4, ("rooty",)

    def __init__(
        self,
        worlds: int = 1,
        *,
        forward_reward_weight: float = 1.0,
        ctrl_cost_weight: float = 1e-3,
        healthy_reward: float = 1.0,
        terminate_when_unhealthy: bool = True,
        healthy_state_range: Range = (-100.0, 100.0),
        healthy_z_range: Range = (0.7, np.inf),
        healthy_angle_range: Range = (-0.2, 0.2),
        reset_noise_scale: float = 5e-3,
        exclude_current_positions_from_observation: bool = True,
        **options: Any,
    ) -> None:
        self._forward_reward_weight = number("forward_reward_weight", forward_reward_weight)
        self._ctrl_cost_weight = number("ctrl_cost_weight", ctrl_cost_weight)
        self._healthy_reward = number("healthy_reward", healthy_reward)
        self._terminate_when_unhealthy = flag("terminate_when_unhealthy", terminate_when_unhealthy)
        self._healthy_state_range = ends("healthy_state_range", healthy_state_range)
        self._healthy_z_range = ends("healthy_z_range", healthy_z_range)
        self._healthy_angle_range = ends("healthy_angle_range", healthy_angle_range)
        self._reset_noise_scale = number("reset_noise_scale", reset_noise_scale, least=0)
        self._hidden = int(
            flag("exclude_current_positions_from_observation", exclude_current_positions_from_observation)
        )
        super().__init__(worlds, **options)

    def observation(self, seen: Seen) -> list[Array]:
        return [seen.position[:, self._hidden :], np.clip(seen.velocity, -10, 10)]

    def healthy(self, seen: Seen) -> Array:
        """Whether it stands, shape (worlds,)."""
        upright = within(seen.position[:, 1], self._healthy_z_range)
        straight = within(seen.position[:, 2], self._healthy_angle_range)
        state = np.concatenate([seen.position[:, 2:], seen.velocity], axis=1)
        return upright & straight & within(state, self._healthy_state_range).all(axis=1)

    def place(self, seen: Seen) -> Array:
        return seen.position[:, :1]

    def whereabouts(self, seen: Seen) -> dict[str, Array]:
        x, z = seen.position[:, 0], seen.position[:, 1]
        return {"x_position": x, "z_distance_from_origin": z - self.init_position[1]}

    def outcome(self, seen: Seen, action: Array, velocity: Array) -> tuple[Array, Array, dict[str, Array]]:
        healthy = self.healthy(seen)
        terms = {
            "reward_forward": self._forward_reward_weight * velocity[:, 0],
            "reward_ctrl": -self._ctrl_cost_weight * np.square(action).sum(axis=1),
            "reward_survive": healthy * self._healthy_reward,
        }
        reward = sum(terms.values(), np.zeros(self.worlds))
        return reward, ~healthy & self._terminate_when_unhealthy, {"x_velocity": velocity[:, 0]} | terms

    def draw(self, random: np.random.Generator) -> tuple[Array, Array]:
        return self.noise(random, self._reset_noise_scale)
