import { Matrix4, Vector3 } from "three";
import type { Triple } from "./schema";
import type { Selection } from "./selection";
import type { Session } from "./session";
import type { Hit } from "./view/scene_view";
import type { View } from "./view/view";

/** Blows on bodies. */
export class Pushing {
  /** [N·s] */
  impulse = 1;
  /** What brings the picked body to 1 m/s. */
  usual = 1;

  constructor(
    private readonly session: Session,
    private readonly selection: Selection,
    private readonly view: View,
  ) {
    selection.on("change", (selected) => {
      const body = selected && session.scene?.bodies[selected.body];
      if (body?.dynamic) this.impulse = this.usual = Number(body.mass.toPrecision(2));
    });
  }

  /** Pushes what was hit, along the line of sight. */
  push(hit: Hit, direction: Triple): void {
    const world = this.session.shown[hit.row];
    if (world === undefined || !this.session.scene?.bodies[hit.body]?.dynamic) return;
    const inverse = this.view.current?.bodyMatrix(hit).invert() ?? new Matrix4();
    const point = hit.point.clone().applyMatrix4(inverse).toArray();
    this.send(world, hit.body, point, direction);
  }

  /** Pushes the picked body at its centre of mass, along the view. */
  pushPicked(): void {
    const picked = this.selection.now;
    const body = picked && this.session.scene?.bodies[picked.body];
    if (!picked || !body?.dynamic) return;
    const { clientWidth, clientHeight } = this.view.stage.canvas;
    this.send(
      picked.world,
      picked.body,
      body.inertial.position,
      this.view.direction(clientWidth / 2, clientHeight / 2),
    );
  }

  private send(world: number, body: number, point: Triple, direction: Triple): void {
    const impulse = new Vector3(...direction).setLength(this.impulse).toArray();
    this.session.send({ type: "push", world, body, point, impulse });
  }
}
