import { roundStep } from "../plots/ticks";

/** How a slider's place, from 0 to 1, is a value. Whole numbers are not logarithmic. */
export interface Scale {
  min: number;
  max: number;
  logarithmic: boolean;
  integer: boolean;
}

/** A logarithmic scale from 0 has so many powers of ten above its first step. */
const DECADES = 6;
/** At most so many places has a linear slider, and so many a power of ten a logarithmic one. */
const [PLACES, A_DECADE] = [500, 20];

/** Least value above which the scale is logarithmic. */
function floor({ min, max }: Scale): number {
  return min > 0 ? min : max * 10 ** -DECADES;
}

function isLogarithmic({ max, logarithmic, integer }: Scale): boolean {
  return logarithmic && !integer && max > 0;
}

/**
 * How many steps a slider of it has. Each is wider than what {@link fromShare} rounds to, so that a key always moves
 * the value on: 1 and 1.1 of a logarithmic scale are 0.041 powers of ten apart, its steps 0.05; a linear one rounds
 * to half a step or finer.
 */
export function places(scale: Scale): number {
  const { min, max, integer } = scale;
  if (max <= min) return 1;
  if (isLogarithmic(scale)) return Math.max(1, Math.floor(A_DECADE * Math.log10(max / floor(scale))));
  const step = roundStep((max - min) / PLACES);
  return Math.max(1, Math.round((max - min) / (integer ? Math.max(step, 1) : step)));
}

export function toShare(scale: Scale, value: number): number {
  const { min, max } = scale;
  if (max <= min) return 0;
  const held = Math.min(Math.max(value, min), max);
  if (!isLogarithmic(scale)) return (held - min) / (max - min);
  const least = floor(scale);
  return held <= least ? 0 : Math.log(held / least) / Math.log(max / least);
}

/** The value at a place, with no more digits than a slider can set. */
export function fromShare(scale: Scale, share: number): number {
  const { min, max, integer } = scale;
  if (share <= 0 || max <= min) return min;
  if (share >= 1) return max;
  let value: number;
  if (isLogarithmic(scale)) {
    const least = floor(scale);
    value = Number((least * (max / least) ** share).toPrecision(2));
  } else {
    const half = (max - min) / places(scale) / 2;
    const step = integer ? 1 : 10 ** Math.floor(Math.log10(half));
    value = Number((Math.round((min + share * (max - min)) / step) * step).toPrecision(12));
  }
  return Math.min(Math.max(value, min), max);
}

/** A value as digits, as fine as its scale wants. */
export function written({ min, max, logarithmic }: Scale, value: number): string {
  if (logarithmic || !(max > min)) return String(Number(value.toPrecision(5)));
  const decimals = Math.min(Math.max(4 - Math.ceil(Math.log10(max - min)), 0), 12);
  return String(Number(value.toFixed(decimals)));
}
