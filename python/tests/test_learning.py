"""What learns with torch: Stable-Baselines3, and the example. `cargo xtask test learning` installs both."""

import runpy
from pathlib import Path

import gymnasium
import pytest

pytest.importorskip("torch", reason="torch is not installed")

EXAMPLE = Path(__file__).parents[1] / "examples/ppo.py"


def test_stable_baselines():
    sb3 = pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed")
    from stable_baselines3.common.env_util import make_vec_env

    one = gymnasium.make("kinetarium.envs:kinetarium/Hopper-v0")
    assert sb3.PPO("MlpPolicy", one, n_steps=128, device="cpu", seed=0).learn(256).num_timesteps == 256
    some = make_vec_env("kinetarium.envs:kinetarium/InvertedPendulum-v0", n_envs=3, seed=0)
    assert sb3.PPO("MlpPolicy", some, n_steps=64, device="cpu", seed=0).learn(384).num_timesteps == 384


def test_the_example(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    name = "kinetarium/InvertedPendulum-v0"
    monkeypatch.setattr("sys.argv", [str(EXAMPLE), name, "--short", "--also", name])
    runpy.run_path(str(EXAMPLE), run_name="__main__")
    assert list(tmp_path.rglob("*.csv"))
    assert f"{name}: return" in capsys.readouterr().out
