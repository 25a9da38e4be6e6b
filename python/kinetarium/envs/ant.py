"""A robot with four legs."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from kinetarium.envs.options import Range, ends, flag, number
from kinetarium.envs.task import Array, Seen, Task


class Ant(Task):
    """As Gymnasium's Ant-v5: paid for speed, for not falling over, for little torque and soft contacts."""

    file, frame_skip = "ant.xml", 5

    def __init__(
        self,
        worlds: int = 1,
        *,
        forward_reward_weight: float = 1.0,
        ctrl_cost_weight: float = 0.5,
        contact_cost_weight: float = 5e-4,
        healthy_reward: float = 1.0,
        main_body: int | str = 1,
        terminate_when_unhealthy: bool = True,
        healthy_z_range: Range = (0.2, 1.0),
        contact_force_range: Range = (-1.0, 1.0),
        reset_noise_scale: float = 0.1,
        exclude_current_positions_from_observation: bool = True,
        include_cfrc_ext_in_observation: bool = True,
        **options: Any,
    ) -> None:
        self._forward_reward_weight = number("forward_reward_weight", forward_reward_weight)
        self._ctrl_cost_weight = number("ctrl_cost_weight", ctrl_cost_weight)
        self._contact_cost_weight = number("contact_cost_weight", contact_cost_weight)
        self._healthy_reward = number("healthy_reward", healthy_reward)
        self._main_body = main_body
        self._terminate_when_unhealthy = flag("terminate_when_unhealthy", terminate_when_unhealthy)
        self._healthy_z_range = ends("healthy_z_range", healthy_z_range)
        self._contact_force_range = ends("contact_force_range", contact_force_range)
        self._reset_noise_scale = number("reset_noise_scale", reset_noise_scale, least=0)
        self._hidden = 2 * flag(
            "exclude_current_positions_from_observation", exclude_current_positions_from_observation
        )
        self._include_cfrc_ext = flag("include_cfrc_ext_in_observation", include_cfrc_ext_in_observation)
        super().__init__(worlds, **options)

    def contact_forces(self, seen: Seen) -> Array:
        """Clipped `cfrc_ext`, shape (worlds, bodies, 6)."""
        return np.clip(seen.contact_force, *self._contact_force_range)

    def observation(self, seen: Seen) -> list[Array]:
        parts = [seen.position[:, self._hidden :], seen.velocity]
        return [*parts, self.contact_forces(seen)] if self._include_cfrc_ext else parts

    @cached_property
    def main(self) -> int:
        """Row of the body whose speed is paid for."""
        body, bodies = self._main_body, len(self.model.body_names)
        if isinstance(body, str):
            return self.model.body(body)
        if not isinstance(body, (int, np.integer)) or not 1 <= body <= bodies:
            raise ValueError(f"main_body is {body!r}: give a body's name, or its number from 1 to {bodies}")
        return int(body) - 1  # MuJoCo counts the world as body 0

    def place(self, seen: Seen) -> Array:
        return seen.body_position[:, self.main, :2]

    def whereabouts(self, seen: Seen) -> dict[str, Array]:
        x, y = seen.position[:, :2].T
        return {"x_position": x, "y_position": y, "distance_from_origin": np.hypot(x, y)}

    def healthy(self, seen: Seen) -> Array:
        """Whether the torso is at a good height, shape (worlds,)."""
        low, high = self._healthy_z_range
        z = seen.position[:, 2]
        return (low <= z) & (z <= high)

    def outcome(self, seen: Seen, action: Array, velocity: Array) -> tuple[Array, Array, dict[str, Array]]:
        healthy = self.healthy(seen)
        contact = np.zeros(self.worlds)
        if self._contact_cost_weight != 0:
            force = self.contact_forces(seen).reshape(self.worlds, -1)
            contact = -self._contact_cost_weight * np.square(force).sum(axis=1)
        terms = {
            "reward_forward": self._forward_reward_weight * velocity[:, 0],
            "reward_ctrl": -self._ctrl_cost_weight * np.square(action).sum(axis=1),
            "reward_contact": contact,
            "reward_survive": healthy * self._healthy_reward,
        }
        reward = sum(terms.values(), np.zeros(self.worlds))
        info = {"x_velocity": velocity[:, 0], "y_velocity": velocity[:, 1]} | terms
        return reward, ~healthy & self._terminate_when_unhealthy, info

    def draw(self, random: np.random.Generator) -> tuple[Array, Array]:
        return self.noise(random, self._reset_noise_scale, normal_velocity=True)
