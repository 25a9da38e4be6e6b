"""Proximal policy optimisation (Schulman et al. 2017) on many worlds, in one file.

    python ppo.py kinetarium/Hopper-v0 --worlds 64 --steps 1000000 --out learning

Any id that `gymnasium.make_vec` knows will do; `--mode async` makes processes of ordinary environments, such
as Gymnasium's own `Hopper-v5`, and `--also Hopper-v5` plays there what was learnt. Writes
`learning/<id>-<seed>.csv`, a row for each update, and a plot of it. Needs torch and matplotlib besides what
`pip install ".[gym]"` brings.
"""

from __future__ import annotations

import argparse
import csv
import time
from collections.abc import Callable
from pathlib import Path

import gymnasium
import numpy as np
import torch
from torch import nn

import kinetarium.envs

gymnasium.register_envs(kinetarium.envs)

Policy = Callable[[np.ndarray], np.ndarray]
"""Actions of observations."""


class Normaliser:
    """Running mean and variance of what it has seen, merged batch by batch (Chan, Golub and LeVeque 1979)."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.mean, self.variance, self.count = np.zeros(shape), np.ones(shape), 1e-4

    def see(self, x: np.ndarray) -> None:
        count = self.count + len(x)
        shift = x.mean(axis=0) - self.mean
        self.variance = (
            self.variance * self.count + x.var(axis=0) * len(x) + shift**2 * self.count * len(x) / count
        ) / count
        self.mean = self.mean + shift * len(x) / count
        self.count = count

    def scale(self, x: np.ndarray) -> np.ndarray:
        return np.clip((x - self.mean) / np.sqrt(self.variance + 1e-8), -10, 10)


def layers(inputs: int, outputs: int, gain: float) -> nn.Sequential:
    """Two hidden layers of 64, with orthogonal weights (Saxe, McClelland and Ganguli 2014)."""
    sizes = [(inputs, 64, 2**0.5), (64, 64, 2**0.5), (64, outputs, gain)]
    modules: list[nn.Module] = []
    for n, m, g in sizes:
        layer = nn.Linear(n, m)
        nn.init.orthogonal_(layer.weight, g)
        nn.init.zeros_(layer.bias)
        modules += [layer, nn.Tanh()]
    return nn.Sequential(*modules[:-1])


class Agent(nn.Module):
    """A Gaussian policy whose deviations do not depend on the observation, and a value."""

    def __init__(self, observations: int, actions: int, log_deviation: float) -> None:
        super().__init__()
        self.actor = layers(observations, actions, 0.01)
        self.critic = layers(observations, 1, 1.0)
        self.log_deviation = nn.Parameter(torch.full((actions,), log_deviation))

    def policy(self, observation: torch.Tensor) -> torch.distributions.Normal:
        return torch.distributions.Normal(self.actor(observation), self.log_deviation.exp())

    def value(self, observation: torch.Tensor) -> torch.Tensor:
        return self.critic(observation)[..., 0]


def advantages(
    reward: np.ndarray, value: np.ndarray, ends: np.ndarray, fails: np.ndarray, gamma: float, decay: float
) -> np.ndarray:
    """δ = r + γ V' − V, A = δ + γ λ A' (Schulman et al. 2016), of arrays (steps, worlds); `value` has one
    row more.

    V' counts unless the episode failed there, A' unless it ended.
    """
    advantage = np.zeros_like(reward)
    last = np.zeros(reward.shape[1])
    for t in reversed(range(len(reward))):
        delta = reward[t] + gamma * value[t + 1] * ~fails[t] - value[t]
        last = delta + gamma * decay * last * ~ends[t]
        advantage[t] = last
    return advantage


class Rollout:
    """Plays the policy, and keeps what happened.

    With Gymnasium's default, the step after an end of an episode begins another one, whatever the action:
    what it begins from is the true last observation, so the value that stands there is right to bootstrap
    from where time ran out, and the step itself is left out of learning.
    """

    def __init__(self, envs: gymnasium.vector.VectorEnv, agent: Agent, gamma: float, seed: int) -> None:
        self.envs, self.agent, self.gamma = envs, agent, gamma
        self.raw, _ = envs.reset(seed=seed)
        self.seen = Normaliser(self.raw.shape[1:])
        self.returned = Normaliser(())
        self.discounted = np.zeros(envs.num_envs)
        self.begins = np.zeros(envs.num_envs, bool)
        self.total = np.zeros(envs.num_envs)
        self.returns: list[float] = []
        self.acting = 0.0

    def play(self, steps: int) -> dict[str, np.ndarray]:
        kept: dict[str, list[np.ndarray]] = {
            k: [] for k in ("seen", "action", "chance", "value", "reward", "ends", "fails", "counts")
        }
        for _ in range(steps):
            self.seen.see(self.raw)
            seen = torch.as_tensor(self.seen.scale(self.raw), dtype=torch.float32)
            with torch.no_grad():
                policy = self.agent.policy(seen)
                action = policy.sample()
                chance = policy.log_prob(action).sum(-1)
                value = self.agent.value(seen)
            begun = time.perf_counter()
            self.raw, reward, failed, truncated, _ = self.envs.step(action.numpy())
            self.acting += time.perf_counter() - begun
            row = (
                seen.numpy(),
                action.numpy(),
                chance.numpy(),
                value.numpy(),
                self._scale(reward, failed | truncated),
            )
            for name, x in zip(kept, (*row, failed | truncated, failed, ~self.begins), strict=True):
                kept[name].append(x)
            self.begins = failed | truncated
        with torch.no_grad():
            seen = torch.as_tensor(self.seen.scale(self.raw), dtype=torch.float32)
            kept["value"].append(self.agent.value(seen).numpy())
        return {name: np.array(x) for name, x in kept.items()}

    def _scale(self, reward: np.ndarray, ended: np.ndarray) -> np.ndarray:
        """Rewards by the deviation of discounted returns; and the returns of episodes that ended."""
        self.total += reward
        self.discounted = self.discounted * self.gamma + reward
        self.returned.see(self.discounted)
        self.returns += self.total[ended].tolist()
        self.total[ended] = self.discounted[ended] = 0
        return np.clip(reward / np.sqrt(self.returned.variance + 1e-8), -10, 10)


def learn(
    agent: Agent, optimiser: torch.optim.Optimizer, kept: dict[str, np.ndarray], args: argparse.Namespace
) -> None:
    """Steps along the clipped objective, in shuffled parts of what was kept."""
    advantage = advantages(kept["reward"], kept["value"], kept["ends"], kept["fails"], args.gamma, args.decay)
    counts = kept["counts"].ravel()
    target = advantage + kept["value"][:-1]
    flat = [kept["seen"], kept["action"], kept["chance"], advantage, target]
    tensors = [torch.as_tensor(x.reshape(-1, *x.shape[2:])[counts], dtype=torch.float32) for x in flat]
    seen, action, chance, advantage_of, target_of = tensors
    for _ in range(args.epochs):
        for rows in torch.randperm(len(seen)).chunk(args.parts):
            policy = agent.policy(seen[rows])
            ratio = (policy.log_prob(action[rows]).sum(-1) - chance[rows]).exp()
            gain = advantage_of[rows]
            gain = (gain - gain.mean()) / (gain.std() + 1e-8)
            clipped = ratio.clamp(1 - args.clip, 1 + args.clip)
            loss = -torch.min(ratio * gain, clipped * gain).mean()
            loss = loss + 0.5 * (agent.value(seen[rows]) - target_of[rows]).square().mean()
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(agent.parameters(), 0.5)
            optimiser.step()


def play(id: str, policy: Policy, episodes: int, seed: int) -> list[float]:
    """Returns of a policy, with its noise, in an environment that it may not have learnt in."""
    env = gymnasium.make(id)
    returns = []
    for episode in range(episodes):
        raw, _ = env.reset(seed=seed + episode)
        total, ended = 0.0, False
        while not ended:
            raw, reward, failed, truncated, _ = env.step(policy(raw))
            total += float(reward)
            ended = failed or truncated
        returns.append(total)
    env.close()
    return returns


def train(args: argparse.Namespace) -> tuple[list[dict[str, float]], Policy]:
    """A row for each update: steps so far, mean return of the episodes that ended, times [s]; and what was learnt."""
    torch.manual_seed(args.seed)
    envs = gymnasium.make_vec(args.id, num_envs=args.worlds, vectorization_mode=args.mode)
    sizes = envs.single_observation_space.shape[0], envs.single_action_space.shape[0]
    agent = Agent(*sizes, args.log_deviation)
    optimiser = torch.optim.Adam(agent.parameters(), lr=args.rate, eps=1e-5)
    rollout = Rollout(envs, agent, args.gamma, args.seed)
    rows: list[dict[str, float]] = []
    begun = time.perf_counter()
    for update in range(max(1, args.steps // (args.worlds * args.length))):
        optimiser.param_groups[0]["lr"] = args.rate * (1 - update * args.worlds * args.length / args.steps)
        rollout.returns.clear()
        learn(agent, optimiser, rollout.play(args.length), args)
        steps = (update + 1) * args.worlds * args.length
        mean = float(np.mean(rollout.returns)) if rollout.returns else float("nan")
        seconds = time.perf_counter() - begun
        rows.append(
            {
                "steps": steps,
                "return": mean,
                "episodes": len(rollout.returns),
                "seconds": seconds,
                "acting": rollout.acting,
            }
        )
        if update % 10 == 0:
            print(
                f"{steps:9d} steps  return {mean:8.1f}  {len(rollout.returns):5d} episodes  {seconds:6.1f} s",
                flush=True,
            )
    envs.close()

    def policy(raw: np.ndarray) -> np.ndarray:
        with torch.no_grad():
            return agent.policy(torch.as_tensor(rollout.seen.scale(raw), dtype=torch.float32)).sample().numpy()

    return rows, policy


def write(rows: list[dict[str, float]], args: argparse.Namespace) -> None:
    """The table and its plot."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    args.out.mkdir(parents=True, exist_ok=True)
    path = args.out / f"{args.id.split('/')[-1]}-{args.seed}"
    with path.with_suffix(".csv").open("w", newline="") as file:
        table = csv.DictWriter(file, rows[0])
        table.writeheader()
        table.writerows(rows)
    figure, axes = plt.subplots(figsize=(5, 3), layout="constrained")
    axes.plot([row["steps"] for row in rows], [row["return"] for row in rows])
    axes.set(xlabel="steps", ylabel="return", title=args.id)
    axes.grid(alpha=0.3)
    figure.savefig(path.with_suffix(".png"), dpi=120)
    plt.close(figure)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("id", nargs="?", default="kinetarium/InvertedDoublePendulum-v0")
    parser.add_argument("--worlds", type=int, default=64)
    parser.add_argument("--steps", type=int, default=500_000, help="of all worlds together")
    parser.add_argument("--length", type=int, default=64, help="steps of each world between updates")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--epochs", type=int, default=10)
    parser.add_argument("--parts", type=int, default=16, help="minibatches of an epoch")
    parser.add_argument("--rate", type=float, default=5e-4, help="of learning at the start; falls to zero")
    parser.add_argument("--gamma", type=float, default=0.99)
    parser.add_argument("--decay", type=float, default=0.95, help="λ of the advantages")
    parser.add_argument("--clip", type=float, default=0.2)
    parser.add_argument("--log-deviation", type=float, default=-0.5, help="of actions at the start")
    parser.add_argument("--mode", choices=["vector_entry_point", "sync", "async"], help="as of gymnasium.make_vec")
    parser.add_argument("--also", nargs="*", default=[], help="environments to play in, too, what was learnt")
    parser.add_argument("--out", type=Path, default=Path("learning"))
    parser.add_argument("--short", action="store_true", help="a few updates only, to see that it runs")
    args = parser.parse_args()
    if args.short:
        args.worlds, args.length, args.steps, args.epochs = 16, 32, 2048, 2
    return args


if __name__ == "__main__":
    args = arguments()
    rows, policy = train(args)
    write(rows, args)
    for id in args.also:
        returns = play(id, policy, 2 if args.short else 20, args.seed)
        print(f"{id}: return {np.mean(returns):.1f} ± {np.std(returns):.1f} in {len(returns)} episodes")
