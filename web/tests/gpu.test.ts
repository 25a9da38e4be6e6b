import { afterEach, expect, test } from "vitest";
import { Card, findCard, imports, promises } from "../src/transport/gpu";

/** WebGPU that has this adapter. */
const webgpu = (adapter: object | null) => ({ requestAdapter: async () => adapter }) as unknown as GPU;
const info = { vendor: "google", architecture: "swiftshader", description: "" };

/** What browsers have, and Node has not. */
const Suspending = class {
  constructor(readonly call: (...numbers: number[]) => Promise<number>) {}
} as unknown as NonNullable<typeof promises.Suspending>;

afterEach(() => {
  delete promises.Suspending;
});

test("a card has a name, or there is a reason why there is none", async () => {
  expect(await findCard(undefined)).toContain("no WebGPU");
  const find = (adapter: object | null) => findCard(webgpu(adapter));
  expect(await find({ info })).toContain("cannot let WebAssembly wait");
  promises.Suspending = Suspending;
  expect(await find(null)).toContain("finds none");
  expect(await find({ info })).toMatchObject({ name: "google swiftshader" });
  expect(await find({ info: { ...info, description: "Radeon" } })).toMatchObject({ name: "Radeon" });
  const broken = { requestAdapter: () => Promise.reject(new Error("gone")) } as unknown as GPU;
  expect(await findCard(broken)).toContain("does not answer: gone");
});

test("a card that was not opened fails, and says so", async () => {
  const memory = new WebAssembly.Memory({ initial: 1 });
  const card = new Card(null, () => memory);
  expect(await card.open()).toBe(0);
  expect(card.failure(16, 64)).toBe("there is none".length);
  const text = (length: number) => new TextDecoder().decode(new Uint8Array(memory.buffer, 16, length));
  expect(text(13)).toBe("there is none");
  expect(await card.buffer(4)).toBe(0);
  expect(text(card.failure(16, 64))).toBe("it is not open");
  expect(text(card.failure(16, 5))).toBe("it is");
  expect(card.launch(1, 0, 1, 1, 1, 1)).toBe(0);
  card.release(7);
});

test("what waits suspends the engine where that can be, and fails elsewhere", () => {
  const card = new Card(null, () => new WebAssembly.Memory({ initial: 1 }));
  const waiting = () => ["open", "buffer", "kernel", "read"].map((name) => imports(card)[name]);
  for (const call of waiting()) expect((call as () => number)()).toBe(0);
  promises.Suspending = Suspending;
  for (const call of waiting()) expect(call).toBeInstanceOf(Suspending);
});
