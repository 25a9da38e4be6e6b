import { DataTexture, MeshBasicMaterial, NearestFilter, SphereGeometry } from "three";
import type { Scene } from "../../protocol";
import { multiply, placed } from "../affine";
import { Instances } from "../instances";
import type { Measures } from "../layout";
import { IN_FRONT, type Moment, type Overlay } from "./overlay";

/** The centre of mass of every body that moves, as draughtsmen mark it: a ball in quarters. */
export class Masses implements Overlay {
  readonly object: Instances;
  private readonly geometry = new SphereGeometry(1, 24, 12);
  private readonly material = new MeshBasicMaterial({ map: quarters(), depthTest: false, transparent: true });
  private readonly places: Float32Array[];

  constructor(
    private readonly scene: Scene,
    measures: Measures,
  ) {
    this.object = new Instances(this.geometry, this.material, false);
    this.object.mesh.renderOrder = this.object.renderOrder = IN_FRONT;
    this.places = scene.bodies.map(({ inertial }, body) => {
      const size = 0.16 * Math.max(measures.bodies[body], 0.5 * measures.body);
      return placed(inertial, [size, size, size]);
    });
  }

  draw({ poses }: Moment): void {
    const bodies = this.scene.bodies.map((_, body) => body).filter((body) => this.scene.bodies[body].dynamic);
    const matrices = this.object.reserve(bodies.length * poses.worlds);
    let out = 0;
    for (let world = 0; world < poses.worlds; world++) {
      for (const body of bodies) {
        const [map, m] = poses.of(world, body);
        multiply(matrices, out, map, m, this.places[body], 0);
        out += 16;
      }
    }
    this.object.moved();
  }

  dispose(): void {
    this.object.dispose();
    this.geometry.dispose();
    this.material.map?.dispose();
    this.material.dispose();
  }
}

function quarters(): DataTexture {
  const [ink, paper] = [
    [25, 28, 32, 255],
    [255, 214, 64, 255],
  ];
  const texture = new DataTexture(
    new Uint8Array([ink, paper, ink, paper, paper, ink, paper, ink].flat()),
    4,
    2,
  );
  texture.magFilter = texture.minFilter = NearestFilter;
  texture.colorSpace = "srgb";
  texture.needsUpdate = true;
  return texture;
}
