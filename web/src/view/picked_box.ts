import { type Box3, Color } from "three";
import { Lines } from "./overlays/lines";
import type { Picked } from "./overlays/overlay";
import type { Poses } from "./poses";

const COLOR = new Color("#2f9e8f");
/** Length of a corner's lines, as a share of the edge. */
const CORNER = 0.25;

/** The corners of a box about the body that is picked. */
export class PickedBox extends Lines {
  draw(poses: Poses, { row, body }: Picked, box: Box3): void {
    const [map, m] = poses.of(row, body);
    const [low, high] = [box.min.toArray(), box.max.toArray()];
    this.begin();
    for (let corner = 0; corner < 8; corner++) {
      const ends = [0, 1, 2].map((axis) => ((corner >> axis) & 1 ? [high, low] : [low, high]));
      const at = ends.map(([here], axis) => here[axis]);
      ends.forEach(([here, there], axis) => {
        const tip = [...at];
        tip[axis] = here[axis] + CORNER * (there[axis] - here[axis]);
        this.segment(map, m, at, tip, COLOR);
      });
    }
    this.end();
  }
}
