import { Vector3 } from "three";
import type { Controls } from "./controls";
import type { Session } from "./session";
import type { Hold } from "./view/gestures";
import type { Hit } from "./view/scene_view";
import type { View } from "./view/view";

/** Draws a body by a spring from the pointer. */
export class Grabbing {
  private held: Grip | null = null;

  constructor(
    private readonly session: Session,
    private readonly controls: Controls,
    private readonly view: View,
  ) {
    session.on("frame", () => this.held?.draw());
    session.on("scene", () => {
      this.held = null;
    });
  }

  /** Takes hold of what was hit, if it can move. */
  take(hit: Hit): Hold | null {
    const world = this.session.shown[hit.row];
    if (world === undefined || !this.session.scene?.bodies[hit.body]?.dynamic) return null;
    this.held = new Grip(hit, world, this.view, this.controls);
    return {
      move: (x, y) => this.held?.move(x, y),
      end: () => this.release(),
    };
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
  /** Where the pointer is, in the scene's axes [m]. */
  private to: Vector3;

  constructor(
    private readonly hit: Hit,
    private readonly world: number,
    private readonly view: View,
    private readonly controls: Controls,
  ) {
    this.to = hit.point.clone();
    this.point = hit.point.clone();
    const matrix = view.current?.bodyMatrix(hit);
    if (matrix) this.point.applyMatrix4(matrix.invert());
  }

  move(x: number, y: number): void {
    this.to = this.view.across(x, y, this.hit.point);
    const shift = new Vector3().fromArray(this.view.current?.poses.shifts ?? [0, 0, 0], 3 * this.hit.row);
    this.controls.soon("grab", {
      type: "grab",
      world: this.world,
      body: this.hit.body,
      point: this.point.toArray(),
      to: this.to.clone().sub(shift).toArray(),
    });
    this.draw();
  }

  draw(): void {
    const { current, spring } = this.view;
    if (!current) return;
    const from = this.point.clone().applyMatrix4(current.bodyMatrix(this.hit));
    spring.stretch(from, this.to, 0.3 * current.measures.body);
    this.view.invalidate();
  }
}
