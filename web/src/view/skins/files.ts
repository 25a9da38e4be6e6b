import { type Object3D, SRGBColorSpace, TextureLoader } from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import type { Skin } from "./skin";

/** What a GLB model is called on the web. */
export const GLB = "model/gltf-binary";

/** What a file may be, for a file dialog. */
export const SKIN_FILES = ".glb,image/*";

/** Makes a skin of a picture or a GLB model. Throws an Error that says what is wrong. */
export async function skinOfFile(file: File): Promise<Skin> {
  if (file.type.startsWith("image/")) return { kind: "picture", picture: await readPicture(file) };
  if (file.type === GLB || file.name.toLowerCase().endsWith(".glb")) {
    return { kind: "model", model: await readModel(file), fitted: true };
  }
  throw new Error(`${file.name} is no picture, GLB model or robot file (.xml, .urdf). Choose one of these.`);
}

async function readModel(file: File): Promise<Object3D> {
  const bytes = await file.arrayBuffer();
  if (!new TextDecoder().decode(bytes.slice(0, 4)).startsWith("glTF")) {
    throw new Error(`${file.name} is no GLB file: its first bytes are not glTF.`);
  }
  try {
    const { scene } = await new GLTFLoader().parseAsync(bytes, "");
    return scene;
  } catch (error) {
    throw new Error(`${file.name} cannot be read as GLB: ${(error as Error).message}`);
  }
}

async function readPicture(file: File) {
  const address = URL.createObjectURL(file);
  try {
    const picture = await new TextureLoader().loadAsync(address);
    picture.colorSpace = SRGBColorSpace;
    picture.anisotropy = 8;
    return picture;
  } catch {
    throw new Error(`${file.name} is no picture that this browser can read.`);
  } finally {
    URL.revokeObjectURL(address);
  }
}
