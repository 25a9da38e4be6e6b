import {
  BackSide,
  BufferAttribute,
  Color,
  DirectionalLight,
  Group,
  Mesh,
  MeshBasicMaterial,
  type PerspectiveCamera,
  type Scene,
  SphereGeometry,
  Vector3,
} from "three";
import type { Theme } from "../theme";
import { type Sky, skyLight } from "./sky_light";

const BACKGROUND: Record<Theme, Sky> = {
  light: sky("#dfe1e3", "#eef0f1", "#cfdce8"),
  dark: sky("#15181b", "#22272c", "#12161b"),
};
/** What light falls from the sky; the same in both themes, dimmer in the dark one. */
const LIGHT = sky("#9a9792", "#ffffff", "#d3e0f0");
const STRENGTH: Record<Theme, { sky: number; sun: number }> = {
  light: { sky: 0.75, sun: 2.4 },
  dark: { sky: 0.55, sun: 2.1 },
};
/** Towards the sun, and its colour, where a model names none. */
const SUN = new Vector3(0.75, 1.1, 0.25).normalize();
const SUNLIGHT = new Color("#fff4e6");
/** How bright the brightest part of it is in linear light. */
const BRIGHT = 0.72;
const SHADOW_PIXELS = 2048;

/** Sky, sky light and a sun with shadows. */
export class Surroundings extends Group {
  private readonly sun = new DirectionalLight(SUNLIGHT);
  private readonly toSun = SUN.clone();
  private readonly dome = new Mesh(
    new SphereGeometry(1, 24, 32),
    new MeshBasicMaterial({
      side: BackSide,
      vertexColors: true,
      toneMapped: false,
      depthWrite: false,
      depthTest: false,
    }),
  );
  private shadowRadius = 0;

  constructor() {
    super();
    this.dome.renderOrder = -1000;
    this.dome.frustumCulled = false;
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(SHADOW_PIXELS, SHADOW_PIXELS);
    this.sun.shadow.radius = 3;
    this.add(this.dome, this.sun, this.sun.target);
  }

  /** Lights a scene by the sky. */
  light(scene: Scene): void {
    scene.environment = skyLight(LIGHT);
  }

  setTheme(theme: Theme, scene: Scene): void {
    paintSky(this.dome.geometry, BACKGROUND[theme]);
    scene.environmentIntensity = STRENGTH[theme].sky;
    this.sun.intensity = STRENGTH[theme].sun;
  }

  /** The sun of a model, in the screen's axes; null is the page's own. */
  shine(sun: { to: Vector3; color: Color } | null): void {
    this.toSun.copy(sun?.to ?? SUN);
    this.sun.color.copy(SUNLIGHT);
    if (sun) this.sun.color.copy(sun.color).multiplyScalar(1 / BRIGHT);
    this.sun.visible = this.sun.color.r + this.sun.color.g + this.sun.color.b > 0;
  }

  set shadows(on: boolean) {
    this.sun.castShadow = on;
  }

  /** Keeps the sky about the eye, and shadows about what it looks at, sharp over `radius` [m]. */
  follow(camera: PerspectiveCamera, target: Vector3, radius: number): void {
    this.surround(camera);
    // Steps of a quarter octave, lest shadows swim as one zooms.
    const reach = 2 ** (Math.ceil(4 * Math.log2(radius)) / 4);
    if (reach !== this.shadowRadius) this.cover(reach);
    this.sun.target.position.copy(target);
    this.sun.position
      .copy(this.toSun)
      .multiplyScalar(4 * reach)
      .add(target);
  }

  /** Brings the sky about the eye, where the camera cuts nothing of it off. */
  surround({ position, near, far }: PerspectiveCamera): void {
    this.dome.position.copy(position);
    this.dome.scale.setScalar(Math.sqrt(near * far));
  }

  private cover(reach: number): void {
    this.shadowRadius = reach;
    const camera = this.sun.shadow.camera;
    camera.left = camera.bottom = -reach;
    camera.right = camera.top = reach;
    camera.near = 0.5 * reach;
    camera.far = 8 * reach;
    camera.updateProjectionMatrix();
    this.sun.shadow.normalBias = (6 * reach) / SHADOW_PIXELS;
    this.sun.shadow.bias = -0.0002;
  }
}

function paintSky(geometry: SphereGeometry, sky: Sky): void {
  const position = geometry.getAttribute("position");
  const colors = new BufferAttribute(new Float32Array(3 * position.count), 3);
  const { radius } = geometry.parameters;
  for (let i = 0; i < position.count; i++) {
    const { r, g, b } = sky(position.getY(i) / radius);
    colors.setXYZ(i, r, g, b);
  }
  geometry.setAttribute("color", colors);
}

/** A sky of these colours, from below over the horizon to above. */
function sky(...names: [ground: string, horizon: string, zenith: string]): Sky {
  const [ground, horizon, zenith] = names.map((name) => new Color(name));
  return (height) => horizon.clone().lerp(height < 0 ? ground : zenith, Math.sqrt(Math.abs(height)));
}
