/** What changes from frame to frame, as bytes. `frame.rs` has the layout; little-endian, as are all browsers. */

import { Malformed } from "./schema";

/** The first four bytes: `KFRM`. */
export const MAGIC = 0x4d52464b;
/** Length of what every frame begins with [bytes]. */
export const HEADER = 60;
/** Numbers of a body's pose: position [m], orientation x, y, z, w. */
export const POSE = 7;
/** Numbers of a contact: row of its world, position [m], force [N] on the second shape, distance [m], two shapes. */
export const CONTACT = 10;

/** Samples that a frame may have to carry of those before it, which were not drawn. */
const MOST_SAMPLES = 4096;

/** A frame. Its arrays are views of the bytes that came. */
export interface Frame {
  /** Which scene it is of. */
  scene: number;
  number: number;
  running: boolean;
  /** How often other worlds were chosen to be shown. */
  choices: number;
  /** Seconds since the start. */
  time: number;
  steps: number;
  /** Worlds shown. */
  worlds: number;
  bodies: number;
  /** {@link POSE} numbers a body, world by world. */
  poses: Float32Array;
  /** {@link CONTACT} numbers a contact. */
  contacts: Float32Array;
  /** Joint coordinates of the first world shown. */
  coordinates: Float32Array;
  /** Joint velocities of the first world shown. */
  velocities: Float32Array;
  /** Values of the plotted quantities. */
  quantities: Float32Array;
  /** Positions [m] of the particles of all worlds shown. */
  particles: Float32Array;
  /** Of each earlier sample since the frame before: its age [s], and the values of the plotted quantities. */
  past: Float32Array;
}

/** Reads a frame. Throws {@link Malformed} where the bytes are none. */
export function readFrame(bytes: ArrayBuffer): Frame {
  if (bytes.byteLength < HEADER) throw new Malformed(`a frame of ${bytes.byteLength} bytes is too short`);
  const header = new DataView(bytes, 0, HEADER);
  const word = (offset: number) => header.getUint32(offset, true);
  if (word(0) !== MAGIC) throw new Malformed("not a frame: its first bytes are not KFRM");

  const [worlds, bodies, contacts] = [word(28), word(32), word(36)];
  let offset = HEADER;
  const sample = 1 + word(48);
  const lengths = [
    POSE * worlds * bodies,
    CONTACT * contacts,
    word(40),
    word(44),
    word(48),
    3 * word(52),
    sample * word(56),
  ];
  const expected = HEADER + 4 * lengths.reduce((sum, length) => sum + length, 0);
  if (bytes.byteLength !== expected) {
    throw new Malformed(`a frame of ${bytes.byteLength} bytes should have ${expected}`);
  }
  const [poses, touches, coordinates, velocities, quantities, particles, past] = lengths.map((length) => {
    const view = new Float32Array(bytes, offset, length);
    offset += 4 * length;
    return view;
  });
  if (!poses.every(Number.isFinite)) throw new Malformed("a frame has a pose that is not finite");
  return {
    scene: word(4),
    number: word(8),
    running: (word(12) & 1) === 1,
    choices: word(12) >>> 1,
    time: header.getFloat64(16, true),
    steps: word(24),
    worlds,
    bodies,
    poses,
    contacts: touches,
    coordinates,
    velocities,
    quantities,
    particles,
    past,
  };
}

/** A frame with the samples of the one before it, which is dropped: plots miss nothing where pictures do. */
export function withSamples(dropped: ArrayBuffer, bytes: ArrayBuffer): ArrayBuffer {
  let frames: [Frame, Frame];
  try {
    frames = [readFrame(dropped), readFrame(bytes)];
  } catch {
    // Who reads it will tell.
    return bytes;
  }
  const [before, frame] = frames;
  const age = frame.time - before.time;
  const sample = 1 + frame.quantities.length;
  const like =
    before.scene === frame.scene &&
    before.choices === frame.choices &&
    before.quantities.length === frame.quantities.length;
  if (!like || age <= 0) return bytes;
  const older = before.past.map((value, i) => (i % sample === 0 ? value + age : value));
  const all = [...older, age, ...before.quantities, ...frame.past].slice(-sample * MOST_SAMPLES);
  const head = bytes.byteLength - frame.past.byteLength;
  const merged = new Uint8Array(head + 4 * all.length);
  merged.set(new Uint8Array(bytes, 0, head));
  new Float32Array(merged.buffer, head).set(all);
  new DataView(merged.buffer).setUint32(56, all.length / sample, true);
  return merged.buffer;
}
