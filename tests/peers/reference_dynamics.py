"""Writes MuJoCo's view of every MJCF model that gymnasium ships, for the Rust tests to compare with.

For each model, `<out>/<model>.json` holds what loading must reproduce (masses, inertias, frames, joints,
contacts) and 200 random states with the accelerations, mass matrix, body poses and energy that MuJoCo
computes there. Contacts and fluid drag are switched off, and no limit is active in any state.

Conventions are MuJoCo's: SI units, quaternions w x y z, body inertias about the centre of mass in the
principal frame `body_iquat`; a free joint's velocity is linear (world axes) then angular (body axes).
Body 0 is the world.
"""

import argparse
import json
from pathlib import Path

import gymnasium
import mujoco
import numpy as np
from contacts import contacts

ASSETS = Path(gymnasium.__file__).parent / "envs/mujoco/assets"
STATES = 200
LIMIT_MARGIN = 0.05  # share of a joint's range kept free at either end
OBJ_NAMES = {"body": mujoco.mjtObj.mjOBJ_BODY, "joint": mujoco.mjtObj.mjOBJ_JOINT}
JOINT_TYPES = {
    mujoco.mjtJoint.mjJNT_FREE: "free",
    mujoco.mjtJoint.mjJNT_BALL: "ball",
    mujoco.mjtJoint.mjJNT_SLIDE: "slide",
    mujoco.mjtJoint.mjJNT_HINGE: "hinge",
}


def load(path: Path) -> tuple[mujoco.MjModel, list[str]]:
    """Loads a model without contacts and fluid drag; returns it with what was switched off."""
    model = mujoco.MjModel.from_xml_path(str(path))
    switched_off = ["contact"]
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    if model.opt.density or model.opt.viscosity:
        switched_off.append("fluid")
        model.opt.density = model.opt.viscosity = 0.0
    return model, switched_off


def random_quaternion(rng: np.random.Generator) -> np.ndarray:
    """A unit quaternion, uniform over the rotations."""
    q = rng.normal(size=4)
    return q / np.linalg.norm(q)


def random_joint_position(model: mujoco.MjModel, joint: int, rng: np.random.Generator) -> np.ndarray:
    """A position of one joint [m, rad], inside its limits by a margin."""
    kind = model.jnt_type[joint]
    if kind == mujoco.mjtJoint.mjJNT_FREE:
        return np.concatenate([rng.uniform(-2.0, 2.0, size=3), random_quaternion(rng)])
    if kind == mujoco.mjtJoint.mjJNT_BALL:
        return random_quaternion(rng)
    if model.jnt_limited[joint]:
        low, high = model.jnt_range[joint]
        margin = LIMIT_MARGIN * (high - low)
        return rng.uniform(low + margin, high - margin, size=1)
    reach = np.pi if kind == mujoco.mjtJoint.mjJNT_HINGE else 2.0
    return rng.uniform(-reach, reach, size=1)


def random_controls(model: mujoco.MjModel, rng: np.random.Generator) -> np.ndarray:
    """Controls within their range; N(0, 1) where a control has none."""
    low, high = model.actuator_ctrlrange.T
    inside = rng.uniform(low, np.maximum(high, low))
    return np.where(model.actuator_ctrllimited, inside, rng.normal(size=model.nu))


def dynamics_at(model: mujoco.MjModel, data: mujoco.MjData) -> dict:
    """Evaluates the current state; accelerations are continuous-time ones (damping explicit)."""
    mujoco.mj_forward(model, data)
    if data.nefc:
        raise RuntimeError(f"{data.nefc} constraint rows are active where none should be")
    mass_matrix = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass_matrix)
    return {
        "qpos": data.qpos.tolist(),
        "qvel": data.qvel.tolist(),
        "ctrl": data.ctrl.tolist(),
        "qacc": data.qacc.tolist(),
        "qfrc_bias": data.qfrc_bias.tolist(),
        "qfrc_passive": data.qfrc_passive.tolist(),
        "qfrc_actuator": data.qfrc_actuator.tolist(),
        "mass_matrix": mass_matrix.tolist(),
        "xpos": data.xpos.tolist(),
        "xquat": data.xquat.tolist(),
        "energy": {"potential": data.energy[0], "kinetic": data.energy[1]},
    }


def random_states(model: mujoco.MjModel, rng: np.random.Generator) -> list[dict]:
    """Draws the states and evaluates each."""
    data = mujoco.MjData(model)
    states = []
    for _ in range(STATES):
        data.qpos[:] = np.concatenate([random_joint_position(model, j, rng) for j in range(model.njnt)])
        data.qvel[:] = rng.normal(size=model.nv)
        data.ctrl[:] = random_controls(model, rng)
        states.append(dynamics_at(model, data))
    return states


def names(model: mujoco.MjModel, kind: str, count: int) -> list[str]:
    """Names of all bodies or joints; the empty string where the file gives none."""
    return [mujoco.mj_id2name(model, OBJ_NAMES[kind], i) or "" for i in range(count)]


def describe(path: Path, model: mujoco.MjModel, switched_off: list[str]) -> dict:
    """What loading the file must reproduce."""
    return {
        "model": path.stem,
        "path": str(path),
        "mujoco": mujoco.__version__,
        "switched_off": switched_off,
        "gravity": model.opt.gravity.tolist(),
        "timestep": model.opt.timestep,
        "nq": model.nq,
        "nv": model.nv,
        "nu": model.nu,
        "joint_name": names(model, "joint", model.njnt),
        "joint_type": [JOINT_TYPES[mujoco.mjtJoint(t)] for t in model.jnt_type],
        "joint_qposadr": model.jnt_qposadr.tolist(),
        "joint_dofadr": model.jnt_dofadr.tolist(),
        "body_name": names(model, "body", model.nbody),
        "body_parent": model.body_parentid.tolist(),
        "body_mass": model.body_mass.tolist(),
        "body_inertia": model.body_inertia.tolist(),
        "body_ipos": model.body_ipos.tolist(),
        "body_iquat": model.body_iquat.tolist(),
        "dof_armature": model.dof_armature.tolist(),
        "contacts": contacts(model),
    }


def write(path: Path, out: Path) -> Path:
    """Writes one model's reference; the seed is fixed by the model's name."""
    model, switched_off = load(path)
    rng = np.random.default_rng(list(path.stem.encode()))
    reference = describe(path, model, switched_off)
    reference["states"] = random_states(model, rng)
    target = out / f"{path.stem}.json"
    target.write_text(json.dumps(reference))
    return target


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="folder the JSON files go to")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    for path in sorted(ASSETS.glob("*.xml")):
        print(write(path, arguments.out))


if __name__ == "__main__":
    main()
