import { Color, type CubeTexture, type DataTexture, DataUtils } from "three";
import { expect, test } from "vitest";
import { type Sky, skyLight } from "../src/view/sky_light";

const grey = (x: number) => new Color(x, x, x);

/** Red of the texels of a face: that towards x is 0, up 2, down 3. */
function face(texture: CubeTexture, index: number): number[] {
  const data = (texture.images[index] as DataTexture).image.data as Uint16Array;
  return Array.from({ length: data.length / 4 }, (_, i) => DataUtils.fromHalfFloat(data[4 * i]));
}

/** As three.js counts them, from mirrors to matt surfaces. */
function levels(sky: Sky): CubeTexture[] {
  const texture = skyLight(sky);
  const rougher = texture.mipmaps as unknown as CubeTexture[];
  return [texture, ...rougher.slice(0, -1)];
}

test("a sky of one colour is reflected as it is", () => {
  for (const level of levels(() => grey(0.5)))
    for (let i = 0; i < 6; i++) for (const red of face(level, i)) expect(red).toBeCloseTo(0.5, 3);
});

/** A surface that is tilted by the angle b has (1 + cos b) / 2 of a bright sky over dark ground. */
test("a matt surface gathers the light of its half of a bright sky", () => {
  const all = levels((height) => grey(height > 0 ? 1 : 0));
  const matt = all[all.length - 1];
  const side = Math.sqrt(face(matt, 0).length);
  expect(side).toBe(8);
  for (const [index, middle] of [
    [0, null],
    [2, 1],
    [3, -1],
  ] as const)
    face(matt, index).forEach((red, i) => {
      const [right, down] = [i % side, Math.floor(i / side)].map((n) => (2 * n + 1) / side - 1);
      const height = (middle ?? -down) / Math.hypot(1, right, down);
      // The samples of a lobe, 32 × 16, are so close.
      expect(Math.abs(red - (1 + height) / 2)).toBeLessThan(0.02);
    });
});

test("a mirror shows the sky, rougher surfaces less and less of the horizon's edge", () => {
  const all = levels((height) => grey(height > 0 ? 1 : 0));
  const widths = all.map((level) => {
    const column = face(level, 0).filter((_, i, { length }) => i % Math.sqrt(length) === 0);
    return column.filter((red) => red > 0.05 && red < 0.95).length / column.length;
  });
  expect(widths[0]).toBe(0);
  expect(widths).toEqual([...widths].sort((a, b) => a - b));
});
