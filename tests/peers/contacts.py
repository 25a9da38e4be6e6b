"""Which geoms MuJoCo lets touch, and how: read off its own list of contacts."""

import copy

import mujoco
import numpy as np

FAR = 1e3  # distance [m] within which all geoms lie


def overlapping(model: mujoco.MjModel) -> mujoco.MjModel:
    """The model with balls for its solids and margins longer by FAR, so that what may touch does."""
    model = copy.deepcopy(model)
    solid = model.geom_type != mujoco.mjtGeom.mjGEOM_PLANE
    model.geom_type[solid] = mujoco.mjtGeom.mjGEOM_SPHERE
    model.geom_size[solid] = 1.0
    model.geom_rbound[solid] = FAR
    model.geom_margin += FAR / 2  # those of two geoms add up
    model.pair_margin += FAR
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_MIDPHASE
    model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    return model


def contacts(model: mujoco.MjModel) -> list[dict]:
    """Each pair of geoms that MuJoCo lets touch: friction (sliding, torsional, rolling), solref,
    solimp, margin, and the mass [kg] that its law of softness is of."""
    model = overlapping(model)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    mujoco.mj_makeConstraint(model, data)
    rows = {}
    for contact in data.contact:
        slide, _, torsion, roll, _ = np.where(np.arange(5) < contact.dim - 1, contact.friction, 0.0).tolist()
        geoms = sorted(contact.geom.tolist())
        rows[tuple(geoms)] = {
            "geoms": geoms,
            "friction": [slide, torsion, roll],
            "solref": contact.solref.tolist(),
            "solimp": contact.solimp.tolist(),
            "margin": round(contact.includemargin - FAR, 9),
            "mass": mass(model, data, contact),
        }
    return [rows[key] for key in sorted(rows)]


def mass(model: mujoco.MjModel, data: mujoco.MjData, contact: mujoco.MjContact) -> float:
    """m of a contact's regulariser R = (1 - d) / (d m), where d is the impedance; all edges of a pyramid press."""
    pyramid = model.opt.cone == mujoco.mjtCone.mjCONE_PYRAMIDAL and contact.dim > 1
    first = contact.efc_address
    softness = 1 / (1 / data.efc_R[first : first + (2 * (contact.dim - 1) if pyramid else 1)]).sum()
    d = data.efc_KBIP[first, 2]
    return float((1 - d) / (d * softness))
