"""Gymnasium environments: the interface, and Gymnasium's own environments as the measure."""

import copy
import importlib
import inspect
import pickle
import re
import subprocess
import sys
import warnings
from functools import partial

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

import kinetarium as kn
import kinetarium.envs
import kinetarium.envs.hopper
from kinetarium.envs import ROBOTS
from kinetarium.envs.task import coordinate_orders, make_task, model_file
from kinetarium.errors import ShapeError, UnknownNameError

mujoco = pytest.importorskip("mujoco", reason="Gymnasium's own environments need mujoco")
pytest.importorskip("imageio", reason="gymnasium.envs.mujoco imports imageio")

WALKS = ("Hopper", "HalfCheetah", "Walker2d")
FLOATS = ("Ant", "Humanoid", "HumanoidStandup")
MORTAL = ("InvertedPendulum", "InvertedDoublePendulum", "Hopper", "Walker2d", "Ant", "Humanoid")

robots = pytest.mark.parametrize("robot", ROBOTS)


def gymnasiums(robot):
    """Gymnasium's environment, with the integrator that the others use."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        env = gymnasium.make(f"{robot}-v5").unwrapped
    env.model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    return env


def states(robot, model, count, seed):
    """States in which nothing touches and no limit is near: joints well within their ranges, robots in the
    air, the pusher's cylinder out of reach and everything but the arm at rest."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        q = model.qpos0 + random.uniform(-0.1, 0.1, model.nq)
        v = random.normal(0, 0.5, model.nv)
        for joint in np.flatnonzero(model.jnt_limited):
            low, high = model.jnt_range[joint]
            reach = 0.25 * (high - low)
            address = model.jnt_qposadr[joint]
            q[address] = np.clip(q[address], (low + high) / 2 - reach, (low + high) / 2 + reach)
        if robot in WALKS:
            q[1] += 3
        if robot in FLOATS:
            q[2] += 3
            q[3:7] /= np.linalg.norm(q[3:7])
        if robot == "HumanoidStandup":  # hands off the hips
            q[18], q[21] = q[18] - 0.6, q[21] + 0.6
        if robot == "Pusher":
            q[-4:] = [-0.3, 0.2, 0, 0]
        if robot in ("Pusher", "Reacher"):
            v[-4 if robot == "Pusher" else -2 :] = 0
        yield q, v


def test_coordinates_are_mujocos_where_a_loop_is_closed():
    model = kn.parse(
        """<mujoco><worldbody>
          <body name="buoy" pos="2 0 0"><freejoint/><geom size="0.1"/></body>
          <body name="rod"><joint name="hip"/><geom size="0.1"/></body>
          <body name="cart" pos="1 0 0"><joint name="slide" type="slide"/><geom size="0.1"/></body>
        </worldbody><equality><connect body1="rod" anchor="0.1 0 0"/></equality></mujoco>"""
    )
    assert "ball" in model.joint_kinds
    to_mujoco, from_mujoco = coordinate_orders(model)
    assert to_mujoco.tolist() == [0, 1, 2, 6, 3, 4, 5, 7, 8]
    assert from_mujoco.tolist() == [0, 1, 2, 4, 5, 6, 3, 7, 8]


@robots
@pytest.mark.filterwarnings("ignore:.*Box observation space m.* value is.*infinity")
@pytest.mark.filterwarnings("ignore:.*we recommend using a symmetric and normalized space")
@pytest.mark.filterwarnings("error")
def test_gymnasiums_checker_is_content(robot):
    env = gymnasium.make(f"kinetarium/{robot}-v0", disable_env_checker=True)
    check_env(env.unwrapped, skip_render_check=True)
    assert env.spec.max_episode_steps == gymnasium.spec(f"{robot}-v5").max_episode_steps
    assert env.spec.reward_threshold == gymnasium.spec(f"{robot}-v5").reward_threshold


@robots
def test_spaces_steps_and_resets_are_gymnasiums(robot):
    own, other = gymnasium.make(f"kinetarium/{robot}-v0").unwrapped, gymnasiums(robot)
    assert own.observation_space == other.observation_space
    assert own.action_space == other.action_space
    assert own.dt == pytest.approx(other.dt)
    found, info = own.reset(seed=5)
    expected, expected_info = other.reset(seed=5)
    if robot in FLOATS:
        # Gymnasium's quaternion is of unit length only after the first step, and what follows from it is
        # scaled.
        kept = np.r_[0, 5:22] if robot == "Ant" else np.r_[0, 5:45]
        found, expected = found[kept], expected[kept]
    # Numbers are drawn alike; then they are rounded to float32.
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6)
    assert set(info) == {name for name in expected_info if not name.startswith("tendon")}


@robots
@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_states_and_flights_are_gymnasiums(robot, dtype):
    other = gymnasiums(robot)
    other.reset(seed=0)
    task = gymnasium.make(f"kinetarium/{robot}-v0", dtype=dtype).unwrapped.task
    random = np.random.default_rng(1)
    # Rounding, u = 2⁻²⁴: an observation takes some tens of operations on numbers of its own size, or of the
    # size of what cancels in them, such as m d² at 3 m; a step adds 5 × 4 stages of accelerations up to 10⁴,
    # times 10 ms, each known to some u of itself: 20 · 10² · 10 u = 1e-3 at most. In float64, 10⁻⁹ of these.
    seen_to, moved_to = (1e-4, 1e-3) if dtype == "float32" else (1e-9, 1e-8)
    flights = 0
    for q, v in states(robot, other.model, 12, seed=2):
        mujoco.mj_resetData(other.model, other.data)
        other.set_state(q, v)
        task.set_state(q[None], v[None])
        expected = other._get_obs()
        scale = max(1.0, np.abs(expected).max() / 100)
        np.testing.assert_allclose(task.observe()[0], expected, atol=seen_to * scale)

        action = random.uniform(other.action_space.low, other.action_space.high).astype(np.float32)
        touches = other.data.ncon
        _, reward, failed, _, info = other.step(action)
        if (touches or other.data.ncon) and robot != "Pusher":  # whose cylinder always touches the table
            continue
        flights += 1
        # What Gymnasium observes of bodies is of the last stage of the step; bring it to the end.
        mujoco.mj_forward(other.model, other.data)
        found, found_failed, found_info = task.act(action[None])
        np.testing.assert_allclose(task.observe()[0], other._get_obs(), atol=moved_to * scale)
        assert found_failed[0] == failed
        # Speeds of bodies from the last stage, not the end: about a h² / h of 10 m/s² and up to 10 ms, where
        # they are paid for; HumanoidStandup divides a height by 3 ms.
        slack = 1e-4 + 1e-3 * abs(reward) if robot not in ("Ant", "Humanoid") else 2e-2
        assert found[0] == pytest.approx(reward, abs=slack)
        assert set(found_info) == {name for name in info if not name.startswith("tendon")}
    assert flights >= 4


@pytest.mark.parametrize(
    ("robot", "apart"), [("Hopper", 0.03), ("Walker2d", 0.1), ("HalfCheetah", 0.1), ("Ant", 0.1), ("Humanoid", 0.1)]
)
def test_contacts_are_gymnasiums(robot, apart):
    """How far velocities are apart after an action on the ground, as a share of their change: round cones against
    pyramids, and one impedance against one that grows with the depth."""
    other, task = gymnasiums(robot), gymnasium.make(f"kinetarium/{robot}-v0", dtype="float64").unwrapped.task
    random, errors, changes = np.random.default_rng(0), [], []
    for seed in range(8):
        other.reset(seed=seed)
        failed, steps = False, 0
        while not failed and steps < 40:
            q, v = other.data.qpos.copy(), other.data.qvel.copy()
            action = random.uniform(other.action_space.low, other.action_space.high).astype(np.float32)
            _, _, failed, _, _ = other.step(action)
            steps += 1
            if other.data.ncon > 0:
                task.set_state(q[None], v[None])
                task.act(action[None])
                errors.append(np.abs(task.seen.velocity[0] - other.data.qvel).mean())
                changes.append(np.abs(other.data.qvel - v).mean())
    assert len(errors) > 20
    assert np.median(errors) < apart * np.median(changes)


def test_cart_feels_the_end_of_its_rail():
    # The last number of the observation is the force of the limit, up to 10 N; margins of 1 cm.
    other = gymnasiums("InvertedDoublePendulum")
    other.reset(seed=0)
    task = make_task("kinetarium.envs.inverted_double_pendulum:InvertedDoublePendulum", 1, dtype="float64")
    for x, v in [(0.0, 0.0), (0.992, -0.1), (0.9905, 0.0), (0.995, 0.3), (-0.995, 0.1)]:
        q, v = np.array([x, 0.05, -0.02]), np.array([v, 0.2, 0.1])
        other.set_state(q, v)
        task.set_state(q[None], v[None])
        np.testing.assert_allclose(task.observe()[0], other._get_obs(), rtol=1e-6, atol=1e-6)


def test_contact_forces_carry_the_ant():
    # At rest, contacts carry the weight, and their torques about the centre of mass cancel.
    task = make_task("kinetarium.envs.ant:Ant", 2)
    task.begin(np.arange(2), [np.random.default_rng(k) for k in range(2)])
    assert (task.seen.contact_force == 0).all()
    for _ in range(200):
        task.act(np.zeros((2, 8), np.float32))
    weight = 9.81 * task.model.total_mass
    torque, force = np.split(task.seen.contact_force.sum(axis=1), 2, axis=1)
    np.testing.assert_allclose(force, [[0, 0, weight]] * 2, atol=0.02 * weight)
    np.testing.assert_allclose(torque, 0, atol=0.02 * weight)
    # Clipped in what is observed.
    assert np.abs(task.observe()[:, -78:]).max() <= 1


def rollout(envs, steps, seed, scale=1.0):
    """What `step` gives under random actions, the same in each world whatever their number."""
    told = [(*envs.reset(seed=seed)[:1], None, None, None, None)]
    randoms = [np.random.default_rng(100 + k) for k in range(envs.num_envs)]
    low, high = envs.single_action_space.low, envs.single_action_space.high
    for _ in range(steps):
        actions = np.array([scale * r.uniform(low, high) for r in randoms], np.float32)
        told.append(envs.step(actions))
    return told


@robots
def test_worlds_do_the_same_whatever_their_number(robot):
    few, many = (
        rollout(gymnasium.make_vec(f"kinetarium/{robot}-v0", num_envs=n, max_episode_steps=20), 45, seed=7)
        for n in (3, 21)
    )
    for some, all_ in zip(few, many, strict=True):
        for a, b in zip(some[:4], all_[:4], strict=True):
            np.testing.assert_array_equal(a, None if b is None else b[:3])


@robots
def test_a_world_is_the_single_environment(robot):
    # NextStep: the step after an end is a reset, as SyncVectorEnv does it on single environments.
    kwargs = {"num_envs": 3, "max_episode_steps": 15}
    native = rollout(gymnasium.make_vec(f"kinetarium/{robot}-v0", **kwargs), 40, seed=3)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        singles = gymnasium.make_vec(f"kinetarium/{robot}-v0", vectorization_mode="sync", **kwargs)
        singles = rollout(singles, 40, seed=3)
    for found, expected in zip(native, singles, strict=True):
        for a, b in zip(found[:4], expected[:4], strict=True):
            np.testing.assert_array_equal(a, b)
        if found[4] is not None:
            assert set(found[4]) == set(expected[4])
            for name in found[4]:
                np.testing.assert_array_equal(found[4][name], expected[4][name], err_msg=name)


@pytest.mark.parametrize("robot", ["Hopper", "Reacher", "Humanoid"])
def test_same_step_resets_tell_of_the_end(robot):
    kwargs = {"num_envs": 4, "max_episode_steps": 12}
    mode = AutoresetMode.SAME_STEP
    native = gymnasium.make_vec(f"kinetarium/{robot}-v0", autoreset_mode=mode, **kwargs)
    assert native.metadata["autoreset_mode"] is mode
    native = rollout(native, 30, seed=3)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        singles = gymnasium.make_vec(
            f"kinetarium/{robot}-v0",
            vectorization_mode="sync",
            vector_kwargs={"autoreset_mode": mode},
            **kwargs,
        )
        singles = rollout(singles, 30, seed=3)
    ends = 0
    for found, expected in zip(native[1:], singles[1:], strict=True):
        for a, b in zip(found[:4], expected[:4], strict=True):
            np.testing.assert_array_equal(a, b)
        ended = found[2] | found[3]
        ends += ended.sum()
        assert ("final_obs" in found[4]) == ended.any()
        if ended.any():
            np.testing.assert_array_equal(found[4]["_final_obs"], ended)
            for k in np.flatnonzero(ended):
                np.testing.assert_array_equal(found[4]["final_obs"][k], expected[4]["final_obs"][k])
            for name, values in expected[4]["final_info"].items():
                np.testing.assert_array_equal(found[4]["final_info"][name], values, err_msg=name)
    assert ends >= 8


@robots
@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_what_is_told_is_a_copy(robot, mode):
    def spoil(told):
        for values in told.values():
            if isinstance(values, dict):
                spoil(values)
            elif values.dtype != object:
                values[...] = values == 0

    def outcomes(spoilt):
        envs = gymnasium.make_vec(f"kinetarium/{robot}-v0", num_envs=2, max_episode_steps=3, autoreset_mode=mode)
        _, infos = envs.reset(seed=0)
        randoms = np.random.default_rng(0)
        for _ in range(8):
            if spoilt:
                spoil(infos)
            actions = randoms.uniform(-0.5, 0.5, envs.action_space.shape)
            observed, reward, *_, infos = envs.step(actions)
            yield observed, reward

    for found, expected in zip(outcomes(True), outcomes(False), strict=True):
        for a, b in zip(found, expected, strict=True):
            np.testing.assert_array_equal(a, b)


def test_speeds_are_measured_from_a_copy():
    # What has been seen may be written to: the next step's reward does not depend on it.
    task = make_task("kinetarium.envs.hopper:Hopper", 2)
    still = np.zeros((2, 3), np.float32)
    task.seen.position[:] = 7
    assert np.abs(task.act(still)[0]).max() < 2


class Telling(kinetarium.envs.hopper.Hopper):
    """It tells of more than one number, and of what is no number."""

    def whereabouts(self, seen):
        return {"pair": seen.position[:, :2], "healthy": self.healthy(seen)}


def test_what_is_told_keeps_its_shape_and_kind():
    envs = kinetarium.envs.VectorTask(Telling, 3, autoreset_mode="Disabled")
    envs.reset(seed=0)
    _, infos = envs.reset(options={"reset_mask": np.array([True, False, True])})
    assert infos["healthy"].dtype == bool and infos["healthy"].tolist() == [True, False, True]
    assert infos["pair"].shape == (3, 2) and (infos["pair"][1] == 0).all() and infos["pair"][0, 1] > 1


def test_resets_of_a_mask():
    envs = gymnasium.make_vec("kinetarium/Hopper-v0", num_envs=4, autoreset_mode="Disabled")
    envs.reset(seed=0)
    before = envs.step(np.ones((4, 3), np.float32))[0]
    mask = np.array([False, True, False, True])
    after, _ = envs.reset(options={"reset_mask": mask})
    np.testing.assert_array_equal((before != after).any(axis=1), mask)
    with pytest.raises(ValueError, match="mask of worlds"):
        envs.reset(options={"reset_mask": np.zeros(4, bool)})


def going_on(env, steps):
    """What the next steps of an environment give, with new episodes, under random actions."""
    random = np.random.default_rng(9)
    for _ in range(steps):
        *told, info = env.step(random.uniform(-1, 1, env.action_space.shape))
        yield [*told, *(info[name] for name in sorted(info))]
        if not isinstance(env, gymnasium.vector.VectorEnv) and (told[2] or told[3]):
            yield [env.reset()[0]]


def test_without_autoreset_nobody_goes_on_after_the_end():
    envs = gymnasium.make_vec("kinetarium/Hopper-v0", num_envs=3, max_episode_steps=9, autoreset_mode="Disabled")
    still = np.zeros((3, 3), np.float32)
    envs.reset(seed=0)
    for _ in range(4):
        envs.step(still)
    envs.reset(options={"reset_mask": np.array([False, True, False])})
    for _ in range(5):
        truncated = envs.step(still)[3]
    assert truncated.tolist() == [True, False, True]
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"worlds \[0, 2\] have ended: .*reset_mask"):
        envs.step(still)
    envs.reset(options={"reset_mask": truncated})
    assert not envs.step(still)[3].any()


@robots
@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
@pytest.mark.parametrize("make", [gymnasium.make, partial(gymnasium.make_vec, num_envs=3)])
def test_copies_go_on_to_the_bit(robot, copied, make):
    env = make(f"kinetarium/{robot}-v0", max_episode_steps=12)
    env.reset(seed=0)
    for _ in going_on(env, 17):
        pass
    same = copied(env)
    np.testing.assert_array_equal(same.unwrapped.task.observe(), env.unwrapped.task.observe())
    # Original and copy by turns: neither disturbs the other. Episodes end and begin anew meanwhile.
    for found, expected in zip(going_on(same, 30), going_on(env, 30), strict=True):
        for a, b in zip(found, expected, strict=True):
            np.testing.assert_array_equal(a, b)
    assert same.spec == env.spec


def test_copies_keep_the_camera_and_other_parameters():
    env = gymnasium.make("kinetarium/Hopper-v0", render_mode="rgb_array")
    env.reset(seed=0)
    env.unwrapped.task.simulation.parameters.gravity = (0, 0, -2)
    picture = env.render()
    same = copy.deepcopy(env)
    np.testing.assert_array_equal(same.render(), picture)
    still = np.zeros(3, np.float32)
    np.testing.assert_array_equal(same.step(still)[0], env.step(still)[0])


@pytest.mark.parametrize("robot", MORTAL)
def test_who_is_not_healthy_has_failed(robot):
    # Enough of them: of ants, one in five jumps too high meanwhile.
    envs = gymnasium.make_vec(f"kinetarium/{robot}-v0", num_envs=32, autoreset_mode="Disabled")
    envs.reset(seed=0)
    task, random, ends = envs.unwrapped.task, np.random.default_rng(0), 0
    for _ in range(150):
        _, _, failed, _, infos = envs.step(random.uniform(-1, 1, envs.action_space.shape))
        np.testing.assert_array_equal(failed, ~task.healthy(task.seen))
        np.testing.assert_array_equal(failed, infos["reward_survive"] == 0)
        ends += failed.sum()
        if failed.any():
            envs.reset(options={"reset_mask": failed})
    assert ends > 0


def test_time_runs_out():
    envs = gymnasium.make_vec("kinetarium/HalfCheetah-v0", num_envs=2, max_episode_steps=5)
    envs.reset(seed=0)
    actions = np.zeros((2, 6), np.float32)
    truncated = [envs.step(actions)[3].all() for _ in range(12)]
    # After the fifth step, then one that begins anew, and five more.
    assert np.flatnonzero(truncated).tolist() == [4, 10]


@pytest.mark.parametrize("mode", ["sync", "vector_entry_point"])
@pytest.mark.parametrize(("steps", "truncated"), [(-1, False), (None, True)])
def test_no_end_and_the_registered_one(mode, steps, truncated):
    # Gymnasium's: -1 is no end, and none is that of the registration, 50 steps.
    name = "kinetarium/Reacher-v0"
    envs = gymnasium.make_vec(name, num_envs=1, max_episode_steps=steps, vectorization_mode=mode)
    envs.reset(seed=0)
    ends = [envs.step(np.zeros((1, 2), np.float32))[3][0] for _ in range(50)]
    assert not any(ends[:-1]) and ends[-1] == truncated


class Wrong(kinetarium.envs.hopper.Hopper):
    """It draws one coordinate too many."""

    def draw(self, random):
        position, velocity = super().draw(random)
        return np.append(position, 0.0), velocity


def test_what_cannot_be_is_refused():
    hopper = "kinetarium.envs.hopper:Hopper"
    for options, message in [
        ({"max_episode_steps": 0}, "max_episode_steps is 0"),
        ({"max_episode_steps": -2}, "max_episode_steps is -2"),
        ({"frame_skip": 0}, "frame_skip is 0"),
        ({"frame_skip": -1}, "frame_skip is -1"),
        ({"frame_skip": 2.5}, "frame_skip is 2.5"),
        ({"num_envs": 0}, "number of worlds is 0"),
        ({"xml_file": "ant.xml"}, '"ant.xml" has no joint "rooty", which Hopper observes'),
    ]:
        with pytest.raises(ValueError, match=message):
            kinetarium.envs.VectorTask(hopper, **options)
    unmade = kinetarium.envs.VectorTask.__new__(kinetarium.envs.VectorTask)
    with pytest.raises(ValueError, match="number of worlds is 0"):
        unmade.__init__(hopper, 0)
    unmade.close()
    for task in ("foo", 3):
        with pytest.raises(ValueError, match='its name "module:Class"'):
            kinetarium.envs.VectorTask(task)
    wrong = kinetarium.envs.VectorTask(Wrong, 2)
    with pytest.raises(ShapeError, match=r"\(2, 7\): it must be \(2, 6\)"):
        wrong.reset(seed=0)


def hopper_that(**methods):
    """A task with these methods in place of the hopper's, of three worlds."""
    return type("Mine", (kinetarium.envs.hopper.Hopper,), methods)(3)


def test_an_observation_may_be_one_array():
    alone = hopper_that(observation=lambda self, seen: seen.velocity)
    listed = hopper_that(observation=lambda self, seen: [seen.velocity])
    for task in (alone, listed):
        task.set_state(np.tile(task.init_position, (3, 1)), np.arange(18.0).reshape(3, 6))
    assert alone.observation_space == listed.observation_space
    np.testing.assert_array_equal(alone.observe(), listed.observe())
    named = hopper_that(observation=lambda self, seen: "joint_velocity")
    assert named.observe().shape == (3, 6)


def test_what_is_not_of_all_worlds_is_refused():
    for given in (lambda seen: seen.velocity.T, lambda seen: [seen.position, seen.velocity[0]]):
        with pytest.raises(ShapeError, match=r"Mine.observation: part [01] has the shape .*: it must be \(3, …\)"):
            hopper_that(observation=lambda self, seen, given=given: given(seen))
    good = {"reward": np.zeros(3), "failed": np.zeros(3, bool), "info": {}}
    for wrong, message in [
        ({"reward": np.zeros((3, 1))}, r"the reward has the shape \(3, 1\): it must be \(3,\)"),
        ({"reward": 1.0}, r"the reward has the shape \(\): it must be \(3,\)"),
        ({"failed": np.zeros(2, bool)}, r"failed has the shape \(2,\): it must be \(3,\)"),
        ({"failed": np.zeros(3)}, "failed is of dtype float64: it must be bool"),
        ({"info": {"x": np.zeros((2, 3))}}, r'info\["x"\] has the shape \(2, 3\): it must be \(3, …\)'),
    ]:
        told = good | wrong
        task = hopper_that(outcome=lambda self, *_, told=told: tuple(told.values()))
        with pytest.raises(ShapeError, match=f"Mine.outcome: {message}"):
            task.act(np.zeros((3, 3), np.float32))


@robots
def test_options_that_cannot_be_are_refused(robot):
    module, *_ = ROBOTS[robot]
    task = getattr(importlib.import_module(f"kinetarium.envs.{module}"), robot)
    options = {k: v for base in task.__mro__[:-3] for k, v in inspect.signature(base).parameters.items()}
    ranges = [name for name in options if name.endswith("_range")]
    numbers = [name for name in options if name.endswith(("_weight", "_reward", "_scale"))]
    assert numbers
    for name in numbers:
        for value in (np.nan, np.inf, "1", None, [1.0, 2.0]):
            with pytest.raises(ValueError, match=name):
                task(1, **{name: value})
    for name in (name for name, parameter in options.items() if isinstance(parameter.default, bool)):
        for value in ("no", None, 2, [True]):
            with pytest.raises(ValueError, match=rf"{name} is .*: it must be True or False"):
                task(1, **{name: value})
        task(1, **{name: np.bool_(False)})
    for name in ranges:
        for value in (0.7, (1.0,), (2.0, 1.0), (np.nan, 1.0), "ab", ((0, 1), 2), None):
            with pytest.raises(ValueError, match=f"{name} is .*: give its two ends"):
                task(1, **{name: value})
        task(1, **{name: np.array([0, np.inf])})
    if "reset_noise_scale" in numbers:
        with pytest.raises(ValueError, match="reset_noise_scale is -1: it must be finite, and 0 or more"):
            task(1, reset_noise_scale=-1)
    for make in (gymnasium.make, gymnasium.make_vec):
        for size in ({"width": 0}, {"height": -1}, {"width": 0.5}):
            with pytest.raises((ValueError, TypeError), match=f"{min(size)} is "):
                make(f"kinetarium/{robot}-v0", **size)


def test_the_main_body_is_one_of_the_robots():
    def main(body):
        task = make_task("kinetarium.envs.ant:Ant", 1, main_body=body)
        return task.model.body_names[task.main]

    assert main(1) == main("torso") == "torso"
    assert main(np.int64(13)) == main(13) == "body_13"
    for body in (0, -5, 14, 1.5, None):
        with pytest.raises(ValueError, match=rf"main_body is {body}: .* from 1 to 13"):
            main(body)
    with pytest.raises(UnknownNameError, match="torso"):
        main("torsos")


def test_seeds_are_whole_numbers():
    envs = gymnasium.make_vec("kinetarium/Reacher-v0", num_envs=3)
    expected, _ = envs.reset(seed=4)
    for seed in (np.int32(4), [4, 5, 6], (4, 5, 6), np.array([4, 5, 6])):
        np.testing.assert_array_equal(envs.reset(seed=seed)[0], expected)
    for seed in (1.5, "abc", [1.5, 2, 3]):
        with pytest.raises(gymnasium.error.Error, match="must be a python integer"):
            envs.reset(seed=seed)
    with pytest.raises(ValueError, match="2 seeds for 3 worlds"):
        envs.reset(seed=[1, 2])


def test_worlds_without_a_seed_draw_on():
    envs = gymnasium.make_vec("kinetarium/Reacher-v0", num_envs=2)
    envs.reset(seed=0)
    second, _ = envs.reset()
    envs.reset(seed=0)
    found, _ = envs.reset(seed=[None, 7])
    np.testing.assert_array_equal(found[0], second[0])
    np.testing.assert_array_equal(found[1], envs.reset(seed=7)[0][0])


@robots
def test_actions_that_are_not_finite_are_refused(robot):
    envs = gymnasium.make_vec(f"kinetarium/{robot}-v0", num_envs=3)
    envs.reset(seed=0)
    actions = np.zeros(envs.action_space.shape, np.float32)
    actions[1, 0] = np.nan
    with pytest.raises(ValueError, match="action of world 1 is not finite"):
        envs.step(actions)
    with pytest.raises(ValueError, match="shape"):
        envs.step(actions[:, :0])
    for dtype in (object, complex):
        with pytest.raises(ValueError, match=f"actions are of dtype {np.dtype(dtype)}: give real numbers"):
            envs.step(actions.astype(dtype))


def test_the_shape_of_an_action_is_told_as_the_space_has_it():
    env = gymnasium.make("kinetarium/Hopper-v0", disable_env_checker=True)
    env.reset(seed=0)
    for action in (np.zeros(2), np.zeros((1, 3)), 0.0):
        with pytest.raises(ValueError, match=re.escape(f"the shape {np.shape(action)}: it must be (3,)")):
            env.step(action)


@robots
def test_actions_out_of_range_act_as_its_ends(robot):
    def after(factor):
        env = gymnasium.make(f"kinetarium/{robot}-v0", disable_env_checker=True).unwrapped
        env.reset(seed=0)
        return env.step(factor * env.action_space.high)[0]

    np.testing.assert_array_equal(after(1.0), after(3.0))
    assert (after(1.0) != after(0.5)).any()


def test_a_world_that_diverges_fails_and_begins_anew():
    envs = gymnasium.make_vec("kinetarium/HalfCheetah-v0", num_envs=3)
    envs.reset(seed=0)
    task = envs.unwrapped.task
    position, velocity = task.seen.position.copy(), task.seen.velocity.copy()
    velocity[1] = 1e4
    task.set_state(position, velocity)
    ends = np.zeros(3, bool)
    for _ in range(5):
        observed, reward, failed, truncated, _ = envs.step(np.zeros((3, 6), np.float32))
        ends |= failed
        assert np.isfinite(observed).all() and np.isfinite(reward).all() and not truncated.any()
    assert ends.tolist() == [False, True, False]
    assert np.abs(observed[1]).max() < 10


def test_whole_turns_are_counted():
    # In the air with no torque about its hinges to speak of, the cheetah's pitch goes on beyond π.
    task = make_task("kinetarium.envs.half_cheetah:HalfCheetah", 1)
    position, velocity = task.init_position.copy(), np.zeros(9)
    position[1], velocity[1], velocity[2] = 100, 5, 10
    task.set_state(position[None], velocity[None])
    angles = []
    for _ in range(30):
        task.act(np.zeros((1, 6), np.float32))
        angles.append(task.seen.position[0, 2])
    assert (np.diff(angles) > 0).all() and angles[-1] > 2 * np.pi


def test_options_are_gymnasiums():
    options = {
        "include_cinert_in_observation": False,
        "include_cfrc_ext_in_observation": False,
        "exclude_current_positions_from_observation": False,
        "frame_skip": 2,
    }
    own = gymnasium.make("kinetarium/Humanoid-v0", **options)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        other = gymnasium.make("Humanoid-v5", **options)
    assert own.observation_space == other.observation_space
    assert own.unwrapped.dt == pytest.approx(other.unwrapped.dt)
    with pytest.raises(ValueError, match="rgb_array"):
        kinetarium.envs.SingleTask("kinetarium.envs.hopper:Hopper", render_mode="human")
    with pytest.raises(FileNotFoundError, match="no file"):
        gymnasium.make("kinetarium/Hopper-v0", xml_file="centipede.xml")


def test_the_robots_file_is_gymnasiums_or_the_one_given(tmp_path, monkeypatch):
    def gear(**options):
        return make_task("kinetarium.envs.hopper:Hopper", 1, **options).gear.tolist()

    usual = gear()
    text = model_file(None, "hopper.xml").read_text()
    (tmp_path / "hopper.xml").write_text(text.replace('gear="200.0"', 'gear="3.0"'))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert gear() == usual == [200, 200, 200]
    for file in ("hopper.xml", "./hopper.xml", "~/hopper.xml", tmp_path / "hopper.xml"):
        assert gear(xml_file=file) == [3, 3, 3]
    assert gear(xml_file="walker2d_v5.xml") == [100, 100, 100] * 2
    for file in ("./walker2d_v5.xml", "", "."):  # a path is no name among Gymnasium's
        with pytest.raises(FileNotFoundError, match="no file"):
            gear(xml_file=file)


def test_pictures_go_along_with_the_robot():
    env = gymnasium.make("kinetarium/Hopper-v0", render_mode="rgb_array")
    env.reset(seed=0)
    first = env.render()
    assert first.shape == (480, 480, 3) and first.dtype == np.uint8 and first.std() > 5
    task = env.unwrapped.task
    q = task.seen.position.copy()
    q[:, 0] += 3.0  # [m] along its way: the robot stays in the image, at the same place
    task.set_state(q, task.seen.velocity)
    moved = env.render()
    robot = np.abs(first.astype(int) - first[0, 0]).sum(axis=2) > 150
    again = np.abs(moved.astype(int) - moved[0, 0]).sum(axis=2) > 150
    assert robot.sum() > 2000 and (robot & again).sum() > 0.9 * robot.sum()
    vectors = gymnasium.make_vec("kinetarium/Reacher-v0", num_envs=2, render_mode="rgb_array")
    vectors.reset(seed=0)
    assert [picture.shape for picture in vectors.render()] == [(480, 480, 3)] * 2
    vectors.close()
    small = gymnasium.make("kinetarium/Reacher-v0", render_mode="rgb_array", width=40, height=30)
    small.reset(seed=0)
    assert small.render().shape == (30, 40, 3)


def test_an_id_brings_its_module():
    # In a process of its own, where nothing has been imported.
    code = "import gymnasium; print(gymnasium.make('kinetarium.envs:kinetarium/Reacher-v0').unwrapped.task.dt)"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert float(told) == pytest.approx(0.02)


def test_robots_are_gymnasiums():
    # But for the one that swims in a fluid.
    registered = gymnasium.registry.values()
    theirs = {spec.name for spec in registered if "envs.mujoco" in str(spec.entry_point) and spec.version == 5}
    own = {spec.name for spec in registered if spec.namespace == "kinetarium"}
    assert own == theirs - {"Swimmer"} == set(ROBOTS)
