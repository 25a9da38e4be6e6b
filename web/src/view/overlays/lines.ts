import { type Color, DynamicDrawUsage, InstancedInterleavedBuffer, InterleavedBufferAttribute } from "three";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import { IN_FRONT } from "./overlay";

/** Two points, or two colours. */
const SEGMENT = 6;
/** [px] */
const WIDTH = 2;

/** Line segments written anew for every frame, seen through bodies. */
export class Lines extends LineSegments2 {
  private points = new Float32Array(0);
  private colors = new Float32Array(0);
  private used = 0;

  constructor() {
    const look = { linewidth: WIDTH, vertexColors: true, depthTest: false, transparent: true };
    super(new LineSegmentsGeometry(), new LineMaterial(look));
    this.material.toneMapped = false;
    this.frustumCulled = false;
    this.renderOrder = IN_FRONT;
    this.allot(256 * SEGMENT);
  }

  begin(): void {
    this.used = 0;
  }

  /** A segment between two points, given with the map that takes them into the scene. */
  segment(map: ArrayLike<number>, m: number, a: readonly number[], b: readonly number[], color: Color): void {
    if (this.used + SEGMENT > this.points.length) this.allot(2 * this.points.length);
    this.point(map, m, a, color);
    this.point(map, m, b, color);
  }

  end(): void {
    for (const name of ["instanceStart", "instanceColorStart"]) {
      const { data } = this.geometry.getAttribute(name) as InterleavedBufferAttribute;
      data.clearUpdateRanges();
      data.addUpdateRange(0, this.used);
      data.needsUpdate = true;
    }
    this.geometry.instanceCount = this.used / SEGMENT;
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

  private allot(length: number): void {
    const [points, colors] = [this.points, this.colors];
    this.points = new Float32Array(length);
    this.points.set(points);
    this.colors = new Float32Array(length);
    this.colors.set(colors);
    this.geometry.dispose();
    this.geometry = new LineSegmentsGeometry();
    this.bind(this.points, "instanceStart", "instanceEnd");
    this.bind(this.colors, "instanceColorStart", "instanceColorEnd");
  }

  private bind(array: Float32Array, start: string, end: string): void {
    const buffer = new InstancedInterleavedBuffer(array, SEGMENT, 1);
    buffer.setUsage(DynamicDrawUsage);
    this.geometry.setAttribute(start, new InterleavedBufferAttribute(buffer, 3, 0));
    this.geometry.setAttribute(end, new InterleavedBufferAttribute(buffer, 3, 3));
  }
}
