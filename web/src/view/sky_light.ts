import {
  type Color,
  CubeTexture,
  DataTexture,
  DataUtils,
  HalfFloatType,
  LinearFilter,
  LinearMipmapLinearFilter,
  LinearSRGBColorSpace,
  RGBAFormat,
} from "three";

/** The light from a height over the horizon, the sine of the elevation. */
export type Sky = (height: number) => Color;

/** Sides of the faces of a level: halved from the first, that of mirrors, to the roughest, that of matt surfaces. */
const SIDES = [128, 64, 32, 16, 8];
/** Rows of a level between the foot and the zenith. */
const ROWS = 128;
/** Samples of a lobe from its axis outwards, and half way about it: the other half sees the same. */
const RINGS = 32;
const SPOKES = 16;

/**
 * The light of a sky as surfaces of each roughness reflect it, in levels as three.js's `PMREMGenerator` has them. That draws
 * each point with 256 samples, which takes seconds where a program draws. The light of this sky depends on the elevation
 * alone, so that each level is a row of colours.
 */
export function skyLight(sky: Sky): CubeTexture {
  const levels = SIDES.map((side, level) => {
    // As `PMREMGenerator.lodToRoughness` has it, which the types of three.js lack.
    const roughness = 1 - Math.sqrt(1 - level / (SIDES.length - 1));
    return faces(side, reflected(sky, roughness));
  });
  // three.js counts the levels without the first: one more, which nothing reads, makes their number right.
  levels.push(faces(SIDES[SIDES.length - 1] / 2, [sky(0)]));
  const [texture, ...rougher] = levels;
  texture.mipmaps = rougher;
  texture.isPMREMTexture = true;
  texture.needsUpdate = true;
  return texture;
}

/**
 * What a surface reflects along its normal, for elevations of the normal in equal steps from foot to zenith:
 *
 *     L(n) = ∫ L(l) D(h) n·l dω / ∫ D(h) n·l dω,    h half way from n to l,
 *
 * with the distribution D of GGX for α = roughness², sampled as in Walter et al. (2007), equation 35.
 */
function reflected(sky: Sky, roughness: number): Color[] {
  const elevations = Array.from({ length: ROWS }, (_, i) => Math.PI * ((i + 0.5) / ROWS - 0.5));
  if (roughness === 0) return elevations.map((elevation) => sky(Math.sin(elevation)));
  const lobe = samples(roughness ** 2);
  return elevations.map((elevation) => {
    const [up, along] = [Math.sin(elevation), Math.cos(elevation)];
    const sum = sky(0).setRGB(0, 0, 0);
    let weight = 0;
    for (const [cosine, sine] of lobe) {
      for (let spoke = 0; spoke < SPOKES; spoke++) {
        const turn = Math.cos((Math.PI * (spoke + 0.5)) / SPOKES);
        const light = sky(up * cosine + along * sine * turn);
        sum.add(light.multiplyScalar(cosine));
        weight += cosine;
      }
    }
    return sum.multiplyScalar(1 / weight);
  });
}

/** Cosine and sine of the angles between the normal and the light that comes from over the surface. */
function samples(alpha: number): [number, number][] {
  const all = Array.from({ length: RINGS }, (_, i): [number, number] => {
    const u = (i + 0.5) / RINGS;
    const half = Math.acos(Math.sqrt((1 - u) / (1 + (alpha ** 2 - 1) * u)));
    return [Math.cos(2 * half), Math.sin(2 * half)];
  });
  return all.filter(([cosine]) => cosine > 0);
}

/** A cube whose colours are those of a row of elevations. */
function faces(side: number, row: Color[]): CubeTexture {
  const texels = row.map(({ r, g, b }) => [r, g, b, 1].map(DataUtils.toHalfFloat));
  const [beside, above, below] = [null, 1, -1].map((middle) => face(side, texels, middle));
  const texture = new CubeTexture([beside, beside, above, below, beside, beside]);
  texture.type = HalfFloatType;
  texture.colorSpace = LinearSRGBColorSpace;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.generateMipmaps = false;
  return texture;
}

/** A face of it; the heights of the upper and the lower one go out from 1 and −1 in their middle. */
function face(side: number, row: number[][], middle: number | null): DataTexture {
  const texels = new Uint16Array(4 * side * side);
  for (let i = 0; i < side * side; i++) {
    const [right, down] = [i % side, Math.floor(i / side)].map((n) => (2 * n + 1) / side - 1);
    const height = (middle ?? -down) / Math.hypot(1, right, down);
    const place = Math.floor(row.length * (Math.asin(height) / Math.PI + 0.5));
    texels.set(row[Math.min(place, row.length - 1)], 4 * i);
  }
  return new DataTexture(texels, side, side, RGBAFormat, HalfFloatType);
}
