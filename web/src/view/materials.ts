import {
  DataTexture,
  DoubleSide,
  FrontSide,
  LinearFilter,
  LinearMipmapLinearFilter,
  type Material,
  MeshStandardMaterial,
  type Texture,
} from "three";

/** How a surface looks, besides its colour. */
export interface Look {
  /** Marks of two tones, by which one sees round things turn. */
  marked: boolean;
  flat: boolean;
  opacity: number;
  /** Seen from behind, too. */
  thin: boolean;
  wireframe: boolean;
  /** A picture instead of marks. */
  picture: Texture | null;
}

/** Materials by how they look; equal looks share one. */
export class Materials {
  private readonly made = new Map<string, MeshStandardMaterial>();
  private readonly marks = quarters();

  get(look: Look): MeshStandardMaterial {
    const key = `${look.marked} ${look.flat} ${look.opacity} ${look.thin} ${look.wireframe} ${look.picture?.uuid}`;
    let material = this.made.get(key);
    if (!material) {
      material = new MeshStandardMaterial({
        map: look.picture ?? (look.marked ? this.marks : null),
        flatShading: look.flat,
        opacity: look.opacity,
        transparent: look.opacity < 1,
        depthWrite: look.opacity === 1,
        side: look.thin ? DoubleSide : FrontSide,
        wireframe: look.wireframe,
        roughness: 0.55,
        metalness: 0,
      });
      this.made.set(key, material);
    }
    return material;
  }

  /** Lets go of pictures that no part shows any more. */
  keep(parts: Iterable<{ material: Material }>): void {
    const used = new Set<Material>(Array.from(parts, ({ material }) => material));
    for (const [key, material] of this.made) {
      if (material.map === null || material.map === this.marks || used.has(material)) continue;
      material.dispose();
      this.made.delete(key);
    }
  }

  dispose(): void {
    for (const material of this.made.values()) material.dispose();
    this.marks.dispose();
  }
}

/** Eighths of a ball by turns white and grey. */
function quarters(): DataTexture {
  const [width, height] = [256, 128];
  const pixels = new Uint8Array(4 * width * height);
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const dark = ((x / 64) | 0) % 2 === ((y / 64) | 0) % 2;
      pixels.set(dark ? [205, 205, 205, 255] : [255, 255, 255, 255], 4 * (y * width + x));
    }
  }
  const texture = new DataTexture(pixels, width, height);
  texture.minFilter = LinearMipmapLinearFilter;
  texture.magFilter = LinearFilter;
  texture.generateMipmaps = true;
  texture.anisotropy = 4;
  texture.colorSpace = "srgb";
  texture.needsUpdate = true;
  return texture;
}
