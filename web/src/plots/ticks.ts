/** 1, 2 or 5 times a power of ten, the next above. */
export function roundStep(rough: number): number {
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * ([1, 2, 5].find((factor) => factor * power >= rough * 0.999) ?? 10);
}

/** Round numbers within a range, about `count` of them: multiples of 1, 2 or 5 times a power of ten. */
export function ticks(low: number, high: number, count: number): number[] {
  if (!(high > low)) return [low];
  const step = roundStep((high - low) / count);
  const found: number[] = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) {
    found.push(Number((i * step).toPrecision(12)));
  }
  return found;
}

/** Smaller numbers, and differences of larger ones by a smaller share, are what rounding leaves. */
const [NOTHING, ROUNDING] = [1e-12, 1e-7];

/** A range a little wider than what it holds, never empty, and never one of rounding errors. */
export function padded(low: number, high: number): [number, number] {
  if (low > high) return [0, 1];
  const size = Math.max(Math.abs(low), Math.abs(high));
  if (size < NOTHING) return [-1, 1];
  const pad = high - low > ROUNDING * size ? 0.06 * (high - low) : 0.05 * size;
  return [low - pad, high + pad];
}
