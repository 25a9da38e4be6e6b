"""A humanoid that stands up."""

from __future__ import annotations

from typing import Any

import numpy as np

from kinetarium.envs.humanoid import HumanoidTask
from kinetarium.envs.options import Range, ends, number
from kinetarium.envs.task import Array, Seen


class HumanoidStandup(HumanoidTask):
    """As Gymnasium's HumanoidStandup-v5: paid for the height of the torso, for little torque and soft
    impacts. It never fails."""

    file = "humanoidstandup.xml"

    def __init__(
        self,
        worlds: int = 1,
        *,
        uph_cost_weight: float = 1.0,
        impact_cost_weight: float = 0.5e-6,
        impact_cost_range: Range = (-np.inf, 10.0),
        **options: Any,
    ) -> None:
        self._uph_cost_weight = number("uph_cost_weight", uph_cost_weight)
        self._impact_cost_weight = number("impact_cost_weight", impact_cost_weight)
        self._impact_cost_range = ends("impact_cost_range", impact_cost_range)
        super().__init__(worlds, **options)

    def whereabouts(self, seen: Seen) -> dict[str, Array]:
        x, y, z = seen.position[:, :3].T
        return {"x_position": x, "y_position": y, "z_distance_from_origin": z - self.init_position[2]}

    def outcome(self, seen: Seen, action: Array, velocity: Array) -> tuple[Array, Array, dict[str, Array]]:
        terms = {
            "reward_linup": self._uph_cost_weight * seen.position[:, 2] / self.model.time_step,
            "reward_quadctrl": -self.control_cost(action),
            "reward_impact": -self.contact_cost(seen, self._impact_cost_weight, self._impact_cost_range),
        }
        return sum(terms.values(), np.ones(self.worlds)), np.zeros(self.worlds, bool), terms
