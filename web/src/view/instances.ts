import {
  type BufferGeometry,
  DynamicDrawUsage,
  Group,
  InstancedBufferAttribute,
  InstancedMesh,
  type Material,
} from "three";

/** As many of one mesh as are needed; room is made by doubling. */
export class Instances extends Group {
  mesh: InstancedMesh;

  constructor(
    private readonly geometry: BufferGeometry,
    private readonly material: Material,
    private readonly colored: boolean,
    capacity = 16,
  ) {
    super();
    this.mesh = this.make(capacity);
  }

  /** Shows so many, and returns the array of their matrices. What was in it may be lost. */
  reserve(count: number): Float32Array {
    const room = this.mesh.instanceMatrix.count;
    if (count > room) {
      this.mesh.dispose();
      this.remove(this.mesh);
      this.mesh = this.make(Math.max(count, 2 * room));
    }
    this.mesh.count = count;
    this.mesh.visible = count > 0;
    return this.mesh.instanceMatrix.array as Float32Array;
  }

  /** Colours, linear, three numbers each. */
  get colors(): Float32Array {
    return this.mesh.instanceColor?.array as Float32Array;
  }

  /** The matrices were written. */
  moved(): void {
    this.mesh.instanceMatrix.needsUpdate = true;
    // Worked out again when it is next asked for.
    this.mesh.boundingSphere = null;
  }

  recolored(): void {
    if (this.mesh.instanceColor) this.mesh.instanceColor.needsUpdate = true;
  }

  override dispose(): void {
    this.mesh.dispose();
  }

  private make(capacity: number): InstancedMesh {
    const mesh = new InstancedMesh(this.geometry, this.material, capacity);
    mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    if (this.colored) {
      mesh.instanceColor = new InstancedBufferAttribute(new Float32Array(3 * capacity).fill(1), 3);
    }
    mesh.frustumCulled = false;
    mesh.count = 0;
    mesh.visible = false;
    mesh.castShadow = this.castShadow;
    mesh.receiveShadow = this.receiveShadow;
    mesh.renderOrder = this.renderOrder;
    this.add(mesh);
    return mesh;
  }
}
