import { Box3, Color, Group, type Intersection, Matrix4, type Raycaster, Vector3 } from "three";
import type { Frame } from "../frame";
import type { Scene } from "../protocol";
import { Batches, type Part } from "./batches";
import { Lamps } from "./lamps";
import { type Measures, measure, moves } from "./layout";
import { Materials } from "./materials";
import type { ViewOptions } from "./options";
import { ContactForces, ContactPoints } from "./overlays/contacts";
import { Frames } from "./overlays/frames";
import { JointAxes } from "./overlays/joints";
import { Masses } from "./overlays/masses";
import type { Overlay, Picked } from "./overlays/overlay";
import { Particles } from "./overlays/particles";
import { Trails } from "./overlays/trails";
import { isFloor, PartMaker, type ShapePart } from "./parts";
import { PickedBox } from "./picked_box";
import { Poses } from "./poses";
import { Forms, sides } from "./shape_geometry";
import { Gauge, type GaugeName } from "./skins/gauges";
import { replicaColor, type Wardrobe } from "./skins/skin";

/** Colour of what belongs to the world and has none. */
const WORLD_COLOR: readonly number[] = [0.68, 0.7, 0.72];
const WHITE = new Color(1, 1, 1);

/** What a ray meets. */
export interface Hit extends Picked {
  shape: number;
  /** In the scene's axes, world's shift included [m]. */
  point: Vector3;
}

/** One scene, drawn: its bodies in their skins, and what is drawn over them. */
export class SceneView {
  readonly group = new Group();
  readonly measures: Measures;
  readonly poses: Poses;
  /** Of the states that skins follow. */
  readonly gauges = new Map<GaugeName, Gauge>();
  private forms: Forms;
  private readonly materials = new Materials();
  private maker: PartMaker;
  private batches = new Batches([]);
  private readonly lamps: Lamps;
  private readonly trails: Trails;
  private readonly overlays: [overlay: Overlay, wanted: (options: ViewOptions) => boolean][];
  private readonly box = new PickedBox();
  private readonly color = new Color();
  private painted = 0;

  constructor(
    readonly scene: Scene,
    private readonly wardrobe: Wardrobe,
    private options: ViewOptions,
  ) {
    this.measures = measure(scene);
    this.poses = new Poses(scene);
    this.forms = new Forms(sides(scene.shapes.length * scene.shown.length));
    this.maker = new PartMaker(scene, this.measures, this.forms, this.materials);
    this.lamps = new Lamps(scene, this.measures);
    this.trails = new Trails(scene);
    this.overlays = [
      [new Particles(), (o) => o.particles],
      [this.trails, (o) => o.trails !== "none"],
      [new Frames(), (o) => o.frames],
      [new Masses(scene, this.measures), (o) => o.masses],
      [new JointAxes(), (o) => o.joints],
      [new ContactPoints(), (o) => o.contacts],
      [new ContactForces(scene), (o) => o.forces],
    ];
    this.group.add(...this.overlays.map(([overlay]) => overlay.object), this.box, this.lamps);
    this.apply(options);
  }

  /** Height [m] of its highest floor along the axis that points up, or null. */
  get floor(): number | null {
    const up = this.scene.up === "y" ? 1 : 2;
    const floors = this.scene.shapes.filter((shape) => isFloor(shape, this.scene.up));
    return floors.length ? Math.max(...floors.map((shape) => shape.placement.position[up])) : null;
  }

  /** The box within which bodies of the worlds shown move. */
  get bounds(): Box3 {
    const box = new Box3();
    const [low, high] = moves(this.scene, this.measures).map((corner) => new Vector3(...corner));
    // What is free may fall.
    const { floor } = this;
    const up = this.scene.up === "y" ? 1 : 2;
    if (floor !== null && this.scene.joints.some(({ kind }) => kind === "free")) {
      low.setComponent(up, Math.min(low.getComponent(up), floor));
    }
    const { shifts, worlds } = this.poses;
    for (let world = 0; world < worlds; world++) {
      const shift = new Vector3().fromArray(shifts, 3 * world);
      box.expandByPoint(low.clone().add(shift)).expandByPoint(high.clone().add(shift));
    }
    return box.isEmpty() ? box.set(low, high) : box;
  }

  /** Takes up what is chosen. */
  apply(options: ViewOptions): void {
    this.options = options;
    this.lamps.shadows = options.shadows;
    this.trails.choice = options.trails;
    this.dress();
  }

  /** Makes all parts anew, in their present skins. */
  dress(): void {
    this.batches.dispose();
    this.group.remove(this.batches);
    const parts = this.maker.make(this.wardrobe, this.options);
    this.batches = new Batches(parts);
    this.group.add(this.batches);
    this.materials.keep(parts);
    this.repaint();
  }

  /** Skins have other colours, and nothing else. */
  repaint(): void {
    this.painted = 0;
  }

  /** Draws what is at an instant; what is picked in a box, where that is wanted. */
  draw(frame: Frame, picked: Picked | null, boxed: boolean): void {
    this.gauge(frame);
    this.poses.update(frame);
    this.refine();
    this.batches.move(this.poses);
    this.lamps.move(this.poses);
    if (this.gauges.size || this.painted !== this.poses.worlds) this.paint();
    const moment = { scene: this.scene, frame, poses: this.poses, measures: this.measures, picked };
    for (const [overlay, wanted] of this.overlays) {
      overlay.object.visible = wanted(this.options);
      if (overlay.object.visible) overlay.draw(moment);
    }
    this.box.visible = boxed && picked !== null && picked.body >= 0 && picked.row < this.poses.worlds;
    if (picked && this.box.visible) this.box.draw(this.poses, picked, this.maker.bodyBox(picked.body));
  }

  hit(ray: Raycaster): Hit | null {
    const found = this.batches.hit(ray);
    if (!found) return null;
    const part = found.part as ShapePart;
    const point = this.group.worldToLocal((found.hit as Intersection).point.clone());
    return { row: found.world, body: part.body, shape: part.shape, point };
  }

  /** A body's map into the scene's axes. */
  bodyMatrix({ row, body }: Picked): Matrix4 {
    const [map, at] = this.poses.of(Math.min(row, this.poses.worlds - 1), body);
    return new Matrix4().fromArray(map, at);
  }

  dispose(): void {
    this.batches.dispose();
    for (const [overlay] of this.overlays) overlay.dispose();
    this.box.dispose();
    this.lamps.dispose();
    this.forms.dispose();
    this.materials.dispose();
    this.group.removeFromParent();
  }

  /** Makes round forms as fine as the number of shapes allows. */
  private refine(): void {
    const wanted = sides(this.scene.shapes.length * this.poses.worlds);
    if (wanted === this.forms.sides) return;
    this.forms.dispose();
    this.forms = new Forms(wanted);
    this.maker = new PartMaker(this.scene, this.measures, this.forms, this.materials);
    this.dress();
  }

  /** Reads the gauges that skins follow now. */
  private gauge(frame: Frame): void {
    const { gauges } = this.wardrobe;
    for (const name of this.gauges.keys()) if (!gauges.has(name)) this.gauges.delete(name);
    for (const name of gauges) {
      const gauge = this.gauges.get(name) ?? new Gauge(this.scene, name);
      this.gauges.set(name, gauge);
      gauge.update(frame);
    }
  }

  private paint(): void {
    this.painted = this.poses.worlds;
    this.batches.paint((part, world) => this.colorOf(part, world));
  }

  private colorOf(part: Part, world: number): Color {
    const skin = this.wardrobe.of(part.body);
    switch (skin.kind) {
      case "picture":
      case "model":
        return WHITE;
      case "color":
        return skin.color;
      case "replica":
        return replicaColor(world);
      case "gauge":
        return this.gauges.get(skin.gauge)?.color(world, part.body, this.color) ?? WHITE;
      case "plain": {
        const shape = this.scene.shapes[(part as ShapePart).shape];
        const [r, g, b] = shape?.color ?? this.scene.bodies[part.body]?.color ?? WORLD_COLOR;
        return this.color.setRGB(r, g, b, "srgb");
      }
    }
  }
}
