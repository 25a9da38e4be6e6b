import { Box3, type BufferGeometry, type Material, Matrix4, Mesh, type Object3D, Vector3 } from "three";
import type { Scene, Shape } from "../protocol";
import { multiply, placed } from "./affine";
import type { Part } from "./batches";
import type { Measures } from "./layout";
import type { Materials } from "./materials";
import type { Forms } from "./shape_geometry";
import type { Wardrobe } from "./skins/skin";

/** A part of a shape, or of a model that a body wears instead. */
export interface ShapePart extends Part {
  /** Which shape; −1 for a model's. */
  shape: number;
}

/** How bodies are drawn, besides their skins. */
export interface Style {
  /** See-through, to see joints and centres of mass. */
  translucent: boolean;
  wireframe: boolean;
}

/** A level plane without end: the floor, drawn apart. */
export function isFloor(shape: Shape, up: Scene["up"]): boolean {
  if (shape.geometry.kind !== "plane" || shape.geometry.half || shape.body >= 0) return false;
  return placed(shape.placement)[up === "y" ? 5 : 6] > 0.999;
}

/** All that is drawn of a scene's shapes, in skins. */
export class PartMaker {
  constructor(
    private readonly scene: Scene,
    private readonly measures: Measures,
    private readonly forms: Forms,
    private readonly materials: Materials,
  ) {}

  make(wardrobe: Wardrobe, style: Style): ShapePart[] {
    const shapes = this.scene.shapes.flatMap((shape, row) => {
      if (isFloor(shape, this.scene.up) || wardrobe.of(shape.body).kind === "model") return [];
      return [this.shapePart(shape, row, wardrobe, style)];
    });
    const models = this.scene.bodies.flatMap((_, body) => {
      const skin = wardrobe.of(body);
      return skin.kind === "model" ? this.modelParts(body, skin.model, skin.fitted) : [];
    });
    return [...shapes, ...models];
  }

  /** The box that holds a body's shapes, in its frame. */
  bodyBox(body: number): Box3 {
    const box = new Box3();
    for (const shape of this.scene.shapes) {
      if (shape.body !== body) continue;
      const { geometry, scale } = this.forms.of(shape.geometry, this.measures.world);
      box.union(boxOf(geometry).applyMatrix4(new Matrix4().fromArray(placed(shape.placement, scale))));
    }
    return box.isEmpty()
      ? box.setFromCenterAndSize(new Vector3(), new Vector3().setScalar(this.measures.body))
      : box;
  }

  private shapePart(shape: Shape, row: number, wardrobe: Wardrobe, style: Style): ShapePart {
    const skin = wardrobe.of(shape.body);
    const { kind } = shape.geometry;
    const color = shape.color ?? this.scene.bodies[shape.body]?.color;
    const worn = skin.kind === "color" ? skin.opacity : undefined;
    const opacity = (worn ?? color?.[3] ?? 1) * (shape.sensor ? 0.4 : 1);
    const { geometry, scale } = this.forms.of(shape.geometry, 1.5 * this.measures.world);
    const material = this.materials.get({
      marked: shape.body >= 0 && (kind === "sphere" || kind === "ellipsoid"),
      flat: shape.geometry.kind === "mesh" && shape.geometry.flat,
      opacity: style.translucent && shape.body >= 0 ? 0.35 * opacity : opacity,
      thin: kind === "plane" || kind === "mesh",
      wireframe: style.wireframe,
      picture: skin.kind === "picture" ? skin.picture : null,
    });
    const local = placed(shape.placement, scale);
    return { body: shape.body, shape: row, geometry, material, local, shadow: material.opacity === 1 };
  }

  private modelParts(body: number, model: Object3D, fitted: boolean): ShapePart[] {
    const place = new Float32Array(this.modelPlace(body, model, fitted).elements);
    const parts: ShapePart[] = [];
    model.updateMatrixWorld();
    model.traverse((node) => {
      if (!(node instanceof Mesh)) return;
      const local = new Float32Array(16);
      multiply(local, 0, place, 0, node.matrixWorld.elements, 0);
      const material = node.material as Material;
      parts.push({
        body,
        shape: -1,
        geometry: node.geometry as BufferGeometry,
        material,
        local,
        shadow: true,
      });
    });
    return parts;
  }

  /** From a model's axes, whose y points up, to the body's. */
  private modelPlace(body: number, model: Object3D, fitted: boolean): Matrix4 {
    const turn = new Matrix4();
    if (this.scene.up === "z") turn.makeRotationX(Math.PI / 2);
    if (!fitted) return turn;
    const target = this.bodyBox(body);
    const box = new Box3().setFromObject(model).applyMatrix4(turn);
    const [from, to] = [box.getSize(new Vector3()), target.getSize(new Vector3())];
    const scale = Math.max(...to.toArray()) / (Math.max(...from.toArray()) || 1);
    const center = target.getCenter(new Vector3()).sub(box.getCenter(new Vector3()).multiplyScalar(scale));
    return new Matrix4()
      .makeTranslation(center)
      .multiply(new Matrix4().makeScale(scale, scale, scale))
      .multiply(turn);
  }
}

function boxOf(geometry: BufferGeometry): Box3 {
  if (!geometry.boundingBox) geometry.computeBoundingBox();
  return (geometry.boundingBox ?? new Box3()).clone();
}
