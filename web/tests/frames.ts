import { HEADER, MAGIC } from "../src/frame";

/** What {@link writeFrame} writes; the rest is zero or empty. */
export interface Contents {
  scene?: number;
  number?: number;
  running?: boolean;
  choices?: number;
  time?: number;
  steps?: number;
  worlds?: number;
  bodies?: number;
  poses?: ArrayLike<number>;
  contacts?: ArrayLike<number>;
  coordinates?: ArrayLike<number>;
  velocities?: ArrayLike<number>;
  quantities?: ArrayLike<number>;
  particles?: ArrayLike<number>;
  past?: ArrayLike<number>;
}

/** A frame as an engine writes it. */
export function writeFrame(contents: Contents): ArrayBuffer {
  const {
    poses = [],
    contacts = [],
    coordinates = [],
    velocities = [],
    quantities = [],
    particles = [],
    past = [],
  } = contents;
  const parts = [poses, contacts, coordinates, velocities, quantities, particles, past];
  const bytes = new ArrayBuffer(HEADER + 4 * parts.reduce((sum, part) => sum + part.length, 0));
  const header = new DataView(bytes);
  const words: [number, number][] = [
    [0, MAGIC],
    [4, contents.scene ?? 0],
    [8, contents.number ?? 0],
    [12, (contents.running ? 1 : 0) + 2 * (contents.choices ?? 0)],
    [24, contents.steps ?? 0],
    [28, contents.worlds ?? 0],
    [32, contents.bodies ?? 0],
    [36, contacts.length / 10],
    [40, coordinates.length],
    [44, velocities.length],
    [48, quantities.length],
    [52, particles.length / 3],
    [56, past.length / (1 + quantities.length)],
  ];
  for (const [offset, word] of words) header.setUint32(offset, word, true);
  header.setFloat64(16, contents.time ?? 0, true);
  let offset = HEADER;
  for (const part of parts) {
    new Float32Array(bytes, offset, part.length).set(part);
    offset += 4 * part.length;
  }
  return bytes;
}
