import {
  Color,
  DirectionalLight,
  Group,
  type Light,
  PointLight,
  Quaternion,
  SpotLight,
  Vector3,
} from "three";
import type { Lamp, Scene, Shape } from "../protocol";
import type { Triple } from "../schema";
import { core, type Measures, radius } from "./layout";
import type { Poses } from "./poses";

/** Most lamps that shine on the page, and that throw shadows there: what graphics cards have room for. */
const MOST = 16;
const MOST_SHADOWS = 4;
const SHADOW_PIXELS = 1024;

/** The model's sun: where it comes from, in the scene's axes, and its colour in linear light. */
export interface Sun {
  to: Triple;
  color: Triple;
}

/** The sun of a model that names lights; black, where none of them is it; null where it names no light. */
export function sunOf({ lamps, sun }: Scene): Sun | null {
  if (!lamps.length) return null;
  const lamp = lamps[sun];
  if (!lamp) return { to: [0, 1, 0], color: [0, 0, 0] };
  const to = new Vector3(0, 0, 1).applyQuaternion(new Quaternion(...lamp.placement.orientation));
  return { to: to.toArray(), color: lamp.color };
}

/**
 * The power of the distance by which light fades, and how bright it is at 1 m: the law d⁻ᵖ that is the lamp's own law
 * 1 / (a + b d + c d²) and has its slope at a distance.
 */
export function fading([a, b, c]: Triple, distance: number): { power: number; strength: number } {
  const sum = a + b * distance + c * distance ** 2;
  const power = (b * distance + 2 * c * distance ** 2) / sum;
  return { power, strength: distance ** power / sum };
}

/** How far [m] from a lamp nothing throws a shadow: what holds it lets its light out. */
export function held({ body, mode, placement }: Lamp, shapes: readonly Shape[]): number {
  let far = 0;
  for (const shape of shapes) {
    if (shape.body !== body || mode !== "fixed") continue;
    const distance = new Vector3(...placement.position).distanceTo(new Vector3(...shape.placement.position));
    if (distance < core(shape)) far = Math.max(far, distance + radius(shape));
  }
  return far;
}

/** One lamp, where its body is. */
interface Placed {
  lamp: Lamp;
  light: SpotLight | PointLight | DirectionalLight;
}

/** The lamps of a model, of the first world shown; the sun is not among them. */
export class Lamps extends Group {
  private readonly placed: Placed[];

  constructor(
    private readonly model: Scene,
    private readonly measures: Measures,
  ) {
    super();
    const lamps = model.lamps.filter((_, row) => row !== model.sun).slice(0, MOST);
    this.placed = lamps.map((lamp) => ({ lamp, light: this.make(lamp) }));
    for (const { light } of this.placed) {
      this.add(light);
      if ("target" in light) this.add(light.target);
    }
    this.shadows = true;
  }

  set shadows(on: boolean) {
    let left = MOST_SHADOWS;
    for (const { lamp, light } of this.placed) {
      light.castShadow = on && lamp.shadows && left-- > 0;
    }
  }

  /** Brings them to where their bodies are. */
  move(poses: Poses): void {
    for (const { lamp, light } of this.placed) {
      const matrix = poses.mounted(0, lamp);
      light.position.setFromMatrixPosition(matrix);
      if (!("target" in light)) continue;
      const along = new Vector3().setFromMatrixColumn(matrix, 2).multiplyScalar(-this.measures.world);
      light.target.position.copy(light.position).add(along);
      // Parallel light comes from outside of the scene.
      if (light instanceof DirectionalLight) light.position.addScaledVector(along, -2);
    }
  }

  override dispose(): void {
    for (const { light } of this.placed) light.dispose();
  }

  private make(lamp: Lamp): Placed["light"] {
    const { beam, color, attenuation } = lamp;
    const near = Math.max(held(lamp, this.model.shapes), 0.01 * this.measures.world);
    const { world } = this.measures;
    const { power, strength } = fading(attenuation, world);
    const shade = new Color(...color);
    // A sheet that three.js lights by π is white.
    const bright = Math.PI * strength;
    switch (beam.kind) {
      case "parallel": {
        const light = this.shadowed(new DirectionalLight(shade, Math.PI), near);
        const { camera } = light.shadow;
        camera.left = camera.bottom = -2 * world;
        camera.right = camera.top = 2 * world;
        return light;
      }
      case "point":
        return this.shadowed(new PointLight(shade, bright, 0, power), near);
      case "spot":
        // The sharper its exponent, the softer its edge.
        return this.shadowed(
          new SpotLight(shade, bright, 0, beam.cutoff, beam.exponent / (beam.exponent + 1), power),
          near,
        );
    }
  }

  private shadowed<L extends Light & Placed["light"]>(light: L, near: number): L {
    const { camera, mapSize } = light.shadow;
    mapSize.set(SHADOW_PIXELS, SHADOW_PIXELS);
    camera.near = near;
    camera.far = 20 * this.measures.world;
    light.shadow.normalBias = (6 * this.measures.world) / SHADOW_PIXELS;
    return light;
  }
}
