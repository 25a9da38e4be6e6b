"""Reads a trajectory of the program with numpy alone, and checks what it promises."""

import argparse
from pathlib import Path

import numpy as np


def check(path: Path) -> str:
    """Shapes, units and names of the arrays in an archive, read without pickle."""
    run = np.load(path, allow_pickle=False)
    rows, worlds, coordinates = run["joint_position"].shape
    dofs, bodies = len(run["dof_names"]), len(run["body_names"])
    shapes = {
        "time": (rows,),
        "joint_position": (rows, worlds, coordinates),
        "joint_velocity": (rows, worlds, dofs),
        "body_position": (rows, worlds, bodies, 3),
        "body_orientation": (rows, worlds, bodies, 4),
        "energy": (rows, worlds),
        "kinetic_energy": (rows, worlds),
        "potential_energy": (rows, worlds),
    }
    for name, shape in shapes.items():
        assert run[name].shape == shape, f"{name} has shape {run[name].shape}, not {shape}"
        assert np.isfinite(run[name]).all(), f"{name} holds what is no number"
    assert len(run["coordinate_names"]) == coordinates
    assert all(run[name].dtype.kind == "U" for name in ("coordinate_names", "dof_names", "body_names"))
    assert (np.diff(run["time"]) > 0).all()
    np.testing.assert_allclose(np.linalg.norm(run["body_orientation"], axis=-1), 1, atol=1e-5)
    np.testing.assert_allclose(run["energy"], run["kinetic_energy"] + run["potential_energy"])
    return f"{path.name}: {rows} rows, {worlds} worlds, bodies {', '.join(run['body_names'][:3])} …"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("trajectories", nargs="+", type=Path, help=".npz files")
    for path in parser.parse_args().trajectories:
        print(check(path))


if __name__ == "__main__":
    main()
