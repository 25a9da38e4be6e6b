import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  CapsuleGeometry,
  ConeGeometry,
  CylinderGeometry,
  PlaneGeometry,
  SphereGeometry,
} from "three";
import type { Geometry } from "../protocol";

/** Triangles of a form, to be scaled along its axes. */
export interface Form {
  geometry: BufferGeometry;
  scale: [number, number, number];
}

/** Sides of round forms where so many are drawn: fewer where there are many, and each is small. */
export function sides(shapes: number): number {
  return shapes <= 200 ? 32 : shapes <= 800 ? 20 : 12;
}

/** Triangles of forms; forms that differ by a scaling alone share theirs. */
export class Forms {
  private readonly made = new Map<string | Geometry, BufferGeometry>();

  /** Round forms have so many sides; see {@link sides}. */
  constructor(readonly sides: number) {}

  /** The form, where a plane without end has the half extents `endless` [m]. */
  of(form: Geometry, endless: number): Form {
    switch (form.kind) {
      case "plane": {
        const [x, z] = form.half ?? [endless, endless];
        return {
          geometry: this.get("plane", () => new PlaneGeometry(2, 2).rotateX(-Math.PI / 2)),
          scale: [x, 1, z],
        };
      }
      case "sphere":
        return { geometry: this.sphere(), scale: [form.radius, form.radius, form.radius] };
      case "ellipsoid":
        return { geometry: this.sphere(), scale: form.half };
      case "box":
        return { geometry: this.get("box", () => new BoxGeometry(2, 2, 2)), scale: form.half };
      case "cylinder":
        return {
          geometry: this.get("cylinder", () => new CylinderGeometry(1, 1, 2, this.sides)),
          scale: [form.radius, form.half_height, form.radius],
        };
      case "cone":
        return {
          geometry: this.get("cone", () => new ConeGeometry(1, 2, this.sides)),
          scale: [form.radius, form.half_height, form.radius],
        };
      case "capsule": {
        // Its ends stay round under equal scalings only, so there is one for each proportion.
        const middle = (2 * (form.half_height - form.radius)) / form.radius;
        const key = `capsule ${middle.toPrecision(5)}`;
        return {
          geometry: this.get(
            key,
            () => new CapsuleGeometry(1, Math.max(middle, 0), this.sides / 4, this.sides),
          ),
          scale: [form.radius, form.radius, form.radius],
        };
      }
      case "mesh":
        return { geometry: this.get(form, () => mesh(form)), scale: [1, 1, 1] };
    }
  }

  dispose(): void {
    for (const geometry of this.made.values()) geometry.dispose();
  }

  private sphere(): BufferGeometry {
    return this.get("sphere", () => new SphereGeometry(1, this.sides, this.sides / 2));
  }

  private get(key: string | Geometry, make: () => BufferGeometry): BufferGeometry {
    let geometry = this.made.get(key);
    if (!geometry) {
      geometry = make();
      this.made.set(key, geometry);
    }
    return geometry;
  }
}

function mesh({ positions, triangles }: Extract<Geometry, { kind: "mesh" }>): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
  geometry.setIndex(new BufferAttribute(new Uint32Array(triangles), 1));
  geometry.computeVertexNormals();
  geometry.setAttribute("uv", boxCoordinates(geometry));
  return geometry;
}

/** Texture coordinates for corners that have none: from the side that they face most, a metre a picture. */
function boxCoordinates(geometry: BufferGeometry): BufferAttribute {
  const position = geometry.getAttribute("position");
  const normal = geometry.getAttribute("normal");
  const uv = new BufferAttribute(new Float32Array(2 * position.count), 2);
  for (let i = 0; i < position.count; i++) {
    const facing = [normal.getX(i), normal.getY(i), normal.getZ(i)].map(Math.abs);
    const at = [position.getX(i), position.getY(i), position.getZ(i)];
    const axis = facing.indexOf(Math.max(...facing));
    uv.setXY(i, at[(axis + 1) % 3], at[(axis + 2) % 3]);
  }
  return uv;
}
