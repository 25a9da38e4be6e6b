import {
  BufferAttribute,
  BufferGeometry,
  type Color,
  DynamicDrawUsage,
  LineBasicMaterial,
  LineSegments,
} from "three";
import { IN_FRONT } from "./overlay";

/** Line segments written anew for every frame, seen through bodies. */
export class Lines extends LineSegments<BufferGeometry, LineBasicMaterial> {
  private points = new Float32Array(6 * 256);
  private colors = new Float32Array(6 * 256);
  private used = 0;

  constructor() {
    super(
      new BufferGeometry(),
      new LineBasicMaterial({ vertexColors: true, depthTest: false, transparent: true, toneMapped: false }),
    );
    this.frustumCulled = false;
    this.renderOrder = IN_FRONT;
    this.allot();
  }

  begin(): void {
    this.used = 0;
  }

  /** A segment between two points, given with the map that takes them into the scene. */
  segment(map: ArrayLike<number>, m: number, a: readonly number[], b: readonly number[], color: Color): void {
    if (this.used + 6 > this.points.length) this.grow();
    this.point(map, m, a, color);
    this.point(map, m, b, color);
  }

  end(): void {
    for (const attribute of [this.geometry.getAttribute("position"), this.geometry.getAttribute("color")]) {
      (attribute as BufferAttribute).clearUpdateRanges();
      (attribute as BufferAttribute).addUpdateRange(0, this.used);
      attribute.needsUpdate = true;
    }
    this.geometry.setDrawRange(0, this.used / 3);
  }

  override dispose(): void {
    this.geometry.dispose();
    this.material.dispose();
  }

  private point(map: ArrayLike<number>, m: number, [x, y, z]: readonly number[], color: Color): void {
    for (let row = 0; row < 3; row++) {
      this.points[this.used + row] =
        map[m + row] * x + map[m + 4 + row] * y + map[m + 8 + row] * z + map[m + 12 + row];
    }
    color.toArray(this.colors, this.used);
    this.used += 3;
  }

  private grow(): void {
    const [points, colors] = [this.points, this.colors];
    this.points = new Float32Array(2 * points.length);
    this.points.set(points);
    this.colors = new Float32Array(2 * colors.length);
    this.colors.set(colors);
    this.allot();
  }

  private allot(): void {
    this.geometry.dispose();
    this.geometry = new BufferGeometry();
    for (const [name, array] of [["position", this.points] as const, ["color", this.colors] as const]) {
      const attribute = new BufferAttribute(array, 3);
      attribute.setUsage(DynamicDrawUsage);
      this.geometry.setAttribute(name, attribute);
    }
  }
}
