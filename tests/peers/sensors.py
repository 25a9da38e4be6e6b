"""Writes what MuJoCo's sensors measure, for the Rust tests to compare with.

For each model that gymnasium ships, `<out>/<model>.json` holds sensors at a random site of every body, and
their readings at random states without contacts, fluid drag and active limits. `<out>/rays.json` holds
rangefinders among solids of all kinds, `<out>/resting.json` touch sensors of what lies on the ground; their
models are written beside them.

Conventions are MuJoCo's: SI units, quaternions w x y z. A site's pose is in the frame of its body.
"""

import argparse
import json
from pathlib import Path

import mujoco
import numpy as np
from reference_dynamics import ASSETS, load, random_controls, random_joint_position, random_quaternion

STATES = 20
# What is measured at a site, by MuJoCo's name.
AT_SITES = ["accelerometer", "gyro", "velocimeter", "framelinvel", "frameangvel", "framepos", "framequat"]
# And where a joint holds the site's body.
AT_JOINTS = ["force", "torque"]

RAYS = """
<mujoco>
  <worldbody>
    <geom name="ground" type="plane" size="0 0 1"/>
    <geom type="box" size=".5 .4 .3" pos="3 0 1" euler="10 20 30"/>
    <geom type="sphere" size=".6" pos="-3 .5 1.2"/>
    <geom type="capsule" size=".3 .5" pos="0 3 1" euler="40 10 0"/>
    <geom type="cylinder" size=".4 .5" pos=".5 -3 1" euler="0 60 20"/>
    <geom type="ellipsoid" size=".5 .3 .7" pos="2 2.5 1.5" euler="0 30 70"/>
    <body name="eye" pos="0 0 1">
      <freejoint/>
      <geom type="box" size=".2 .2 .2"/>
    </body>
  </worldbody>
</mujoco>
"""

RESTING = """
<mujoco>
  <option cone="elliptic"/>
  <worldbody>
    <geom name="ground" type="plane" size="0 0 1"/>
    <body name="lower" pos="0 0 .1">
      <freejoint/>
      <geom type="box" size=".2 .3 .1"/>
    </body>
    <body name="upper" pos=".02 .01 .28">
      <freejoint/>
      <geom type="box" size=".1 .1 .08"/>
    </body>
    <body name="ball" pos="1 0 .15">
      <freejoint/>
      <geom type="sphere" size=".15"/>
    </body>
  </worldbody>
</mujoco>
"""


def sensor_type(name: str) -> mujoco.mjtSensor:
    """MuJoCo's number for a kind of sensor."""
    return getattr(mujoco.mjtSensor, f"mjSENS_{name.upper()}")


def add_sensor(spec: mujoco.MjSpec, kind: str, of: mujoco.mjtObj, name: str) -> None:
    """Adds a sensor of a site or joint, named by its kind and that."""
    sensor = spec.add_sensor(name=f"{kind} {name}", type=sensor_type(kind), objtype=of, objname=name)
    if kind == "rangefinder":
        sensor.intprm[0] = 1 << int(mujoco.mjtRayDataField.mjRAYDATA_DIST)  # the distance alone


def described(model: mujoco.MjModel) -> list[dict]:
    """What each sensor is, and where: at a site of a body, counted without the world, or at a joint's degree
    of freedom."""
    sensors = []
    for i, of in enumerate(model.sensor_objid):
        sensor = {"kind": model.sensor(i).name.split(" ", 1)[0]}
        if model.sensor_objtype[i] == mujoco.mjtObj.mjOBJ_SITE:
            sensor["body"] = int(model.site_bodyid[of]) - 1
            sensor["pos"] = model.site_pos[of].tolist()
            sensor["quat"] = model.site_quat[of].tolist()
        else:
            sensor["dof"] = int(model.jnt_dofadr[of])
        sensors.append(sensor)
    return sensors


def reference(path: Path, model: mujoco.MjModel, states: list[dict], *, lenient: bool = False) -> dict:
    """A file for the tests."""
    return {"path": str(path), "lenient": lenient, "sensors": described(model), "states": states}


def measured(model: mujoco.MjModel, data: mujoco.MjData) -> dict:
    """The present state, and what the sensors read there."""
    mujoco.mj_forward(model, data)
    ends = np.cumsum(model.sensor_dim)
    return {
        "qpos": data.qpos.tolist(),
        "qvel": data.qvel.tolist(),
        "ctrl": data.ctrl.tolist(),
        "readings": [numbers.tolist() for numbers in np.split(data.sensordata, ends[:-1])],
    }


def with_sensors(path: Path, rng: np.random.Generator) -> tuple[mujoco.MjModel, list[str]]:
    """A model of gymnasium with a site on each body, and all sensors there."""
    _, switched_off = load(path)
    spec = mujoco.MjSpec.from_file(str(path))
    for row, body in enumerate(spec.bodies[1:]):
        name = f"at {row}"
        body.add_site(name=name, pos=rng.normal(size=3) * 0.2, quat=random_quaternion(rng))
        free = any(joint.type == mujoco.mjtJoint.mjJNT_FREE for joint in body.joints)
        held = bool(body.joints) and not free
        for kind in AT_SITES + (AT_JOINTS if held else []):
            add_sensor(spec, kind, mujoco.mjtObj.mjOBJ_SITE, name)
    for row, joint in enumerate(spec.joints):
        joint.name = joint.name or f"joint {row}"
        if joint.type in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
            add_sensor(spec, "jointactfrc", mujoco.mjtObj.mjOBJ_JOINT, joint.name)
    model = spec.compile()
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.opt.density = model.opt.viscosity = 0.0
    return model, switched_off


def moving(path: Path) -> dict:
    """Sensors of one of gymnasium's models at random states; the seed is fixed by the model's name."""
    rng = np.random.default_rng(list(path.stem.encode()))
    model, switched_off = with_sensors(path, rng)
    data = mujoco.MjData(model)
    states = []
    for _ in range(STATES):
        data.qpos[:] = np.concatenate([random_joint_position(model, j, rng) for j in range(model.njnt)])
        data.qvel[:] = rng.normal(size=model.nv)
        data.ctrl[:] = random_controls(model, rng)
        states.append(measured(model, data))
    return reference(path, model, states, lenient="fluid" in switched_off)


def rays(path: Path) -> dict:
    """Rangefinders on a body that turns about among solids."""
    rng = np.random.default_rng(1)
    spec = mujoco.MjSpec.from_file(str(path))
    for i in range(100):
        name = f"ray {i}"
        spec.body("eye").add_site(name=name, pos=rng.normal(size=3) * 0.1, quat=random_quaternion(rng))
        add_sensor(spec, "rangefinder", mujoco.mjtObj.mjOBJ_SITE, name)
    model = spec.compile()
    data = mujoco.MjData(model)
    states = []
    for _ in range(STATES):
        data.qpos[:] = np.concatenate([[0.0, 0.0, 1.2], random_quaternion(rng)])
        states.append(measured(model, data))
    return reference(path, model, states)


def resting(path: Path) -> dict:
    """Touch sensors about whole bodies, which have had time to come to rest."""
    spec = mujoco.MjSpec.from_file(str(path))
    for body in spec.bodies[1:]:
        name = f"about {body.name}"
        body.add_site(name=name, type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.5, 0.5, 0.5])
        add_sensor(spec, "touch", mujoco.mjtObj.mjOBJ_SITE, name)
    model = spec.compile()
    data = mujoco.MjData(model)
    while data.time < 5.0:
        mujoco.mj_step(model, data)
    return reference(path, model, [measured(model, data)])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True, help="folder the files go to")
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    references = {path.stem: moving(path) for path in sorted(ASSETS.glob("*.xml"))}
    for name, text, sense in [("rays", RAYS, rays), ("resting", RESTING, resting)]:
        path = out / f"{name}.xml"
        path.write_text(text)
        references[name] = sense(path)
    for name, reference in references.items():
        target = out / f"{name}.json"
        target.write_text(json.dumps(reference))
        print(target)


if __name__ == "__main__":
    main()
