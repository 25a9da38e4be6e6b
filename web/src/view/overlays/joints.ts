import { Color, Quaternion, Vector3 } from "three";
import type { Dof, Joint } from "../../protocol";
import { multiply, placed } from "../affine";
import { Lines } from "./lines";
import type { Moment, Overlay } from "./overlay";

const AXIS = new Color("#8e6cef");
const LIMIT = new Color("#e0a100");
const NOW = new Color("#ff5c8a");
/** Least angle between two lines of an arc [rad]. */
const ARC = Math.PI / 24;

type Point = [number, number, number];

/** A dof's lines in the joint's frame, of unit size. */
interface Drawn {
  dof: Dof;
  axis: Vector3;
  point: Vector3;
  /** A direction across the axis: where a hinge's hand points at 0. */
  across: Vector3;
}

/**
 * Axes of joints and, where they have limits, their range with a hand where the joint is. Of the first
 * world shown, which is the one whose coordinates frames tell.
 */
export class JointAxes implements Overlay {
  readonly object = new Lines();
  private readonly drawn = new Map<Joint, Drawn[]>();
  private readonly map = new Float32Array(16);

  draw({ scene, frame, poses, measures }: Moment): void {
    this.object.begin();
    for (const joint of poses.worlds ? scene.joints : []) {
      if (joint.kind === "free") continue;
      const size = 0.9 * Math.max(measures.bodies[joint.child] ?? 0, 0.6 * measures.body);
      const [parent, p] = poses.of(0, joint.parent);
      multiply(this.map, 0, parent, p, placed(joint.parent_frame), 0);
      this.dofs(joint).forEach((dof, row) => {
        // One coordinate a degree of freedom, or else (balls, free joints) none that is an angle.
        const told = joint.coordinate >= 0 && joint.coordinates === joint.dofs.length;
        const value = told ? frame.coordinates[joint.coordinate + row] : undefined;
        this.drawDof(dof, size, value);
      });
    }
    this.object.end();
  }

  dispose(): void {
    this.object.dispose();
  }

  private dofs(joint: Joint): Drawn[] {
    let drawn = this.drawn.get(joint);
    if (!drawn) {
      drawn = joint.dofs.map((dof) => {
        const axis = new Vector3(...dof.axis).normalize();
        const least = axis.toArray().map(Math.abs);
        const other = new Vector3().setComponent(least.indexOf(Math.min(...least)), 1);
        return { dof, axis, point: new Vector3(...dof.point), across: other.cross(axis).normalize() };
      });
      this.drawn.set(joint, drawn);
    }
    return drawn;
  }

  private drawDof(drawn: Drawn, size: number, value: number | undefined): void {
    const { dof, axis, point } = drawn;
    const along = (distance: number) => point.clone().addScaledVector(axis, distance).toArray();
    const length = dof.angular ? size : 0.5 * size;
    this.line(along(-length), along(length), AXIS);
    if (!dof.limit) return;
    if (dof.angular) this.drawArc(drawn, dof.limit, 0.6 * size, value);
    else {
      this.line(along(dof.limit[0]), along(dof.limit[1]), LIMIT);
      for (const end of dof.limit) this.tick(drawn, end, 0.15 * size, LIMIT);
      if (value !== undefined) this.tick(drawn, value, 0.3 * size, NOW);
    }
  }

  private drawArc(
    place: Drawn,
    [low, high]: [number, number],
    radius: number,
    value: number | undefined,
  ): void {
    const { axis, point, across } = place;
    const at = (angle: number): Point => {
      const turn = new Quaternion().setFromAxisAngle(axis, angle);
      return across.clone().applyQuaternion(turn).multiplyScalar(radius).add(point).toArray();
    };
    const middle = point.toArray();
    // Of a range of many turns a circle.
    const drawn = Math.min(high - low, 2 * Math.PI);
    const steps = Math.max(1, Math.ceil(drawn / ARC));
    for (let i = 0; i < steps; i++) {
      const [from, to] = [low + (drawn * i) / steps, low + (drawn * (i + 1)) / steps];
      this.line(at(from), at(to), LIMIT);
    }
    this.line(middle, at(low), LIMIT);
    this.line(middle, at(high), LIMIT);
    if (value !== undefined) this.line(middle, at(value), NOW);
  }

  private tick({ axis, point, across }: Drawn, where: number, half: number, color: Color): void {
    const middle = point.clone().addScaledVector(axis, where);
    const end = (sign: number) =>
      middle
        .clone()
        .addScaledVector(across, sign * half)
        .toArray();
    this.line(end(-1), end(1), color);
  }

  private line(a: Point, b: Point, color: Color): void {
    this.object.segment(this.map, 0, a, b, color);
  }
}
