"""Writes what MuJoCo makes of each model in this folder to `<model>.json`, for `tests/features.rs`.

The JSON files are committed; run this again (with the pinned peers installed) after a change to a model.
"""

import json
import sys
from pathlib import Path

import mujoco
import numpy as np

FOLDER = Path(__file__).parent
sys.path.append(str(FOLDER.parents[3] / "tests/peers"))
from contacts import contacts  # noqa: E402

STATES = 3


def body_inertia(model: mujoco.MjModel, body: int) -> list:
    """Inertia about the centre of mass along the body's axes [kg·m²]."""
    r = np.zeros(9)
    mujoco.mju_quat2Mat(r, model.body_iquat[body])
    r = r.reshape(3, 3)
    return (r @ np.diag(model.body_inertia[body]) @ r.T).tolist()


def random_coordinates(model: mujoco.MjModel, rng: np.random.Generator) -> np.ndarray:
    """Random joint coordinates with unit quaternions."""
    q = rng.normal(size=model.nq)
    mujoco.mj_normalizeQuat(model, q)
    return q


def states(model: mujoco.MjModel) -> list:
    """Poses of bodies and geoms at the initial coordinates and at random ones."""
    rng, data, rows = np.random.default_rng(1), mujoco.MjData(model), []
    for i in range(STATES):
        data.qpos[:] = model.qpos0 if i == 0 else random_coordinates(model, rng)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_camlight(model, data)
        row = {
            "qpos": data.qpos,
            "xpos": data.xpos,
            "xquat": data.xquat,
            "geom_xpos": data.geom_xpos,
            "geom_xmat": data.geom_xmat,
        }
        if model.ncam:
            row |= {"cam_xpos": data.cam_xpos, "cam_xmat": data.cam_xmat}
        rows.append({name: np.array(value).tolist() for name, value in row.items()})
    return rows


def describe(model: mujoco.MjModel) -> dict:
    """Fields of the compiled model that loading must reproduce."""
    fields = [
        "body_mass",
        "body_ipos",
        "qpos0",
        "qpos_spring",
        "jnt_type",
        "jnt_limited",
        "jnt_range",
        "jnt_margin",
        "jnt_solref",
        "jnt_solimp",
        "jnt_stiffness",
        "jnt_dofadr",
        "jnt_qposadr",
        "dof_damping",
        "dof_armature",
        "dof_frictionloss",
        "dof_invweight0",
        "dof_jntid",
        "actuator_gear",
        "actuator_gainprm",
        "actuator_biasprm",
        "actuator_ctrllimited",
        "actuator_ctrlrange",
        "actuator_forcelimited",
        "actuator_forcerange",
        "actuator_trnid",
        "key_qpos",
        "key_qvel",
        "key_ctrl",
        "geom_type",
        "geom_size",
    ]
    table = {name: np.asarray(getattr(model, name)).tolist() for name in fields}
    table["gravity"], table["timestep"] = model.opt.gravity.tolist(), model.opt.timestep
    table["body_inertia"] = [body_inertia(model, i) for i in range(model.nbody)]
    table["joint_name"] = [model.joint(i).name for i in range(model.njnt)]
    table["body_name"] = [model.body(i).name for i in range(model.nbody)]
    if model.ncam:
        table["cam_name"] = [model.cam(i).name for i in range(model.ncam)]
        table["cam_fovy"], table["cam_resolution"] = model.cam_fovy.tolist(), model.cam_resolution.tolist()
    table["states"] = states(model)
    table["contacts"] = contacts(model)
    return table


def rounded(value):
    """Numbers to 12 digits: enough to compare, and the same on every machine."""
    if isinstance(value, list):
        return [rounded(v) for v in value]
    if isinstance(value, dict):
        return {k: rounded(v) for k, v in value.items()}
    return float(f"{value:.12g}") if isinstance(value, float) else value


if __name__ == "__main__":
    for path in sorted(FOLDER.glob("*.xml")):
        table = rounded(describe(mujoco.MjModel.from_xml_path(str(path))))
        path.with_suffix(".json").write_text(json.dumps(table) + "\n")
