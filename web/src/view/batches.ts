import {
  type BufferGeometry,
  type Color,
  Group,
  type Intersection,
  type Material,
  type Raycaster,
} from "three";
import { multiply } from "./affine";
import { Instances } from "./instances";
import type { Poses } from "./poses";

/** A mesh that a body carries, in every world. */
export interface Part {
  /** Body, or −1. */
  body: number;
  geometry: BufferGeometry;
  material: Material;
  /** Its map into the body's frame. */
  local: ArrayLike<number>;
  shadow: boolean;
}

/** The colour of a body in a world shown. */
export type Coloring = (part: Part, world: number) => Color;

/** Parts that share geometry and material are drawn at once, over all worlds. */
interface Batch {
  instances: Instances;
  parts: Part[];
}

/** Draws parts where their bodies are. */
export class Batches extends Group {
  private readonly batches: Batch[] = [];
  private worlds = 0;

  constructor(parts: Iterable<Part>) {
    super();
    const kin = Map.groupBy(parts, (part) => `${part.geometry.uuid} ${part.material.uuid} ${part.shadow}`);
    for (const list of kin.values()) this.addBatch(list);
  }

  private addBatch(parts: Part[]): void {
    const { geometry, material, shadow } = parts[0];
    const instances = new Instances(geometry, material, true, parts.length);
    instances.castShadow = shadow;
    instances.receiveShadow = true;
    instances.mesh.castShadow = shadow;
    instances.mesh.receiveShadow = true;
    this.add(instances);
    this.batches.push({ instances, parts });
  }

  move(poses: Poses): void {
    this.worlds = poses.worlds;
    for (const { instances, parts } of this.batches) {
      const matrices = instances.reserve(parts.length * poses.worlds);
      let out = 0;
      for (let world = 0; world < poses.worlds; world++) {
        for (const part of parts) {
          const [from, at] = poses.of(world, part.body);
          multiply(matrices, out, from, at, part.local, 0);
          out += 16;
        }
      }
      instances.moved();
    }
  }

  /** Colours all parts, after {@link move}. */
  paint(coloring: Coloring): void {
    for (const { instances, parts } of this.batches) {
      const colors = instances.colors;
      let out = 0;
      for (let world = 0; world < this.worlds; world++) {
        for (const part of parts) {
          coloring(part, world).toArray(colors, out);
          out += 3;
        }
      }
      instances.recolored();
    }
  }

  /** The first part that a ray meets. */
  hit(ray: Raycaster): { part: Part; world: number; hit: Intersection } | null {
    let best: { part: Part; world: number; hit: Intersection } | null = null;
    for (const { instances, parts } of this.batches) {
      const [hit] = ray.intersectObject(instances.mesh, false);
      if (!hit || hit.instanceId === undefined || (best && best.hit.distance <= hit.distance)) continue;
      const world = Math.floor(hit.instanceId / parts.length);
      best = { part: parts[hit.instanceId % parts.length], world, hit };
    }
    return best;
  }

  override dispose(): void {
    for (const { instances } of this.batches) instances.dispose();
  }
}
