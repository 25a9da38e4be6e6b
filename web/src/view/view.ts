import {
  Box3,
  Matrix4,
  PerspectiveCamera,
  Plane,
  Quaternion,
  Raycaster,
  Sphere,
  Vector2,
  Vector3,
} from "three";
import { Emitter } from "../emitter";
import type { Frame } from "../frame";
import type { Camera, Scene } from "../protocol";
import type { Triple } from "../schema";
import type { Session } from "../session";
import type { Theme } from "../theme";
import { CameraRig, type Carrier, type Mount, type Viewpoint } from "./camera_rig";
import { sunOf } from "./lamps";
import { VIEW_OPTIONS, type ViewOptions } from "./options";
import type { Picked } from "./overlays/overlay";
import { type Hit, SceneView } from "./scene_view";
import { sameParts, Wardrobe, type Worn } from "./skins/skin";
import { Spring } from "./spring";
import { Stage } from "./stage";

export interface ViewEvents {
  /** What carries the camera. */
  carried: Carrier | null;
  /** Bodies have changed their skins. */
  dressed: Wardrobe;
}

/** The picture of the session: which scene, from where, with what drawn. */
export class View extends Emitter<ViewEvents> {
  readonly stage: Stage;
  readonly rig = new CameraRig();
  readonly wardrobe = new Wardrobe();
  readonly spring = new Spring();
  private readonly insetCamera = new PerspectiveCamera();
  private shown: SceneView | null = null;
  private frame: Frame | null = null;
  private chosen: ViewOptions = { ...VIEW_OPTIONS };
  private picked: Picked | null = null;
  private carrier: Picked = { row: 0, body: 0 };
  private stale = true;
  /** Worlds that the ground is laid for; 0 where it is yet to be. */
  private laidFor = 0;
  /** Whether the scene is to be seen whole, once its next frame is here. */
  private framing = true;

  constructor(
    canvas: HTMLCanvasElement,
    private readonly session: Session,
  ) {
    super();
    this.stage = new Stage(canvas);
    this.stage.root.add(this.spring);
    session.on("scene", (scene) => this.setScene(scene));
    session.on("frame", (frame) => this.setFrame(frame));
  }

  get current(): SceneView | null {
    return this.shown;
  }

  get options(): Readonly<ViewOptions> {
    return this.chosen;
  }

  set options(options: ViewOptions) {
    this.chosen = { ...options };
    this.stage.shadows = options.shadows;
    this.stage.ground.grid = options.grid;
    this.shown?.apply(this.chosen);
    this.invalidate();
  }

  set theme(theme: Theme) {
    this.stage.theme = theme;
    this.invalidate();
  }

  set pick(picked: Picked | null) {
    this.picked = picked;
    this.invalidate();
  }

  /** It is to be drawn anew. */
  invalidate(): void {
    this.stale = true;
  }

  /** Has bodies wear skins. */
  wear(worn: readonly Worn[]): void {
    const all = this.shown?.scene.bodies.map((_, row) => row) ?? [];
    let same = true;
    for (const { bodies, skin } of worn) {
      same &&= (bodies ?? all).every((body) => sameParts(this.wardrobe.of(body), skin));
      if (bodies === null) this.wardrobe.dressAll(skin);
      else for (const body of bodies) this.wardrobe.dress(body, skin);
    }
    if (same) this.shown?.repaint();
    else this.shown?.dress();
    this.invalidate();
    this.emit("dressed", this.wardrobe);
  }

  /** Sees the scene from a viewpoint. */
  lookFrom(viewpoint: Viewpoint): void {
    this.framing = false;
    this.rig.go(viewpoint, true);
    this.invalidate();
  }

  /** The viewpoint of a camera of the scene, upright; null where there is nothing to be seen yet. */
  viewpointOf(camera: Camera): Viewpoint | null {
    const { shown, frame } = this;
    if (!shown || !frame) return null;
    const place = this.placeOf(camera, shown);
    const eye = new Vector3().setFromMatrixPosition(place);
    const back = new Vector3().setFromMatrixColumn(place, 2);
    const middle = shown.bounds.applyMatrix4(this.stage.root.matrixWorld).getCenter(new Vector3());
    const distance = Math.max(eye.distanceTo(middle), 1e-3);
    return {
      target: eye.addScaledVector(back, -distance).toArray(),
      yaw: Math.atan2(back.x, back.z),
      pitch: Math.asin(Math.min(1, Math.max(-1, back.y))),
      distance,
    };
  }

  /** Sees the whole scene once its next frame is here. */
  frameNext(): void {
    this.framing = true;
  }

  /** Sees the whole scene, or the picked body. */
  frameScene(atOnce = false): void {
    if (!this.shown) return;
    const box = this.picked ? this.boxOf(this.picked, this.shown) : this.shown.bounds;
    this.rig.frame(box.applyMatrix4(this.stage.root.matrixWorld), atOnce);
    this.invalidate();
  }

  /** Mounts the camera on a body. */
  mount(mount: Mount, carrier?: Picked): void {
    if (carrier) this.carrier = carrier;
    // Robots of files with z up look along x; elsewhere bodies look as cameras do, along −z.
    this.rig.setMount(mount, this.shown?.scene.up === "z" ? -Math.PI / 2 : 0);
    this.invalidate();
    this.emit("carried", this.carried);
  }

  /** What carries the camera. */
  get carried(): Carrier | null {
    const { rig, carrier, session } = this;
    if (rig.mount === "free") return null;
    const world = session.shown[Math.min(carrier.row, session.shown.length - 1)] ?? null;
    return { mount: rig.mount, body: carrier.body, world, gaze: rig.mount === "ride" ? rig.gaze : null };
  }

  /** Is carried as it was, by a body of a replica that is shown; else by none. */
  set carried(carried: Carrier | null) {
    if (!carried || !this.shown?.scene.bodies[carried.body]) {
      this.mount("free");
      return;
    }
    const row = Math.max(0, this.session.shown.indexOf(carried.world ?? -1));
    this.mount(carried.mount, { row, body: carried.body });
    if (carried.gaze) this.rig.gaze = carried.gaze;
  }

  /** What is at a point of the canvas [CSS pixels]. */
  hit(x: number, y: number): Hit | null {
    return this.shown?.hit(this.ray(x, y)) ?? null;
  }

  /** The direction in which the eye looks at a point of the canvas, in the scene's axes. */
  direction(x: number, y: number): Triple {
    return this.intoScene(this.ray(x, y).ray.direction).toArray();
  }

  /** Where the pointer is in the plane through `point` that faces the viewer; all in the scene's axes. */
  across(x: number, y: number, point: Vector3): Vector3 {
    const { root } = this.stage;
    const facing = this.rig.camera.getWorldDirection(new Vector3());
    const plane = new Plane().setFromNormalAndCoplanarPoint(facing, root.localToWorld(point.clone()));
    const met = this.ray(x, y).ray.intersectPlane(plane, new Vector3());
    return met ? root.worldToLocal(met) : point.clone();
  }

  /** A point moved right, up and towards the viewer, in heights of the view where it is; in the scene's axes. */
  moved(point: Vector3, by: Vector3): Vector3 {
    const { root } = this.stage;
    const { camera } = this.rig;
    const place = root.localToWorld(point.clone());
    const depth = place.clone().applyMatrix4(camera.matrixWorldInverse).length();
    const height = 2 * depth * Math.tan((Math.PI / 360) * camera.fov);
    const move = by.clone().multiplyScalar(height).applyQuaternion(camera.quaternion);
    return root.worldToLocal(place.add(move));
  }

  /**
   * Draws if anything changed, after so many seconds since the last call. Returns whether the frame given
   * last is on the screen for the first time.
   */
  draw(seconds: number): boolean {
    const { rig, stage, shown, frame } = this;
    if (stage.resize(rig.camera)) this.stale = true;
    const fresh = this.stale;
    if (fresh && shown && frame) {
      const { picked, carrier } = this;
      const own = rig.mount === "ride" && picked?.row === carrier.row && picked.body === carrier.body;
      shown.draw(frame, picked, !own);
      this.settle(shown);
    }
    const radius = shown ? this.radius(shown) : 1;
    const moving = rig.update(seconds, this.anchor(), radius);
    if (!fresh && !moving) return false;
    this.render(radius);
    this.stale = false;
    return fresh && frame !== null;
  }

  /** Draws at once, for a picture of what is on the screen. */
  render(radius = this.shown ? this.radius(this.shown) : 1): void {
    const { stage, rig } = this;
    const reach = Math.min(radius, 2 * rig.camera.position.distanceTo(rig.focus) + 0.1 * radius);
    stage.render(rig.camera, rig.focus, rig.mount === "ride" ? radius : reach);
    if (this.placeInset()) stage.renderInset(this.insetCamera);
  }

  /** Shows another scene; its first frame is seen whole, unless a viewpoint is given before. */
  private setScene(scene: Scene): void {
    // What one body of another model wears is nothing for those of this.
    if (scene.name !== this.shown?.scene.name) this.wardrobe.undress();
    this.shown?.dispose();
    this.frame = null;
    this.picked = null;
    this.shown = new SceneView(scene, this.wardrobe, this.chosen);
    this.stage.up = scene.up;
    this.stage.sun = sunOf(scene);
    this.stage.root.add(this.shown.group);
    this.mount("free");
    this.spring.visible = false;
    this.laidFor = 0;
    this.framing = true;
    this.invalidate();
  }

  private setFrame(frame: Frame): void {
    this.frame = frame;
    this.invalidate();
  }

  private settle(shown: SceneView): void {
    if (this.laidFor !== shown.poses.worlds) this.layGround(shown);
    if (this.framing) this.frameScene(this.laidFor === 0);
    this.laidFor = shown.poses.worlds;
    this.framing = false;
  }

  private layGround(shown: SceneView): void {
    const up = shown.scene.up === "y" ? 1 : 2;
    // Without a floor of its own, below all that moves.
    const height = shown.floor ?? shown.bounds.min.getComponent(up) - 0.02 * shown.measures.world;
    this.stage.ground.position.y = height;
    this.stage.ground.fit(this.radius(shown), shown.measures.world, shown.floor !== null);
  }

  private radius(shown: SceneView): number {
    return Math.max(shown.bounds.getBoundingSphere(new Sphere()).radius, 1e-3);
  }

  private boxOf(picked: Picked, shown: SceneView): Box3 {
    const size = 4 * (shown.measures.bodies[picked.body] ?? shown.measures.world);
    const center = new Vector3().setFromMatrixPosition(shown.bodyMatrix(picked));
    return new Box3().setFromCenterAndSize(center, new Vector3(size, size, size));
  }

  private ray(x: number, y: number): Raycaster {
    const { clientWidth: width, clientHeight: height } = this.stage.canvas;
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2((2 * x) / width - 1, 1 - (2 * y) / height), this.rig.camera);
    return ray;
  }

  private intoScene(direction: Vector3): Vector3 {
    return direction.clone().applyQuaternion(this.stage.root.quaternion.clone().invert());
  }

  /** Where the body is that carries the camera: its eye, and how far it has turned, in the screen's world. */
  private anchor(): Matrix4 | null {
    const { shown, carrier, rig } = this;
    if (!shown || rig.mount === "free" || !shown.scene.bodies[carrier.body]) return null;
    const { root } = this.stage;
    const matrix = shown.bodyMatrix(carrier);
    const turn = new Quaternion().setFromRotationMatrix(matrix);
    turn.premultiply(root.quaternion).multiply(root.quaternion.clone().invert());
    const middle = new Vector3(...shown.scene.bodies[carrier.body].inertial.position);
    const eye = root.localToWorld(middle.applyMatrix4(matrix));
    if (rig.mount === "ride") {
      eye.add(new Vector3(0, 0.5 * shown.measures.bodies[carrier.body], 0).applyQuaternion(turn));
    }
    return new Matrix4().compose(eye, turn, new Vector3(1, 1, 1));
  }

  /** Where a camera of the scene is, in the screen's world. */
  private placeOf(camera: Camera, { poses }: SceneView): Matrix4 {
    const row = Math.min(this.picked?.row ?? 0, poses.worlds - 1);
    return poses.mounted(row, camera).premultiply(this.stage.root.matrixWorld);
  }

  /** Puts the inset's camera where the scene's is. Returns whether there is one to show. */
  private placeInset(): boolean {
    const { shown } = this;
    const camera = shown?.scene.cameras[this.chosen.inset];
    if (!shown || !camera || !this.frame) return false;
    const place = this.placeOf(camera, shown);
    place.decompose(this.insetCamera.position, this.insetCamera.quaternion, this.insetCamera.scale);
    this.insetCamera.fov = (180 / Math.PI) * camera.field_of_view;
    this.insetCamera.near = 0.01 * shown.measures.body;
    this.insetCamera.far = 100 * shown.measures.world;
    this.insetCamera.updateMatrixWorld();
    return true;
  }
}
