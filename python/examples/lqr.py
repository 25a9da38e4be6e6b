"""A cart balances two poles, one on the other, by a linear regulator made from derivatives of the step.

The step about the upright state is δx' = A δx + B u. The controls u = −K δx that minimise Σ xᵀQx + uᵀRu follow
from the discrete Riccati equation (Kwakernaak & Sivan, Linear Optimal Control Systems, 1972, §6.4), iterated:

    K = (R + BᵀPB)⁻¹ BᵀPA,   P ← Q + AᵀP (A − BK)
"""

import numpy as np

import kinetarium as kn

DT = 0.005  # [s]
SECONDS = 5.0


def cart_with_poles() -> kn.Model:
    """A cart of 1 kg on a rail along x, and two poles of 0.6 m that stand on it."""
    world = kn.Builder("double pendulum")
    robot = world.object("robot")
    cart = robot.body("cart", [kn.Geometry.box((0.1, 0.05, 0.05))], mass=1.0)
    rail = robot.prismatic("rail", cart, (1, 0, 0), damping=0.05)
    below = cart
    for i in range(2):
        rod = kn.Geometry.capsule(radius=0.03, half_height=0.3)
        pole = robot.body(f"pole{i}", [rod], position=(0, 0.3 + 0.6 * i, 0), mass=0.3)
        robot.revolute(f"hinge{i}", pole, (0, 0, 1), parent=below, position=(0, 0.6 * i, 0), damping=0.001)
        below = pole
    robot.motor("push", rail, gear=1.0, control_range=(-100, 100))
    return world.build()


def regulator(a: np.ndarray, b: np.ndarray, q: np.ndarray, r: np.ndarray) -> np.ndarray:
    """The gains K of u = −K x."""
    p = q
    for _ in range(10_000):
        k = np.linalg.solve(r + b.T @ p @ b, b.T @ p @ a)
        following = q + a.T @ p @ (a - b @ k)
        if np.abs(following - p).max() < 1e-9 * np.abs(p).max():
            break
        p = following
    return k


def main() -> None:
    """Balances from a tilt of 0.1 rad in many worlds; without the regulator all poles fall."""
    model = cart_with_poles()
    upright = kn.Simulation(model, dt=DT, contacts=False)
    step = upright.linearize()
    gains = regulator(step.state, step.control, np.diag([1.0, 10, 10, 0.1, 1, 1]), np.eye(1) * 0.01)

    sim = kn.Simulation(model, worlds=64, dt=DT, contacts=False)
    tilts = np.linspace(-0.1, 0.1, sim.worlds)
    for regulated in (True, False):
        sim.set_state(np.stack([np.zeros_like(tilts), tilts, -0.5 * tilts], axis=1))
        for _ in range(int(SECONDS / DT)):
            if regulated:
                x = np.concatenate([sim.state.joint_position, sim.state.joint_velocity], axis=1)
                sim.controls.actuator = -x @ gains.T
            sim.step()
        tip = np.abs(sim.state.joint_position[:, 1:]).sum(axis=1)
        standing = (tip < 0.01).sum()
        what = "with the regulator" if regulated else "without"
        print(f"{what}: {standing} of {sim.worlds} worlds upright after {SECONDS:g} s")


if __name__ == "__main__":
    main()
