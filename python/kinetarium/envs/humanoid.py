"""A humanoid that walks."""

from __future__ import annotations

from typing import Any

import numpy as np

from kinetarium.envs.options import Range, ends, flag, number, within
from kinetarium.envs.task import Array, Seen, Task


class HumanoidTask(Task):
    """What the humanoid that walks and the one that stands up have in common."""

    frame_skip = 5

    def __init__(
        self,
        worlds: int = 1,
        *,
        ctrl_cost_weight: float = 0.1,
        reset_noise_scale: float = 1e-2,
        exclude_current_positions_from_observation: bool = True,
        include_cinert_in_observation: bool = True,
        include_cvel_in_observation: bool = True,
        include_qfrc_actuator_in_observation: bool = True,
        include_cfrc_ext_in_observation: bool = True,
        **options: Any,
    ) -> None:
        self._ctrl_cost_weight = number("ctrl_cost_weight", ctrl_cost_weight)
        self._reset_noise_scale = number("reset_noise_scale", reset_noise_scale, least=0)
        self._hidden = 2 * flag(
            "exclude_current_positions_from_observation", exclude_current_positions_from_observation
        )
        self._include_cinert = flag("include_cinert_in_observation", include_cinert_in_observation)
        self._include_cvel = flag("include_cvel_in_observation", include_cvel_in_observation)
        self._include_qfrc_actuator = flag(
            "include_qfrc_actuator_in_observation", include_qfrc_actuator_in_observation
        )
        self._include_cfrc_ext = flag("include_cfrc_ext_in_observation", include_cfrc_ext_in_observation)
        super().__init__(worlds, **options)

    def observation(self, seen: Seen) -> list[Array | str]:
        parts: list[Array | str] = [seen.position[:, self._hidden :], seen.velocity]
        if self._include_cinert:
            parts.append("spatial_inertia")
        if self._include_cvel:
            parts.append("spatial_velocity")
        if self._include_qfrc_actuator:
            parts.append(self.actuator_force(seen))
        if self._include_cfrc_ext:
            parts.append(seen.contact_force)
        return parts

    def actuator_force(self, seen: Seen) -> Array:
        """`qfrc_actuator` of the joints [N·m]: the motors in the order of the joints."""
        force = np.zeros((self.worlds, self.model.degrees_of_freedom))
        force[:, [self.model.dof(name) for name in self.model.actuator_names]] = seen.motor_force
        return force[:, 6:]

    def contact_cost(self, seen: Seen, weight: float, between: Range) -> Array:
        """A cost of the squares of `cfrc_ext`, within a range, shape (worlds,)."""
        cost: Array = np.zeros(self.worlds)
        if weight != 0:
            cost = weight * np.square(seen.contact_force.reshape(self.worlds, -1)).sum(axis=1)
        return cost.clip(*between)

    def control_cost(self, action: Array) -> Array:
        """A cost of the squares of the controls, shape (worlds,)."""
        squares: Array = np.square(action).sum(axis=1)
        return self._ctrl_cost_weight * squares

    def draw(self, random: np.random.Generator) -> tuple[Array, Array]:
        return self.noise(random, self._reset_noise_scale)


class Humanoid(HumanoidTask):
    """As Gymnasium's Humanoid-v5: paid for speed, for standing, for little torque and soft contacts."""

    file = "humanoid.xml"

    def __init__(
        self,
        worlds: int = 1,
        *,
        forward_reward_weight: float = 1.25,
        contact_cost_weight: float = 5e-7,
        contact_cost_range: Range = (-np.inf, 10.0),
        healthy_reward: float = 5.0,
        terminate_when_unhealthy: bool = True,
        healthy_z_range: Range = (1.0, 2.0),
        **options: Any,
    ) -> None:
        self._forward_reward_weight = number("forward_reward_weight", forward_reward_weight)
        self._contact_cost_weight = number("contact_cost_weight", contact_cost_weight)
        self._contact_cost_range = ends("contact_cost_range", contact_cost_range)
        self._healthy_reward = number("healthy_reward", healthy_reward)
        self._terminate_when_unhealthy = flag("terminate_when_unhealthy", terminate_when_unhealthy)
        self._healthy_z_range = ends("healthy_z_range", healthy_z_range)
        super().__init__(worlds, **options)

    def place(self, seen: Seen) -> Array:
        return seen.center_of_mass[:, :2].astype(np.float64)

    def whereabouts(self, seen: Seen) -> dict[str, Array]:
        x, y = seen.position[:, :2].T
        return {"x_position": x, "y_position": y, "distance_from_origin": np.hypot(x, y)}

    def healthy(self, seen: Seen) -> Array:
        """Whether the torso is at a good height, shape (worlds,)."""
        return within(seen.position[:, 2], self._healthy_z_range)

    def outcome(self, seen: Seen, action: Array, velocity: Array) -> tuple[Array, Array, dict[str, Array]]:
        healthy = self.healthy(seen)
        terms = {
            "reward_survive": healthy * self._healthy_reward,
            "reward_forward": self._forward_reward_weight * velocity[:, 0],
            "reward_ctrl": -self.control_cost(action),
            "reward_contact": -self.contact_cost(seen, self._contact_cost_weight, self._contact_cost_range),
        }
        reward = sum(terms.values(), np.zeros(self.worlds))
        info = {"x_velocity": velocity[:, 0], "y_velocity": velocity[:, 1]} | terms
        return reward, ~healthy & self._terminate_when_unhealthy, info
