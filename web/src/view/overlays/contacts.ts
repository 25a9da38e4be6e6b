import {
  BufferAttribute,
  BufferGeometry,
  ConeGeometry,
  CylinderGeometry,
  DynamicDrawUsage,
  Group,
  Matrix4,
  MeshBasicMaterial,
  Points,
  PointsMaterial,
  Quaternion,
  Vector3,
} from "three";
import { CONTACT } from "../../frame";
import type { Scene } from "../../protocol";
import { Instances } from "../instances";
import { IN_FRONT, type Moment, type Overlay } from "./overlay";

const POINT = "#ff8a3d";
const ARROW = "#e5484d";
const UP = new Vector3(0, 1, 0);
const GRAVITY = 9.81;

/** Points where shapes touch. */
export class ContactPoints implements Overlay {
  readonly object = new Points(
    new BufferGeometry(),
    new PointsMaterial({
      color: POINT,
      size: 7,
      sizeAttenuation: false,
      depthTest: false,
      transparent: true,
    }),
  );
  private places = new Float32Array(0);

  constructor() {
    this.object.frustumCulled = false;
    this.object.renderOrder = IN_FRONT + 1;
    this.object.material.onBeforeCompile = (shader) => {
      shader.fragmentShader = shader.fragmentShader.replace(
        "#include <map_particle_fragment>",
        "if (length(gl_PointCoord - 0.5) > 0.5) discard;",
      );
    };
  }

  draw({ frame: { contacts }, poses }: Moment): void {
    const count = contacts.length / CONTACT;
    if (3 * count > this.places.length) this.makeRoom(2 * count);
    for (let i = 0; i < count; i++) {
      for (let axis = 0; axis < 3; axis++) {
        this.places[3 * i + axis] =
          contacts[CONTACT * i + 1 + axis] + poses.shifts[3 * contacts[CONTACT * i] + axis];
      }
    }
    this.object.geometry.setDrawRange(0, count);
    const attribute = this.object.geometry.getAttribute("position");
    if (attribute) attribute.needsUpdate = true;
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }

  private makeRoom(count: number): void {
    this.places = new Float32Array(3 * count);
    this.object.geometry.dispose();
    this.object.geometry = new BufferGeometry();
    this.object.geometry.setAttribute(
      "position",
      new BufferAttribute(this.places, 3).setUsage(DynamicDrawUsage),
    );
  }
}

/** Weight of an ordinary tree [N]: of a body that no other carries, and all that it carries. */
export function ordinaryWeight({ bodies, joints }: Scene): number {
  const masses = new Map<number, number>();
  for (let row = 0; row < bodies.length; row++) {
    const { dynamic, mass } = bodies[row];
    if (!dynamic) continue;
    let root = row;
    let carrier = joints[bodies[root].joint]?.parent ?? -1;
    while (carrier >= 0 && bodies[carrier].dynamic) {
      root = carrier;
      carrier = joints[bodies[root].joint]?.parent ?? -1;
    }
    masses.set(root, (masses.get(root) ?? 0) + mass);
  }
  const sorted = [...masses.values()].sort((a, b) => a - b);
  return GRAVITY * (sorted[sorted.length >> 1] ?? 1) || GRAVITY;
}

/** Arrows of the forces at contacts. One as long as an ordinary body is wide is an ordinary tree's weight. */
export class ContactForces implements Overlay {
  readonly object = new Group();
  private readonly shaft = new CylinderGeometry(1, 1, 1, 10).translate(0, 0.5, 0);
  private readonly tip = new ConeGeometry(2.2, 1, 14).translate(0, 0.5, 0);
  private readonly material = new MeshBasicMaterial({ color: ARROW, toneMapped: false });
  private readonly shafts = new Instances(this.shaft, this.material, false);
  private readonly tips = new Instances(this.tip, this.material, false);
  private readonly weight: number;

  constructor(scene: Scene) {
    this.object.add(this.shafts, this.tips);
    this.weight = ordinaryWeight(scene);
  }

  draw({ frame: { contacts }, poses, measures }: Moment): void {
    const count = contacts.length / CONTACT;
    const [shafts, tips] = [this.shafts.reserve(count), this.tips.reserve(count)];
    const [at, force, turn, size, matrix] = [
      new Vector3(),
      new Vector3(),
      new Quaternion(),
      new Vector3(),
      new Matrix4(),
    ];
    const width = 0.035 * measures.body;
    for (let i = 0; i < count; i++) {
      const c = CONTACT * i;
      at.fromArray(poses.shifts, 3 * contacts[c]);
      at.set(at.x + contacts[c + 1], at.y + contacts[c + 2], at.z + contacts[c + 3]);
      force.fromArray(contacts, c + 4);
      const length = Math.min((2 * measures.body * force.length()) / this.weight, measures.world);
      turn.setFromUnitVectors(UP, force.normalize());
      const thick = Math.min(width, 0.1 * length);
      const head = Math.min(0.4 * length, 6 * thick);
      matrix.compose(at, turn, size.set(thick, length - head, thick)).toArray(shafts, 16 * i);
      at.addScaledVector(force, length - head);
      matrix.compose(at, turn, size.set(thick, head, thick)).toArray(tips, 16 * i);
    }
    this.shafts.moved();
    this.tips.moved();
  }

  dispose(): void {
    for (const thing of [this.shafts, this.tips, this.shaft, this.tip, this.material]) thing.dispose();
  }
}
