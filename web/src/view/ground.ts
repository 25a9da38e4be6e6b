import { Color, Mesh, MeshStandardMaterial, PlaneGeometry } from "three";
import type { Theme } from "../theme";

const COLORS: Record<Theme, { floor: string; line: string }> = {
  light: { floor: "#d9dcde", line: "#9aa2a9" },
  dark: { floor: "#2b3036", line: "#59626b" },
};

/**
 * A level floor with a grid of two widths, which fades with the distance. Lines are drawn in the shader, a
 * pixel wide at least, and fade where they come too close together, after Golus, "The best darn grid shader", 2023.
 */
export class Ground extends Mesh<PlaneGeometry, MeshStandardMaterial> {
  private readonly uniforms = {
    cell: { value: 1 },
    reach: { value: 100 },
    line: { value: new Color() },
    solid: { value: 1 },
    lined: { value: 1 },
  };

  constructor() {
    super(
      new PlaneGeometry(2, 2).rotateX(-Math.PI / 2),
      new MeshStandardMaterial({ transparent: true, roughness: 0.95, depthWrite: false }),
    );
    this.receiveShadow = true;
    // It is laid under a scene.
    this.visible = false;
    // First of all that is transparent.
    this.renderOrder = -1;
    this.material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.uniforms);
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", "#include <common>\nvarying vec3 vPlace;")
        .replace(
          "#include <project_vertex>",
          "#include <project_vertex>\nvPlace = (modelMatrix * vec4(transformed, 1.0)).xyz;",
        );
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", `#include <common>\n${GRID}`)
        .replace("#include <color_fragment>", PAINT);
    };
  }

  setTheme(theme: Theme): void {
    this.material.color.set(COLORS[theme].floor);
    this.uniforms.line.value.set(COLORS[theme].line);
  }

  /**
   * Lays it out under all that is shown, of a radius [m], with a grid for one world's radius; `solid` where
   * the scene has a floor, else faint.
   */
  fit(radius: number, world: number, solid: boolean): void {
    this.visible = true;
    const reach = 40 * radius;
    this.scale.set(reach, 1, reach);
    this.uniforms.reach.value = reach;
    this.uniforms.cell.value = 10 ** Math.floor(Math.log10(world / 1.2));
    this.uniforms.solid.value = solid ? 1 : 0.35;
  }

  set grid(on: boolean) {
    this.uniforms.lined.value = on ? 1 : 0;
  }
}

const GRID = /* glsl */ `
varying vec3 vPlace;
uniform float cell, reach, solid, lined;
uniform vec3 line;
float gridLines(vec2 at, float width) {
  vec2 step = fwidth(at);
  vec2 drawn = clamp(vec2(width), step, vec2(0.5));
  vec2 edge = abs(fract(at - 0.5) - 0.5);
  vec2 ink = smoothstep(drawn + step, drawn - step, edge) * clamp(width / drawn, 0.35, 1.0);
  ink *= 1.0 - smoothstep(0.12, 0.5, step);
  return mix(ink.x, 1.0, ink.y);
}
`;

const PAINT = /* glsl */ `
#include <color_fragment>
float fine = gridLines(vPlace.xz / cell, 0.008);
float coarse = gridLines(vPlace.xz / (10.0 * cell), 0.002);
float ink = lined * max(0.55 * fine, coarse);
float fade = 1.0 - smoothstep(0.05, 0.9, length(vPlace.xz) / reach);
diffuseColor.rgb = mix(diffuseColor.rgb, line, ink);
diffuseColor.a = fade * mix(solid, 1.0, ink);
`;
