import {
  BufferAttribute,
  BufferGeometry,
  type Color,
  DynamicDrawUsage,
  Group,
  Line,
  LineBasicMaterial,
} from "three";
import type { Scene } from "../../protocol";
import { replicaColor } from "../skins/skin";
import type { Moment, Overlay, Picked } from "./overlay";

/** Points of a trail. */
const LENGTH = 400;
/** At most so many trails, lest they hide what leaves them. */
const MOST = 256;

/** Whose trails are drawn. */
export type TrailChoice = "none" | "picked" | "all";

interface Trail extends Picked {
  line: Line<BufferGeometry>;
  points: Float32Array;
  length: number;
}

/** The ways that centres of mass have come, fading with age. */
export class Trails implements Overlay {
  readonly object = new Group();
  private readonly material = new LineBasicMaterial({
    vertexColors: true,
    transparent: true,
    toneMapped: false,
  });
  private trails: Trail[] = [];
  private of = "";
  private time = Number.NEGATIVE_INFINITY;
  choice: TrailChoice = "none";

  constructor(private readonly scene: Scene) {}

  draw(moment: Moment): void {
    this.choose(moment);
    const { time } = moment.frame;
    if (time === this.time) return;
    if (time < this.time) for (const trail of this.trails) trail.length = 0;
    this.time = time;
    for (const trail of this.trails) this.extend(trail, moment);
  }

  dispose(): void {
    for (const { line } of this.trails) line.geometry.dispose();
    this.material.dispose();
  }

  private choose({ frame, poses, picked }: Moment): void {
    const body = this.choice === "picked" ? picked : null;
    const key = JSON.stringify([this.choice, frame.choices, poses.worlds, body]);
    if (key === this.of) return;
    this.of = key;
    this.time = Number.NEGATIVE_INFINITY;
    for (const { line } of this.trails) line.geometry.dispose();
    this.object.clear();
    this.trails = this.wanted(poses.worlds, picked)
      .slice(0, MOST)
      .map((body) => this.start(body));
  }

  private wanted(worlds: number, picked: Picked | null): Picked[] {
    if (this.choice === "picked") return picked ? [picked] : [];
    if (this.choice === "none") return [];
    const bodies = this.scene.bodies.flatMap(({ dynamic }, body) => (dynamic ? [body] : []));
    return Array.from({ length: worlds }, (_, row) => bodies.map((body) => ({ row, body }))).flat();
  }

  private start({ row, body }: Picked): Trail {
    const points = new Float32Array(3 * LENGTH);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(points, 3).setUsage(DynamicDrawUsage));
    geometry.setAttribute("color", fading(replicaColor(row)));
    const line = new Line(geometry, this.material);
    line.frustumCulled = false;
    this.object.add(line);
    return { row, body, line, points, length: 0 };
  }

  /** The newest point is the first; the others move on by one. */
  private extend(trail: Trail, { poses }: Moment): void {
    const { points, line } = trail;
    points.copyWithin(3, 0);
    const [map, m] = poses.of(trail.row, trail.body);
    const [x, y, z] = this.scene.bodies[trail.body].inertial.position;
    for (let axis = 0; axis < 3; axis++) {
      points[axis] = map[m + axis] * x + map[m + 4 + axis] * y + map[m + 8 + axis] * z + map[m + 12 + axis];
    }
    trail.length = Math.min(trail.length + 1, LENGTH);
    line.geometry.setDrawRange(0, trail.length);
    line.geometry.getAttribute("position").needsUpdate = true;
  }
}

function fading(color: Color): BufferAttribute {
  const colors = new Float32Array(4 * LENGTH);
  for (let i = 0; i < LENGTH; i++) colors.set([color.r, color.g, color.b, 1 - i / LENGTH], 4 * i);
  return new BufferAttribute(colors, 4);
}
