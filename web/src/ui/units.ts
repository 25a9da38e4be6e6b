/** Units for people: what is in radians is shown in degrees. */

import { short } from "./format";

const DEGREE = Math.PI / 180;

/** The unit in which a quantity is shown, and how much one of it is in the engine's unit. */
export interface Shown {
  unit: string;
  factor: number;
}

export function shownIn(unit: string): Shown {
  if (unit === "rad") return { unit: "°", factor: DEGREE };
  if (unit === "rad/s") return { unit: "°/s", factor: DEGREE };
  return { unit, factor: 1 };
}

/** How far a slider goes, in words; digits may go beyond one that is not `strict`. */
export function ranged([least, most]: [number, number], unit: string, strict: boolean): string {
  const [from, to] = [least, most].map((end) => `${short(end)} ${unit}`.trim());
  return strict ? `From ${from} to ${to}.` : `The slider goes from ${from} to ${to}; digits may go beyond.`;
}
