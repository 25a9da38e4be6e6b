import { Color, Mesh } from "three";
import type { Dress, Outfit, SkinFile } from "../../protocol";
import type { Session } from "../../session";
import { GLB, skinOfFile } from "./files";
import type { Skin, Worn } from "./skin";

/**
 * Dresses bodies as a program says, in the order in which it says so: what comes while a picture is read waits. A person
 * may dress them otherwise, until the program dresses them again.
 */
export class Dresser {
  private readonly files = new Map<string, Promise<Skin>>();
  private last = Promise.resolve();

  constructor(
    private readonly session: Session,
    private readonly wear: (worn: Worn[]) => void,
    private readonly read: (file: SkinFile) => Promise<Skin> = skinOf,
  ) {
    session.on("skinFile", (file) => {
      const skin = this.read(file);
      // Who wears it is told.
      skin.catch(() => {});
      this.files.set(file.id, skin);
    });
    session.on("dress", (dress) => {
      this.last = this.last.then(() => this.dress(dress));
    });
  }

  private async dress({ scene, outfits, forget }: Dress): Promise<void> {
    const worn: Worn[] = [];
    for (const { bodies, skin } of outfits) {
      try {
        worn.push({ bodies, skin: await this.skin(skin) });
      } catch (error) {
        this.session.failed((error as Error).message);
      }
    }
    // Another model may have come meanwhile, whose bodies these are not.
    const here = worn.filter(({ bodies }) => bodies === null || scene === this.session.scene?.id);
    if (here.length) this.wear(here);
    for (const id of forget) {
      this.files.get(id)?.then(release, () => {});
      this.files.delete(id);
    }
  }

  private async skin(skin: Outfit["skin"]): Promise<Skin> {
    switch (skin.kind) {
      case "color": {
        const [red, green, blue, opacity] = skin.color;
        // No finer than is seen: each opacity is a material.
        const seen = Math.round(255 * opacity) / 255;
        return { kind: "color", color: new Color().setRGB(red, green, blue, "srgb"), opacity: seen };
      }
      case "file": {
        const worn = await this.files.get(skin.file);
        if (!worn) throw new Error(`The engine has a body wear a file that it did not send, ${skin.file}.`);
        return worn.kind === "model" ? { ...worn, fitted: skin.fitted } : worn;
      }
      default:
        return skin;
    }
  }
}

async function skinOf({ name, format, data }: SkinFile): Promise<Skin> {
  const type = format === "glb" ? GLB : `image/${format}`;
  const content = await fetch(`data:${type};base64,${data}`);
  return skinOfFile(new File([await content.arrayBuffer()], name, { type }));
}

/** Frees what a skin holds of the graphics card; where it is still worn, that comes back. */
function release(skin: Skin): void {
  if (skin.kind === "picture") skin.picture.dispose();
  if (skin.kind !== "model") return;
  skin.model.traverse((node) => {
    if (node instanceof Mesh) node.geometry.dispose();
  });
}
