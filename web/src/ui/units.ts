/** Units for people: what is in radians is shown in degrees. */

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
