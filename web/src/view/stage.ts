import {
  Color,
  Group,
  NeutralToneMapping,
  PCFShadowMap,
  type PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";
import type { Scene as Model } from "../protocol";
import type { Theme } from "../theme";
import { Ground } from "./ground";
import type { Sun } from "./lamps";
import { Surroundings } from "./surroundings";

/** A second picture in a corner, as a share of the first one's width; the style sheet has a frame for it. */
const INSET = 0.28;
/** Room around it [CSS pixels]. */
const MARGIN = 12;

/** The browser draws no WebGL. */
export class NoWebGL extends Error {}

/** The renderer, and what is there in every scene: sky, sun, ground. */
export class Stage {
  readonly renderer: WebGLRenderer;
  readonly ground = new Ground();
  /** Everything of the scene, in the scene's axes. */
  readonly root = new Group();
  private readonly scene = new Scene();
  private readonly surroundings: Surroundings;

  constructor(readonly canvas: HTMLCanvasElement) {
    try {
      this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
    } catch (error) {
      throw new NoWebGL((error as Error).message);
    }
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.surroundings = new Surroundings();
    this.surroundings.light(this.scene);
    this.scene.add(this.surroundings, this.ground, this.root);
  }

  set theme(theme: Theme) {
    this.surroundings.setTheme(theme, this.scene);
    this.ground.setTheme(theme);
  }

  set shadows(on: boolean) {
    this.surroundings.shadows = on;
  }

  /** The sun of a model, in the scene's axes; null is the page's own. To be set after {@link up}. */
  set sun(sun: Sun | null) {
    const turned = sun && new Vector3(...sun.to).applyQuaternion(this.root.quaternion).normalize();
    this.surroundings.shine(sun && turned && { to: turned, color: new Color(...sun.color) });
  }

  /** Turns what is drawn so that the scene's up is the screen's. */
  set up(up: Model["up"]) {
    this.root.rotation.x = up === "z" ? -Math.PI / 2 : 0;
    this.root.updateMatrixWorld(true);
  }

  /** Makes the picture as large and as fine as its place. Returns whether it changed. */
  resize(camera: PerspectiveCamera): boolean {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    // The window may have gone to another screen.
    const ratio = Math.min(devicePixelRatio, 2);
    const [w, h] = [Math.floor(width * ratio), Math.floor(height * ratio)];
    if ((this.canvas.width === w && this.canvas.height === h) || !width || !height) return false;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    return true;
  }

  /** Draws; shadows are sharp within `radius` [m] of the focus. */
  render(camera: PerspectiveCamera, focus: Vector3, radius: number): void {
    this.surroundings.follow(camera, focus, radius);
    this.renderer.render(this.scene, camera);
  }

  /** Draws what another camera sees into the corner. */
  renderInset(camera: PerspectiveCamera): void {
    const { renderer, canvas } = this;
    const width = Math.round(INSET * canvas.clientWidth);
    const height = Math.round(0.75 * width);
    const x = MARGIN;
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    renderer.autoClear = false;
    renderer.setScissorTest(true);
    renderer.setViewport(x, MARGIN, width, height);
    renderer.setScissor(x, MARGIN, width, height);
    renderer.clear();
    // Shadows are those of the first picture.
    renderer.shadowMap.autoUpdate = false;
    this.surroundings.surround(camera);
    renderer.render(this.scene, camera);
    renderer.shadowMap.autoUpdate = true;
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, canvas.clientWidth, canvas.clientHeight);
    renderer.autoClear = true;
  }
}
