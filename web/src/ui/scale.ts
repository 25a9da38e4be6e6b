/** How a slider's place, from 0 to 1, is a value. */
export interface Scale {
  min: number;
  max: number;
  logarithmic: boolean;
  integer: boolean;
}

/** A logarithmic scale from 0 has so many powers of ten above its first step. */
const DECADES = 6;

/** Least value above which the scale is logarithmic. */
function floor({ min, max }: Scale): number {
  return min > 0 ? min : max * 10 ** -DECADES;
}

export function toShare(scale: Scale, value: number): number {
  const { min, max } = scale;
  if (max <= min) return 0;
  const held = Math.min(Math.max(value, min), max);
  if (!scale.logarithmic || max <= 0) return (held - min) / (max - min);
  const least = floor(scale);
  return held <= least ? 0 : Math.log(held / least) / Math.log(max / least);
}

/** The value at a place, with no more digits than a slider can set. */
export function fromShare(scale: Scale, share: number): number {
  const { min, max, logarithmic, integer } = scale;
  if (share <= 0) return min;
  if (share >= 1) return max;
  let value: number;
  if (logarithmic && max > 0) {
    const least = floor(scale);
    value = Number((least * (max / least) ** share).toPrecision(2));
  } else {
    const step = 10 ** Math.floor(Math.log10((max - min) / 200));
    value = Number((Math.round((min + share * (max - min)) / step) * step).toPrecision(12));
  }
  return Math.min(Math.max(integer ? Math.round(value) : value, min), max);
}

/** A value as digits, as fine as its scale wants. */
export function written({ min, max, logarithmic }: Scale, value: number): string {
  if (logarithmic || !(max > min)) return String(Number(value.toPrecision(5)));
  const decimals = Math.min(Math.max(4 - Math.ceil(Math.log10(max - min)), 0), 12);
  return String(Number(value.toFixed(decimals)));
}
