"""Gymnasium's MuJoCo robots, simulated by kinetarium. `pip install ".[gym]"` in a checkout brings Gymnasium.

>>> import gymnasium
>>> import kinetarium.envs
>>> env = gymnasium.make("kinetarium/Hopper-v0")
>>> envs = gymnasium.make_vec("kinetarium/Humanoid-v0", num_envs=64)
>>> observation, info = envs.reset(seed=0)
>>> observation.shape
(64, 348)

Observations, rewards, ends of episodes, resets and options are those of Gymnasium's `-v5` environments,
whose model files are read from where Gymnasium keeps them. `make_vec` gives a `VectorTask`, whose worlds are
all in one simulation. A robot of your own is a class derived from `Task`, registered as those below.
"""

from gymnasium.envs.registration import register

from kinetarium.envs.single import SingleTask
from kinetarium.envs.task import Seen, Task
from kinetarium.envs.vector import VectorTask

__all__ = ["ROBOTS", "Seen", "SingleTask", "Task", "VectorTask"]

ROBOTS = {
    "InvertedPendulum": ("inverted_pendulum", 1000, 950.0),
    "InvertedDoublePendulum": ("inverted_double_pendulum", 1000, 9100.0),
    "Reacher": ("reacher", 50, -3.75),
    "Pusher": ("pusher", 100, 0.0),
    "Hopper": ("hopper", 1000, 3800.0),
    "HalfCheetah": ("half_cheetah", 1000, 4800.0),
    "Walker2d": ("walker2d", 1000, None),
    "Ant": ("ant", 1000, 6000.0),
    "Humanoid": ("humanoid", 1000, None),
    "HumanoidStandup": ("humanoid_standup", 1000, None),
}
"""Of each robot its module, the steps of an episode, and the return at which it counts as learnt."""

for _name, (_module, _steps, _learnt) in ROBOTS.items():
    register(
        id=f"kinetarium/{_name}-v0",
        entry_point="kinetarium.envs.single:SingleTask",
        vector_entry_point="kinetarium.envs.vector:VectorTask",
        max_episode_steps=_steps,
        reward_threshold=_learnt,
        kwargs={"task": f"kinetarium.envs.{_module}:{_name}"},
    )
