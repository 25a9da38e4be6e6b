import { Color } from "three";
import { Lines } from "./lines";
import type { Moment, Overlay } from "./overlay";

const AXES = ["#e5484d", "#46a758", "#3e8ef7"].map((name) => new Color(name));

/** The axes of every body's frame: x red, y green, z blue. */
export class Frames implements Overlay {
  readonly object = new Lines();

  draw({ poses, measures }: Moment): void {
    this.object.begin();
    for (let world = 0; world < poses.worlds; world++) {
      for (let body = 0; body < poses.bodies; body++) {
        const [map, m] = poses.of(world, body);
        AXES.forEach((color, axis) => {
          const tip = [0, 0, 0];
          tip[axis] = 1.2 * Math.max(measures.bodies[body], 0.5 * measures.body);
          this.object.segment(map, m, [0, 0, 0], tip, color);
        });
      }
    }
    this.object.end();
  }

  dispose(): void {
    this.object.dispose();
  }
}
