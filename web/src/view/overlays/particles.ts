import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DynamicDrawUsage,
  Points,
  ShaderMaterial,
  Vector2,
} from "three";
import type { Moment, Overlay } from "./overlay";

/** Particles as shaded balls, each one point of the graphics card. */
export class Particles implements Overlay {
  readonly object: Points<BufferGeometry, ShaderMaterial>;
  private places = new Float32Array(0);

  constructor(color = "#3f8fd2") {
    const material = new ShaderMaterial({
      uniforms: { radius: { value: 0.01 }, viewHeight: { value: 1 }, tint: { value: new Color(color) } },
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
    });
    this.object = new Points(new BufferGeometry(), material);
    this.object.frustumCulled = false;
    this.object.onBeforeRender = (renderer) => {
      material.uniforms.viewHeight.value = renderer.getDrawingBufferSize(new Vector2()).y;
    };
  }

  draw({ frame: { particles }, poses, measures }: Moment): void {
    const count = particles.length / 3;
    if (particles.length > this.places.length) this.makeRoom(particles.length);
    this.places.set(particles);
    if (poses.worlds > 1) this.shift(particles.length / poses.worlds, poses.shifts);
    this.object.geometry.setDrawRange(0, count);
    const attribute = this.object.geometry.getAttribute("position") as BufferAttribute | undefined;
    if (!attribute) return;
    attribute.clearUpdateRanges();
    attribute.addUpdateRange(0, particles.length);
    attribute.needsUpdate = true;
    // Messages tell no radius: as if they filled an eighth of the scene's ball.
    const each = count / Math.max(poses.worlds, 1);
    this.object.material.uniforms.radius.value = 0.5 * measures.world * Math.cbrt(1 / Math.max(each, 1));
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }

  /** Worlds have as many particles each. */
  private shift(each: number, shifts: Float32Array): void {
    for (let i = 0; i < this.places.length; i++) this.places[i] += shifts[3 * Math.floor(i / each) + (i % 3)];
  }

  private makeRoom(length: number): void {
    this.places = new Float32Array(length);
    this.object.geometry.dispose();
    this.object.geometry = new BufferGeometry();
    this.object.geometry.setAttribute(
      "position",
      new BufferAttribute(this.places, 3).setUsage(DynamicDrawUsage),
    );
  }
}

const VERTEX = /* glsl */ `
uniform float radius, viewHeight;
void main() {
  vec4 place = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * place;
  gl_PointSize = max(2.0, radius * projectionMatrix[1][1] * viewHeight / gl_Position.w);
}
`;

const FRAGMENT = /* glsl */ `
uniform vec3 tint;
void main() {
  vec2 at = 2.0 * gl_PointCoord - 1.0;
  float square = dot(at, at);
  if (square > 1.0) discard;
  vec3 normal = vec3(at.x, -at.y, sqrt(1.0 - square));
  float light = 0.45 + 0.55 * max(dot(normal, normalize(vec3(0.35, 0.8, 0.5))), 0.0);
  gl_FragColor = vec4(tint * light, 1.0);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
}
`;
