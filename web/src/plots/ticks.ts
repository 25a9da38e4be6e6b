/** Round numbers within a range, about `count` of them: multiples of 1, 2 or 5 times a power of ten. */
export function ticks(low: number, high: number, count: number): number[] {
  if (!(high > low)) return [low];
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((factor) => factor * power >= rough * 0.999) ?? 10);
  const found: number[] = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) {
    found.push(Number((i * step).toPrecision(12)));
  }
  return found;
}

/** A range a little wider than what it holds, never empty. */
export function padded(low: number, high: number): [number, number] {
  if (low > high) return [0, 1];
  const pad = 0.06 * (high - low) || 0.05 * Math.abs(low) || 1;
  return [low - pad, high + pad];
}
