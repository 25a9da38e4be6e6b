/** Where worlds stand that are shown side by side. */

import { Quaternion, Vector3 } from "three";
import type { Joint, Scene, Shape } from "../protocol";
import type { Triple } from "../schema";

/** Shifts [m] of so many worlds, three numbers each, in the scene's axes: a square on the ground about its middle. */
export function worldShifts(worlds: number, spacing: number, up: Scene["up"]): Float32Array {
  const shifts = new Float32Array(3 * worlds);
  const columns = Math.ceil(Math.sqrt(worlds));
  const rows = Math.ceil(worlds / columns);
  const depth = up === "y" ? 2 : 1;
  // Rows come towards the viewer, who looks along −z, or +y where z is up.
  const towards = up === "y" ? 1 : -1;
  for (let world = 0; world < worlds; world++) {
    const [column, row] = [world % columns, Math.floor(world / columns)];
    shifts[3 * world] = (column - (columns - 1) / 2) * spacing;
    shifts[3 * world + depth] = (row - (rows - 1) / 2) * spacing * towards;
  }
  return shifts;
}

/** Radius [m] of a ball about the body's origin that holds the shape. */
export function reach(shape: Shape): number {
  return Math.hypot(...shape.placement.position) + radius(shape);
}

/** Radius [m] of a ball about the shape's middle that holds it. */
export function radius({ geometry }: Shape): number {
  switch (geometry.kind) {
    case "plane":
      return geometry.half ? Math.hypot(...geometry.half) : 0;
    case "sphere":
      return geometry.radius;
    case "capsule":
      return geometry.half_height;
    case "cylinder":
    case "cone":
      return Math.hypot(geometry.radius, geometry.half_height);
    case "box":
    case "ellipsoid":
      return Math.hypot(...geometry.half);
    case "mesh": {
      let most = 0;
      const at = geometry.positions;
      for (let i = 0; i < at.length; i += 3) most = Math.max(most, Math.hypot(at[i], at[i + 1], at[i + 2]));
      return most;
    }
  }
}

/** Radius [m] of a ball about the shape's middle that is within it. */
export function core({ geometry }: Shape): number {
  switch (geometry.kind) {
    case "sphere":
    case "capsule":
      return geometry.radius;
    case "cylinder":
      return Math.min(geometry.radius, geometry.half_height);
    case "box":
    case "ellipsoid":
      return Math.min(...geometry.half);
    case "plane":
    case "cone":
    case "mesh":
      return 0;
  }
}

/** Sizes that drawings are measured by [m]. */
export interface Measures {
  /** Radius of each body. */
  bodies: number[];
  /** Radius of an ordinary body. */
  body: number;
  /** Radius of what a world holds. */
  world: number;
}

export function measure(scene: Scene): Measures {
  const [low, high] = scene.bounds;
  const world = Math.max(0.5 * Math.hypot(...low.map((x, axis) => high[axis] - x)), 1e-3);
  const bodies = scene.bodies.map(() => 0);
  for (const shape of scene.shapes) {
    if (shape.body >= 0) bodies[shape.body] = Math.max(bodies[shape.body], reach(shape));
  }
  const sizes = bodies.filter((size) => size > 0).sort((a, b) => a - b);
  const body = Math.min(sizes.length ? sizes[sizes.length >> 1] : 0.1 * world, world);
  return { bodies: bodies.map((size) => size || 0.5 * body), body, world };
}

/**
 * The box [m] within which a world's bodies move, as far as one can tell: where they are at the start, and
 * where what hangs on the world by a joint can swing.
 */
export function moves(scene: Scene, measures: Measures): [Triple, Triple] {
  const [low, high] = structuredClone(scene.bounds);
  const reaches = treeReaches(scene, measures);
  scene.joints.forEach((joint, row) => {
    if (joint.parent >= 0 || joint.kind === "free" || joint.kind === "fixed" || joint.kind === "prismatic")
      return;
    const anchor = joint.parent_frame.position;
    const [from, to] = scene.bounds;
    const farthest = Math.hypot(
      ...anchor.map((x, axis) => Math.max(Math.abs(x - from[axis]), Math.abs(to[axis] - x))),
    );
    const swing = Math.min(farthest, reaches[row]);
    const across = swingsAcross(joint);
    anchor.forEach((x, axis) => {
      low[axis] = Math.min(low[axis], x - swing * across[axis]);
      high[axis] = Math.max(high[axis], x + swing * across[axis]);
    });
  });
  return [low, high];
}

/** How far what hangs on a joint gets along each axis, as a share: a hinge swings in its plane alone. */
function swingsAcross({ dofs, parent_frame }: Joint): number[] {
  if (dofs.length !== 1) return [1, 1, 1];
  const axis = new Vector3(...dofs[0].axis).applyQuaternion(new Quaternion(...parent_frame.orientation));
  return axis
    .normalize()
    .toArray()
    .map((share) => Math.sqrt(Math.max(0, 1 - share * share)));
}

/** How far from each joint what hangs on it can reach [m]. */
function treeReaches({ joints }: Scene, measures: Measures): number[] {
  const reaches = joints.map(() => 0);
  const hung = new Map<number, number[]>();
  // Children come after their parents.
  for (let i = joints.length - 1; i >= 0; i--) {
    const { parent, child, child_frame: own, coordinate } = joints[i];
    reaches[i] = Math.hypot(...own.position) + (measures.bodies[child] ?? 0);
    for (const k of hung.get(child) ?? []) {
      const [from, to] = [own.position, joints[k].parent_frame.position];
      const between = Math.hypot(...to.map((x, axis) => x - from[axis]));
      reaches[i] = Math.max(reaches[i], between + reaches[k]);
    }
    // What closes a loop carries nothing.
    if (coordinate >= 0) hung.set(parent, [...(hung.get(parent) ?? []), i]);
  }
  return reaches;
}
