/** Numbers for people. */

/** With so many significant digits, without needless zeros: `0.25`, `1.2e−7`. */
export function short(value: number, digits = 4): string {
  if (!Number.isFinite(value)) return "–";
  const rounded = Number(value.toPrecision(digits));
  const small = rounded !== 0 && Math.abs(rounded) < 1e-3;
  return (small ? rounded.toExponential() : String(rounded)).replaceAll("-", "−");
}

const PREFIXES: [number, string][] = [
  [1e9, "G"],
  [1e6, "M"],
  [1e3, "k"],
];

/** With a prefix for thousands: `2.5 M`. */
export function large(value: number): string {
  const [unit, prefix] = PREFIXES.find(([least]) => Math.abs(value) >= least) ?? [1, ""];
  return `${short(value / unit, 3)}${prefix && ` ${prefix}`}`;
}

/** Numbers side by side: `0.1, −2, 3`. */
export function list(values: Iterable<number>, digits = 3): string {
  return [...values].map((value) => short(value, digits)).join(", ");
}

/** Numbers side by side, each with as many decimals, so that they do not dance: `0.100, −2.000`. */
export function fixed(values: Iterable<number>, decimals: number): string {
  const minus = (text: string) => (Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−"));
  return [...values].map((value) => minus(value.toFixed(decimals))).join(", ");
}
