/** Affine maps as 4 × 4 matrices by columns, many of them in one array, as graphics cards take them. */

import type { Placement } from "../protocol";

/** Writes the map of a pose (position, quaternion x, y, z, w, from `p`) moved by `shift`. */
export function writePose(
  out: Float32Array,
  o: number,
  pose: ArrayLike<number>,
  p: number,
  shift: ArrayLike<number>,
  s: number,
): void {
  const [x, y, z, w] = [pose[p + 3], pose[p + 4], pose[p + 5], pose[p + 6]];
  out[o] = 1 - 2 * (y * y + z * z);
  out[o + 1] = 2 * (x * y + w * z);
  out[o + 2] = 2 * (x * z - w * y);
  out[o + 3] = 0;
  out[o + 4] = 2 * (x * y - w * z);
  out[o + 5] = 1 - 2 * (x * x + z * z);
  out[o + 6] = 2 * (y * z + w * x);
  out[o + 7] = 0;
  out[o + 8] = 2 * (x * z + w * y);
  out[o + 9] = 2 * (y * z - w * x);
  out[o + 10] = 1 - 2 * (x * x + y * y);
  out[o + 11] = 0;
  out[o + 12] = pose[p] + shift[s];
  out[o + 13] = pose[p + 1] + shift[s + 1];
  out[o + 14] = pose[p + 2] + shift[s + 2];
  out[o + 15] = 1;
}

/** Writes a · b. */
export function multiply(
  out: Float32Array,
  o: number,
  a: ArrayLike<number>,
  i: number,
  b: ArrayLike<number>,
  j: number,
): void {
  for (let column = 0; column < 16; column += 4) {
    const [x, y, z, w] = [b[j + column], b[j + column + 1], b[j + column + 2], b[j + column + 3]];
    for (let row = 0; row < 4; row++) {
      out[o + column + row] = a[i + row] * x + a[i + 4 + row] * y + a[i + 8 + row] * z + a[i + 12 + row] * w;
    }
  }
}

/** The map of a placement, after a scaling along its axes. */
export function placed(placement: Placement, scale: readonly number[] = [1, 1, 1]): Float32Array {
  const out = new Float32Array(16);
  writePose(out, 0, [...placement.position, ...placement.orientation], 0, [0, 0, 0], 0);
  for (let axis = 0; axis < 3; axis++) {
    for (let row = 0; row < 3; row++) out[4 * axis + row] *= scale[axis];
  }
  return out;
}
