import { expect, test } from "vitest";
import { HEADER, readFrame, withSamples } from "../src/frame";
import { writeFrame } from "./frames";

const pose = [1, 2, 3, 0, 0, 0, 1];
const contents = {
  scene: 3,
  number: 7,
  running: true,
  choices: 5,
  time: 1.25,
  steps: 625,
  worlds: 2,
  bodies: 1,
  poses: [...pose, ...pose],
  contacts: [1, 0, 0, 0, 0, 9.5, 0, -0.001, 0, 1],
  coordinates: [0.5, 0.25],
  velocities: [-1],
  quantities: [4, 5, 6],
  particles: [0, 1, 0, 0, 2, 0],
  past: [0.5, 1, 2, 3, 0.25, 2, 3, 4],
};

test("a frame is read as it was written", () => {
  const frame = readFrame(writeFrame(contents));
  for (const [key, value] of Object.entries(contents)) {
    const read = frame[key as keyof typeof frame];
    if (read instanceof Float32Array)
      expect([...read], key).toEqual([...new Float32Array(value as number[])]);
    else expect(read, key).toBe(value);
  }
});

test("arrays are views of the bytes that came", () => {
  const bytes = writeFrame(contents);
  const frame = readFrame(bytes);
  expect(frame.poses.buffer).toBe(bytes);
  expect(frame.poses.byteOffset).toBe(HEADER);
});

test("an empty frame is a frame", () => {
  expect(readFrame(writeFrame({})).poses.length).toBe(0);
});

test("what is malformed is refused", () => {
  const bytes = writeFrame(contents);
  expect(() => readFrame(bytes.slice(0, 20))).toThrow("20 bytes is too short");
  expect(() => readFrame(bytes.slice(0, bytes.byteLength - 4))).toThrow("should have");
  const stranger = bytes.slice(0);
  new DataView(stranger).setUint8(0, 0);
  expect(() => readFrame(stranger)).toThrow("not KFRM");
  const nowhere = writeFrame({ ...contents, poses: [...pose, Number.NaN, 0, 0, 0, 0, 0, 1] });
  expect(() => readFrame(nowhere)).toThrow("not finite");
});

test("a frame takes the samples of one that is dropped", () => {
  const frame = (time: number, quantities: number[], past: number[], scene = 3) =>
    writeFrame({ ...contents, scene, time, quantities, past });
  const last = frame(2, [40, 41], [0.25, 30, 31]);
  const both = readFrame(withSamples(frame(1, [20, 21], [0.5, 10, 11]), last));
  expect([...both.past]).toEqual([1.5, 10, 11, 1, 20, 21, 0.25, 30, 31]);
  expect({ ...both, past: null }).toEqual({ ...readFrame(last), past: null });
  // Not those of another scene, of other quantities, or of a time that was left.
  for (const other of [
    frame(1, [0, 0], [], 2),
    frame(1, [0], []),
    frame(3, [0, 0], []),
    new ArrayBuffer(4),
  ]) {
    expect(withSamples(other, last)).toBe(last);
  }
});
