import type { Object3D } from "three";
import type { Frame } from "../../frame";
import type { Scene } from "../../protocol";
import type { Measures } from "../layout";
import type { Poses } from "../poses";

/** A scene at an instant, as it is drawn. */
export interface Moment {
  scene: Scene;
  frame: Frame;
  poses: Poses;
  measures: Measures;
  picked: Picked | null;
}

/** A body of a world. */
export interface Picked {
  /** Row of its world among those shown. */
  row: number;
  body: number;
}

/** Something drawn over the bodies. Made anew for each scene. */
export interface Overlay {
  readonly object: Object3D;
  /** Follows what is at an instant; called for what is visible only. */
  draw(moment: Moment): void;
  dispose(): void;
}

/** Drawn after and in front of the bodies. */
export const IN_FRONT = 10;
