import { Color } from "three";
import { CONTACT, type Frame, POSE } from "../../frame";
import type { Scene } from "../../protocol";

/** Measures of a body's state that a skin may show. */
export const GAUGES = {
  speed: { label: "Speed", unit: "m/s" },
  spin: { label: "Spin", unit: "rad/s" },
  force: { label: "Contact force", unit: "N" },
  height: { label: "Height", unit: "m" },
} as const;
export type GaugeName = keyof typeof GAUGES;

/** Reads a gauge of all bodies from frame to frame. */
export class Gauge {
  private before: Frame | null = null;
  private values = new Float32Array(0);
  /** Least and most seen of late. */
  readonly range: [number, number] = [0, 0];

  constructor(
    private readonly scene: Scene,
    private readonly name: GaugeName,
  ) {}

  update(frame: Frame): void {
    const { name } = this;
    const count = frame.worlds * frame.bodies;
    if (this.values.length !== count) this.values = new Float32Array(count);
    if (name === "height") this.readHeights(frame);
    else if (name === "force") this.readForces(frame);
    else this.readRates(name, frame);
    this.before = frame;
    this.widen(name === "height");
  }

  color(world: number, body: number, out: Color): Color {
    const [low, high] = this.range;
    const value = this.values[world * this.scene.bodies.length + body];
    return viridis(high > low ? (value - low) / (high - low) : 0, out);
  }

  private readHeights(frame: Frame): void {
    const up = this.scene.up === "y" ? 1 : 2;
    for (let i = 0; i < this.values.length; i++) this.values[i] = frame.poses[POSE * i + up];
  }

  private readForces({ contacts, bodies }: Frame): void {
    this.values.fill(0);
    for (let i = 0; i < contacts.length; i += CONTACT) {
      const force = Math.hypot(contacts[i + 4], contacts[i + 5], contacts[i + 6]);
      for (const shape of [contacts[i + 8], contacts[i + 9]]) {
        const body = this.scene.shapes[shape]?.body ?? -1;
        if (body >= 0) this.values[contacts[i] * bodies + body] += force;
      }
    }
  }

  /** Differences from the last frame of the same worlds; what stands still since, keeps its colour. */
  private readRates(name: "speed" | "spin", { poses, time, choices }: Frame): void {
    const before = this.before;
    if (before?.poses.length !== poses.length || before.choices !== choices || time <= before.time) return;
    const rate = 1 / (time - before.time);
    const was = before.poses;
    for (let i = 0, p = 0; p < poses.length; i++, p += POSE) {
      if (name === "speed") {
        this.values[i] =
          rate * Math.hypot(poses[p] - was[p], poses[p + 1] - was[p + 1], poses[p + 2] - was[p + 2]);
      } else {
        let cosine = 0;
        for (let k = 3; k < POSE; k++) cosine += poses[p + k] * was[p + k];
        this.values[i] = rate * 2 * Math.acos(Math.min(1, Math.abs(cosine)));
      }
    }
  }

  /** The range takes in what is new at once, and forgets what is old within some hundred frames. */
  private widen(signed: boolean): void {
    let [low, high] = [signed ? Number.POSITIVE_INFINITY : 0, signed ? Number.NEGATIVE_INFINITY : 0];
    for (const value of this.values) {
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    if (low > high) return;
    const fade = 0.01;
    this.range[0] = Math.min(low, this.range[0] + fade * (low - this.range[0]));
    this.range[1] = Math.max(high, this.range[1] + fade * (high - this.range[1]));
  }
}

/** Seven colours of matplotlib's map viridis (van der Walt and Smith, 2015), in sRGB. */
const VIRIDIS = ["#440154", "#443983", "#31688e", "#21918c", "#35b779", "#90d743", "#fde725"];
const STOPS = VIRIDIS.map((name) => new Color(name));

/** The scale as a CSS gradient. */
export const SCALE = `linear-gradient(to right, ${VIRIDIS.join(", ")})`;

/** The colour of a share from 0 to 1. */
export function viridis(share: number, out: Color): Color {
  const at = Math.min(Math.max(share, 0), 1) * (STOPS.length - 1);
  const stop = Math.min(Math.floor(at), STOPS.length - 2);
  return out.lerpColors(STOPS[stop], STOPS[stop + 1], at - stop);
}
