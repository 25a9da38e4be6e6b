"""Scenes that need no file: functions that make models.

>>> from kinetarium import examples
>>> examples.dominoes(count=5)
<Model "dominoes_5": 5 bodies, 5 joints, 30 degrees of freedom, 0 actuators>
"""

from kinetarium._engine import (
    arch,
    ball_joint,
    balls,
    billiards,
    card_house,
    dominoes,
    linkage,
    n_pendula,
    pile,
    prismatic,
    pyramid,
    ragdolls,
    rings,
    room,
    rover,
)

__all__ = [
    "arch",
    "ball_joint",
    "balls",
    "billiards",
    "card_house",
    "dominoes",
    "linkage",
    "n_pendula",
    "pile",
    "prismatic",
    "pyramid",
    "ragdolls",
    "rings",
    "room",
    "rover",
]
