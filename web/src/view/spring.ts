import {
  BufferAttribute,
  BufferGeometry,
  Group,
  Line,
  LineBasicMaterial,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  SphereGeometry,
  Vector3,
} from "three";
import { IN_FRONT } from "./overlays/overlay";

const COLOR = "#ff8a3d";
const [TURNS, POINTS] = [10, 161];

/** A coil from a body to the pointer that draws it. */
export class Spring extends Group {
  private readonly coil: Line<BufferGeometry, LineBasicMaterial>;
  private readonly hand: Mesh;
  private readonly hook: Mesh;

  constructor() {
    super();
    const geometry = new BufferGeometry().setAttribute(
      "position",
      new BufferAttribute(new Float32Array(3 * POINTS), 3),
    );
    this.coil = new Line(
      geometry,
      new LineBasicMaterial({ color: COLOR, depthTest: false, transparent: true }),
    );
    const ball = new SphereGeometry(1, 16, 12);
    const material = new MeshBasicMaterial({ color: COLOR, depthTest: false, transparent: true });
    this.hand = new Mesh(ball, material);
    this.hook = new Mesh(ball, material);
    for (const object of [this.coil, this.hand, this.hook]) {
      object.frustumCulled = false;
      object.renderOrder = IN_FRONT + 2;
      this.add(object);
    }
    this.visible = false;
  }

  /** Stretches it between two points, `size` [m] wide. */
  stretch(from: Vector3, to: Vector3, size: number): void {
    this.visible = true;
    const axis = to.clone().sub(from);
    const length = axis.length();
    const frame = new Matrix4().lookAt(
      from,
      to,
      Math.abs(axis.y) > 0.9 * length ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0),
    );
    const position = this.coil.geometry.getAttribute("position");
    const point = new Vector3();
    for (let i = 0; i < POINTS; i++) {
      const share = i / (POINTS - 1);
      // Straight at its ends.
      const width = 0.5 * size * Math.min(1, 8 * Math.min(share, 1 - share));
      const angle = 2 * Math.PI * TURNS * share;
      point
        .set(width * Math.cos(angle), width * Math.sin(angle), -share * length)
        .applyMatrix4(frame)
        .add(from);
      position.setXYZ(i, point.x, point.y, point.z);
    }
    position.needsUpdate = true;
    this.hook.position.copy(from);
    this.hand.position.copy(to);
    this.hook.scale.setScalar(0.25 * size);
    this.hand.scale.setScalar(0.35 * size);
  }
}
