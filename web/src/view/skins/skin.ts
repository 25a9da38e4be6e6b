import { Color, type Object3D, type Texture } from "three";
import type { GaugeName } from "./gauges";

/** What a body wears. None of it touches the physics. */
export type Skin =
  /** The colours of its shapes. */
  | { kind: "plain" }
  /** One colour; its opacity is that of the shapes, where none is given. */
  | { kind: "color"; color: Color; opacity?: number }
  /** A colour for each replica. */
  | { kind: "replica" }
  /** A colour that follows its state. */
  | { kind: "gauge"; gauge: GaugeName }
  | { kind: "picture"; picture: Texture }
  /** A model instead of its shapes, as large as in its file or fitted to them. */
  | { kind: "model"; model: Object3D; fitted: boolean };

/** Whether bodies that change from one into the other are drawn by the same parts, in other colours. */
export function sameParts(before: Skin, after: Skin): boolean {
  const opacity = (skin: Skin) => (skin.kind === "color" ? skin.opacity : undefined);
  const hasParts = (skin: Skin) => skin.kind === "picture" || skin.kind === "model";
  return !hasParts(before) && !hasParts(after) && opacity(before) === opacity(after);
}

/** A skin, and the bodies that wear it; `null` are all of them. */
export interface Worn {
  bodies: readonly number[] | null;
  skin: Skin;
}

/** What all bodies wear: one skin in common, and some their own. */
export class Wardrobe {
  common: Skin = { kind: "plain" };
  private readonly own = new Map<number, Skin>();

  /** The skin of a body; what belongs to the world stays plain. */
  of(body: number): Skin {
    return body < 0 ? { kind: "plain" } : (this.own.get(body) ?? this.common);
  }

  /** Which states colours follow. */
  get gauges(): Set<GaugeName> {
    const skins = [this.common, ...this.own.values()];
    return new Set(skins.flatMap((skin) => (skin.kind === "gauge" ? [skin.gauge] : [])));
  }

  dress(body: number, skin: Skin): void {
    this.own.set(body, skin);
  }

  /** All bodies wear the same. */
  dressAll(skin: Skin): void {
    this.undress();
    this.common = skin;
  }

  /** No body wears its own any more. */
  undress(): void {
    this.own.clear();
  }
}

/** A colour for a replica, far from those of its neighbours. */
export function replicaColor(world: number): Color {
  const golden = 0.618034;
  return new Color().setHSL((0.58 + golden * world) % 1, 0.5, 0.55);
}
