/** Checks that what came from outside has the shape it should have. A type and its check are one text. */

/** Returns the value itself where it is a `T`, and throws {@link Malformed} where it is not. */
export type Check<T> = (value: unknown) => T;

/** What a check lets through. */
export type Checked<C> = C extends Check<infer T> ? T : never;

/** A value from outside is not what it should be. */
export class Malformed extends Error {
  override readonly name = "Malformed";
  private path = "";

  constructor(private readonly wrong: string) {
    super(wrong);
  }

  /** The same, seen from one step further out. */
  inside(step: string): this {
    this.path = step + this.path;
    this.message = `${this.path.replace(/^\./, "")}: ${this.wrong}`;
    return this;
  }
}

function at<T>(step: string, check: Check<T>, value: unknown): T {
  try {
    return check(value);
  } catch (error) {
    throw error instanceof Malformed ? error.inside(step) : error;
  }
}

function is<T>(type: string, name: string): Check<T> {
  return (value) => {
    if (typeof value !== type) throw new Malformed(`not ${name}`);
    return value as T;
  };
}

export const text = is<string>("string", "a text");
export const flag = is<boolean>("boolean", "true or false");

export const number: Check<number> = (value) => {
  if (typeof value !== "number" || !Number.isFinite(value)) throw new Malformed("not a finite number");
  return value;
};

export const integer: Check<number> = (value) => {
  if (!Number.isInteger(value)) throw new Malformed("not a whole number");
  return value as number;
};

/** A whole number from 0. */
export const count: Check<number> = (value) => {
  if (integer(value) < 0) throw new Malformed("negative");
  return value as number;
};

/** One of some texts. */
export function oneOf<const T extends string>(...names: T[]): Check<T> {
  return (value) => {
    if (!names.includes(value as T)) throw new Malformed(`not one of ${names.join(", ")}`);
    return value as T;
  };
}

export function nullable<T>(check: Check<T>): Check<T | null> {
  return (value) => (value === null ? null : check(value));
}

/** What may be missing, too. */
export function optional<T>(check: Check<T>): Check<T | null | undefined> {
  return (value) => (value === null || value === undefined ? value : check(value));
}

export function array<T>(check: Check<T>): Check<T[]> {
  return (value) => {
    if (!Array.isArray(value)) throw new Malformed("not an array");
    for (let i = 0; i < value.length; i++) at(`[${i}]`, check, value[i]);
    return value;
  };
}

export type Pair = [number, number];
export type Triple = [number, number, number];
export type Quadruple = [number, number, number, number];

function tuple<T extends number[]>(length: number): Check<T> {
  const numbers = array(number);
  return (value) => {
    if (numbers(value).length !== length) throw new Malformed(`not ${length} numbers`);
    return value as T;
  };
}

export const pair = tuple<Pair>(2);
export const triple = tuple<Triple>(3);
export const quadruple = tuple<Quadruple>(4);

/** An object that maps any names to a `T`. */
export function record<T>(check: Check<T>): Check<Record<string, T>> {
  return (value) => {
    const all = members(value);
    for (const name in all) at(`.${name}`, check, all[name]);
    return all as Record<string, T>;
  };
}

type Fields = Record<string, Check<unknown>>;
type Optional<F extends Fields> = { [K in keyof F]: undefined extends Checked<F[K]> ? K : never }[keyof F];
type Simple<T> = { [K in keyof T]: T[K] } & {};
type ObjectOf<F extends Fields> = Simple<
  { [K in Exclude<keyof F, Optional<F>>]: Checked<F[K]> } & { [K in Optional<F>]?: Checked<F[K]> }
>;

/** An object with exactly these fields. */
export function object<F extends Fields>(fields: F): Check<ObjectOf<F>> {
  return (value) => {
    const all = members(value);
    for (const name in fields) at(`.${name}`, fields[name], all[name]);
    for (const name in all) if (!(name in fields)) throw new Malformed("unknown field").inside(`.${name}`);
    return all as ObjectOf<F>;
  };
}

/** An object whose field `tag` names which of several it is. */
export function tagged<const K extends string, V extends Record<string, Fields>>(
  tag: K,
  variants: V,
): Check<{ [N in keyof V & string]: Simple<Record<K, N> & ObjectOf<V[N]>> }[keyof V & string]> {
  const checks = new Map(
    Object.entries(variants).map(([name, fields]) => [name, object({ [tag]: oneOf(name), ...fields })]),
  );
  return (value) => {
    const check = checks.get(String(members(value)[tag]));
    if (!check) throw new Malformed(`not one of ${[...checks.keys()].join(", ")}`).inside(`.${tag}`);
    // biome-ignore lint/suspicious/noExplicitAny: which variant it is, the tag has told
    return check(value) as any;
  };
}

function members(value: unknown): Record<string, unknown> {
  if (typeof value !== "object" || value === null || Array.isArray(value))
    throw new Malformed("not an object");
  return value as Record<string, unknown>;
}
