import { Matrix4 } from "three";
import { type Frame, POSE } from "../frame";
import type { Camera, Scene } from "../protocol";
import { placed, writePose } from "./affine";
import { worldShifts } from "./layout";

/** Where all bodies of all worlds shown are drawn, as matrices in the scene's axes. */
export class Poses {
  worlds = 0;
  readonly bodies: number;
  /** 16 numbers a body, world by world. */
  matrices: Float32Array = new Float32Array(0);
  /** Shifts of worlds as matrices, 16 numbers each: where what stands still is. */
  origins: Float32Array = new Float32Array(0);
  /** Shifts of worlds [m], three numbers each. */
  shifts: Float32Array = new Float32Array(0);

  constructor(private readonly scene: Scene) {
    this.bodies = scene.bodies.length;
    this.arrange(scene.shown.length);
  }

  update(frame: Frame): void {
    if (frame.worlds !== this.worlds) this.arrange(frame.worlds);
    const { matrices, shifts, bodies } = this;
    for (let world = 0; world < this.worlds; world++) {
      for (let i = world * bodies; i < (world + 1) * bodies; i++) {
        writePose(matrices, 16 * i, frame.poses, POSE * i, shifts, 3 * world);
      }
    }
  }

  /** Index into {@link matrices} of a body, which may be −1, with the array it is of. */
  of(world: number, body: number): [Float32Array, number] {
    return body < 0 ? [this.origins, 16 * world] : [this.matrices, 16 * (world * this.bodies + body)];
  }

  /** Where something is that turns with a body of a world, or only goes along with its origin. */
  mounted(world: number, { body, mode, placement }: Pick<Camera, "body" | "mode" | "placement">): Matrix4 {
    const [map, at] = this.of(world, body);
    const carrier = new Matrix4().fromArray(map, at);
    // Of a body whose turns it does not follow, only the place matters.
    const followed = mode === "track" ? new Matrix4().copyPosition(carrier) : carrier;
    return followed.multiply(new Matrix4().fromArray(placed(placement)));
  }

  private arrange(worlds: number): void {
    this.worlds = worlds;
    this.shifts = worldShifts(worlds, this.scene.spacing, this.scene.up);
    this.matrices = new Float32Array(16 * worlds * this.bodies);
    this.origins = new Float32Array(16 * worlds);
    for (let world = 0; world < worlds; world++) {
      writePose(this.origins, 16 * world, [0, 0, 0, 0, 0, 0, 1], 0, this.shifts, 3 * world);
    }
  }
}
