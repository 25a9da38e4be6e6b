import { Vector3 } from "three";
import type { Controls } from "./controls";
import type { Notice } from "./notice";
import type { Session } from "./session";
import type { Hold } from "./view/gestures";
import type { Picked } from "./view/overlays/overlay";
import type { View } from "./view/view";

/** How far a key pulls, as a share of the view's height where the body is held. */
const KEY_PULL = 0.05;

/** A body, and a point of it in the scene's axes [m]. */
type Grasped = Picked & { point: Vector3 };

/** Draws a body by a spring, from the pointer or from where keys bring its end. */
export class Grabbing {
  private held: Grip | null = null;

  constructor(
    private readonly session: Session,
    private readonly controls: Controls,
    private readonly view: View,
    private readonly notice: Notice,
  ) {
    session.on("frame", () => this.held?.draw());
    session.on("scene", () => {
      this.held = null;
    });
    // Its replica may not be shown any more.
    session.on("shown", () => this.release());
  }

  get holds(): boolean {
    return this.held !== null;
  }

  /** Takes hold of a body at a point, in the scene's axes, if it can move. */
  take(body: Grasped): Hold | null {
    const grip = this.grasp(body);
    return (
      grip && {
        move: (x, y) => grip.pull(this.view.across(x, y, body.point)),
        end: () => {
          if (this.held === grip) this.release();
        },
      }
    );
  }

  private grasp(body: Grasped): Grip | null {
    this.release();
    const world = this.session.shown[body.row];
    if (world === undefined || !this.session.scene?.bodies[body.body]?.dynamic) return null;
    this.held = new Grip(body, world, this.view, this.controls);
    return this.held;
  }

  /** Takes hold of a body at its centre of mass, or lets go of what is held. */
  hold(picked: Picked | null): void {
    if (this.held || !picked) {
      this.release();
      return;
    }
    const { scene } = this.session;
    const matrix = this.view.current?.bodyMatrix(picked);
    if (!scene || !matrix) return;
    const { name, inertial } = scene.bodies[picked.body];
    const point = new Vector3(...inertial.position).applyMatrix4(matrix);
    const grip = this.grasp({ ...picked, point });
    if (!grip) return;
    grip.pull(point);
    this.notice.say(`${name || "The picked body"} is held: arrow keys pull at it.`);
  }

  /** Pulls as an arrow key says: in the plane of the picture, with Shift to and fro. */
  arrow(key: string): void {
    const right = key.endsWith("Right") ? 1 : key.endsWith("Left") ? -1 : 0;
    const up = key.endsWith("Up") ? 1 : key.endsWith("Down") ? -1 : 0;
    const { held, view } = this;
    if (!held) return;
    const move = key.startsWith("Shift+") ? new Vector3(right, 0, -up) : new Vector3(right, up, 0);
    held.pull(view.moved(held.to, move.multiplyScalar(KEY_PULL)));
  }

  private release(): void {
    if (!this.held) return;
    this.held = null;
    this.controls.flush();
    this.session.send({ type: "release" });
    this.view.spring.visible = false;
    this.view.invalidate();
  }
}

/** A body held at a point. */
class Grip {
  /** Where it is held, in the body's frame [m]. */
  private readonly point: Vector3;
  /** Where the other end of the spring is, in the scene's axes [m]. */
  to: Vector3;

  constructor(
    private readonly held: Grasped,
    private readonly world: number,
    private readonly view: View,
    private readonly controls: Controls,
  ) {
    this.to = held.point.clone();
    this.point = held.point.clone();
    const matrix = view.current?.bodyMatrix(held);
    if (matrix) this.point.applyMatrix4(matrix.invert());
  }

  pull(to: Vector3): void {
    this.to = to;
    const shift = new Vector3().fromArray(this.view.current?.poses.shifts ?? [0, 0, 0], 3 * this.held.row);
    this.controls.soon("grab", {
      type: "grab",
      world: this.world,
      body: this.held.body,
      point: this.point.toArray(),
      to: this.to.clone().sub(shift).toArray(),
    });
    this.draw();
  }

  draw(): void {
    const { current, spring } = this.view;
    if (!current) return;
    const from = this.point.clone().applyMatrix4(current.bodyMatrix(this.held));
    spring.stretch(from, this.to, 0.3 * current.measures.body);
    this.view.invalidate();
  }
}
