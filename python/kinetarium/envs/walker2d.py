"""A robot with two legs in a plane."""

from __future__ import annotations

from typing import Any

from kinetarium.envs.hopper import Hopper
from kinetarium.envs.options import Range, within
from kinetarium.envs.task import Array, Seen


class Walker2d(Hopper):
    """As Gymnasium's Walker2d-v5: as the hopper, within other ranges."""

    file = "walker2d_v5.xml"

    def __init__(
        self,
        worlds: int = 1,
        *,
        healthy_z_range: Range = (0.8, 2.0),
        healthy_angle_range: Range = (-1.0, 1.0),
        **options: Any,
    ) -> None:
        super().__init__(worlds, healthy_z_range=healthy_z_range, healthy_angle_range=healthy_angle_range, **options)

    def healthy(self, seen: Seen) -> Array:
        upright = within(seen.position[:, 1], self._healthy_z_range)
        return upright & within(seen.position[:, 2], self._healthy_angle_range)
