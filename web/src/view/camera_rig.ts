import { type Box3, type Matrix4, PerspectiveCamera, Quaternion, Vector3 } from "three";
import type { Triple } from "../schema";

/** From where the scene is seen, in axes of the screen's world, whose y points up. */
export interface Viewpoint {
  /** What is looked at [m]; where a body is followed, from its origin. */
  target: Triple;
  /** Turns about the vertical, and above the horizon [rad]. */
  yaw: number;
  pitch: number;
  /** From the target [m]. */
  distance: number;
}

/** What carries the camera: nothing, a body whose place it follows, or one whose eyes it sees with. */
export type Mount = "free" | "follow" | "ride";

/** How one looks with a body's eyes. */
export interface Gaze {
  /** Turns from a camera's own front [rad]. */
  yaw: number;
  pitch: number;
  /** The angle from the lower to the upper edge of the picture [degrees]. */
  field: number;
}

/** A body that carries the camera. */
export interface Carrier {
  mount: Exclude<Mount, "free">;
  body: number;
  /** Its replica; null is the first shown. */
  world: number | null;
  /** How one looks with its eyes; null is straight ahead. */
  gaze: Gaze | null;
}

/** Fields of view [degrees], from a body's eyes and else; least and most. */
const [EYES, FIELD_OF_VIEW] = [70, 40];
const FIELDS = [20, 110];
const STEEPEST = (89 * Math.PI) / 180;
/** Time [s] in which the camera comes by a factor of e closer to where it is to be. */
const EASE = 0.07;

/** The camera, and where it is going. */
export class CameraRig {
  readonly camera = new PerspectiveCamera(FIELD_OF_VIEW);
  /** How it looks with a body's eyes [rad]. */
  private readonly eyes = { yaw: 0, pitch: 0 };
  /** The yaw of a body's own front [rad]. */
  private ahead = 0;
  private goal: Viewpoint = { target: [0, 0, 0], yaw: 0.6, pitch: 0.42, distance: 5 };
  private now: Viewpoint = structuredClone(this.goal);
  private mounted: Mount = "free";
  private readonly still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  /** The target in the screen's world [m], with what is followed. */
  readonly focus = new Vector3();

  get mount(): Mount {
    return this.mounted;
  }

  /** Mounts the camera; `ahead` is the yaw of a body's own front. A followed body comes to the middle. */
  setMount(mount: Mount, ahead = 0): void {
    if (mount === this.mounted) return;
    if (mount === "follow") this.goal.target = [0, 0, 0];
    if (this.mounted === "follow") this.goal.target = this.focus.toArray();
    this.ahead = ahead;
    this.mounted = mount;
    this.lookAhead();
    this.now = structuredClone(this.goal);
  }

  /** Looks straight ahead with a body's eyes. */
  lookAhead(): void {
    this.gaze = { yaw: this.ahead, pitch: 0, field: this.mounted === "ride" ? EYES : FIELD_OF_VIEW };
  }

  get gaze(): Gaze {
    return { ...this.eyes, field: this.camera.fov };
  }

  set gaze({ yaw, pitch, field }: Gaze) {
    Object.assign(this.eyes, { yaw, pitch });
    this.camera.fov = Math.min(FIELDS[1], Math.max(FIELDS[0], field));
  }

  get viewpoint(): Viewpoint {
    return structuredClone(this.goal);
  }

  /** Goes to a viewpoint; `at once` without easing. */
  go(viewpoint: Viewpoint, atOnce = false): void {
    this.goal = structuredClone(viewpoint);
    if (atOnce) this.now = structuredClone(viewpoint);
  }

  /** Sees a box whole. */
  frame(box: Box3, atOnce: boolean): void {
    const center = box.getCenter(new Vector3());
    const half = box.getSize(new Vector3()).multiplyScalar(0.5);
    const turn = facing(this.goal.yaw, this.goal.pitch).invert();
    const high = Math.tan((Math.PI / 360) * FIELD_OF_VIEW);
    const wide = high * this.camera.aspect;
    let distance = 0;
    for (let corner = 0; corner < 8; corner++) {
      const signs = [corner & 1, corner & 2, corner & 4].map((bit) => (bit ? 1 : -1));
      const at = new Vector3(...signs).multiply(half).applyQuaternion(turn);
      distance = Math.max(distance, at.z + Math.abs(at.x) / wide, at.z + Math.abs(at.y) / high);
    }
    const target = this.mounted === "follow" ? ([0, 0, 0] as Triple) : center.toArray();
    this.go({ ...this.goal, target, distance: Math.max(1.15 * distance, 1e-3) }, atOnce);
  }

  orbit(yaw: number, pitch: number): void {
    const turned = this.mounted === "ride" ? this.eyes : this.goal;
    const sign = this.mounted === "ride" ? -1 : 1;
    turned.yaw += yaw;
    turned.pitch = Math.min(STEEPEST, Math.max(-STEEPEST, turned.pitch + sign * pitch));
  }

  /** Moves across the view, in heights of the view; eyes stay in their head. */
  pan(right: number, up: number): void {
    if (this.mounted === "ride") return;
    const height = 2 * this.goal.distance * Math.tan((Math.PI / 360) * this.camera.fov);
    const move = new Vector3(right * height, up * height, 0).applyQuaternion(
      facing(this.goal.yaw, this.goal.pitch),
    );
    this.goal.target = new Vector3(...this.goal.target).add(move).toArray();
  }

  zoom(factor: number): void {
    if (this.mounted === "ride") {
      this.gaze = { ...this.gaze, field: this.camera.fov * factor };
    } else {
      this.goal.distance = Math.min(1e5, Math.max(1e-3, this.goal.distance * factor));
    }
  }

  /**
   * Moves the camera on by so many seconds, carried by a body at `anchor`. Returns whether it is still on
   * its way.
   */
  update(seconds: number, anchor: Matrix4 | null, radius: number): boolean {
    const share = this.still ? 1 : 1 - Math.exp(-seconds / EASE);
    const moving = this.ease(share);
    const { camera, now } = this;
    const [place, turn] = [new Vector3(), new Quaternion()];
    anchor?.decompose(place, turn, new Vector3());
    if (this.mounted === "ride" && anchor) {
      camera.position.copy(place);
      camera.quaternion.copy(turn).multiply(facing(this.eyes.yaw, this.eyes.pitch));
      this.focus.copy(place);
      this.range(0.01 * radius, radius);
    } else {
      this.focus.set(...now.target);
      if (this.mounted === "follow") this.focus.add(place);
      camera.quaternion.copy(facing(now.yaw, now.pitch));
      camera.position.set(0, 0, now.distance).applyQuaternion(camera.quaternion).add(this.focus);
      this.range(Math.min(0.02 * now.distance, radius), now.distance + radius);
    }
    camera.updateMatrixWorld();
    return moving;
  }

  private ease(share: number): boolean {
    const { goal, now } = this;
    const left = Math.max(
      Math.hypot(...goal.target.map((x, i) => x - now.target[i])) / goal.distance,
      Math.abs(goal.yaw - now.yaw),
      Math.abs(goal.pitch - now.pitch),
      Math.abs(Math.log(goal.distance / now.distance)),
    );
    if (left < 1e-4) {
      this.now = structuredClone(goal);
      return false;
    }
    now.target = now.target.map((x, i) => x + share * (goal.target[i] - x)) as Triple;
    now.yaw += share * (goal.yaw - now.yaw);
    now.pitch += share * (goal.pitch - now.pitch);
    now.distance *= (goal.distance / now.distance) ** share;
    return true;
  }

  private range(near: number, far: number): void {
    this.camera.near = near;
    this.camera.far = 60 * far;
    this.camera.updateProjectionMatrix();
  }
}

function facing(yaw: number, pitch: number): Quaternion {
  const turn = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), yaw);
  return turn.multiply(new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), -pitch));
}
