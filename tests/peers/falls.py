"""Writes how gymnasium's walking models fall in MuJoCo, for the Rust tests to compare with.

For each model that gravity pulls towards a floor, `<out>/<model>.json` holds two falls from rest, 1 cm
above the floor: one under random controls, recorded with it, and a passive one until the model rests.
MuJoCo keeps the solver and the time step that the file asks for; its integrator is Euler's. Friction is
Coulomb's, which is what Kinetarium solves: an elliptic cone, and impratio 100, so that what rests does not
creep. Whatever the file lets touch touches, parts of the model itself included.

Heights are z of body frames [m], depths the deepest penetration beyond the margins of a contact [m]. `fine` has the
torso's heights in the first 0.3 s by a sixteenth of the time step: how far MuJoCo is from where its own laws lead.
"""

import argparse
import json
from pathlib import Path

import mujoco
import numpy as np
from contacts import contacts
from reference_dynamics import ASSETS, LIMIT_MARGIN, random_controls

CLEARANCE = 0.01  # height [m] of the lowest point above the floor at the start
DRIVEN = 0.3  # duration [s] of the fall under controls
PASSIVE = 10.0  # duration [s] of the passive one
HOLD = 5  # steps for which a control is held
FINER = 16  # steps of the finer fall in one


def load(path: Path) -> mujoco.MjModel:
    """A model as its file has it, but for integrator and friction."""
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
    model.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    model.opt.impratio = 100.0
    return model


def floor_of(model: mujoco.MjModel) -> int | None:
    """The plane that the model may fall on."""
    touching = {geom for contact in contacts(model) for geom in contact["geoms"]}
    planes = np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE)
    falls = model.opt.gravity[2] < -1.0 and height_address(model) is not None
    return next((int(plane) for plane in planes if plane in touching), None) if falls else None


def height_address(model: mujoco.MjModel) -> int | None:
    """Where in qpos the height of the whole model stands."""
    for joint in np.flatnonzero(model.body_parentid[model.jnt_bodyid] == 0):
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE:
            return model.jnt_qposadr[joint] + 2
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE and model.jnt_axis[joint, 2] == 1.0:
            return model.jnt_qposadr[joint]
    return None


def start(model: mujoco.MjModel, floor: int) -> np.ndarray:
    """The initial coordinates, within the joints' limits and just above the floor."""
    data = mujoco.MjData(model)
    for joint in np.flatnonzero(model.jnt_limited):
        low, high = model.jnt_range[joint]
        margin = LIMIT_MARGIN * (high - low)
        at = model.jnt_qposadr[joint]
        data.qpos[at] = np.clip(data.qpos[at], low + margin, high - margin)
    mujoco.mj_kinematics(model, data)
    gaps = []
    for contact in contacts(model):
        if floor in contact["geoms"]:
            (geom,) = set(contact["geoms"]) - {floor}
            gap = mujoco.mj_geomDistance(model, data, geom, floor, 1e3, None)
            gaps.append(gap - contact["margin"])
    data.qpos[height_address(model)] += CLEARANCE - min(gaps)
    return data.qpos.copy()


def fall(model: mujoco.MjModel, qpos: np.ndarray, controls: np.ndarray) -> dict:
    """Steps once per row of controls; notes heights and depth at the start and after each step."""
    data = mujoco.MjData(model)
    data.qpos[:] = qpos
    heights, depths = [], []
    mujoco.mj_forward(model, data)
    for control in [*controls, None]:
        heights.append(data.xpos[1:, 2].tolist())
        depths.append(max([0.0, *(c.includemargin - c.dist for c in data.contact)]))
        if control is not None:
            data.ctrl[:] = control
            mujoco.mj_step(model, data)
            mujoco.mj_forward(model, data)
    return {"controls": controls.tolist(), "heights": heights, "depths": depths}


def fine(model: mujoco.MjModel, qpos: np.ndarray, controls: np.ndarray) -> list[float]:
    """Heights of the torso in the same fall for a sixteenth of the time step, at the same times."""
    step = model.opt.timestep
    model.opt.timestep = step / FINER
    heights = fall(model, qpos, np.repeat(controls[: round(DRIVEN / step)], FINER, axis=0))["heights"]
    model.opt.timestep = step
    return [height[0] for height in heights[::FINER]]


def describe(path: Path, model: mujoco.MjModel, floor: int) -> dict:
    """Both falls of a model."""
    rng = np.random.default_rng(list(path.stem.encode()))
    qpos = start(model, floor)
    h = model.opt.timestep
    rows = [random_controls(model, rng) for _ in range(round(DRIVEN / h / HOLD) + 1)]
    controls = np.repeat(rows, HOLD, axis=0)[: round(DRIVEN / h)]
    driven = fall(model, qpos, controls) | {"fine": fine(model, qpos, controls)}
    still = np.zeros((round(PASSIVE / h), model.nu))
    passive = fall(model, qpos, still) | {"fine": fine(model, qpos, still)}
    return {
        "model": path.stem,
        "path": str(path),
        "mujoco": mujoco.__version__,
        "timestep": h,
        "qpos": qpos.tolist(),
        "driven": driven,
        "passive": passive,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="folder the JSON files go to")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    for path in sorted(ASSETS.glob("*.xml")):
        model = load(path)
        floor = floor_of(model)
        if floor is not None:
            target = arguments.out / f"{path.stem}.json"
            target.write_text(json.dumps(describe(path, model, floor)))
            print(target)


if __name__ == "__main__":
    main()
