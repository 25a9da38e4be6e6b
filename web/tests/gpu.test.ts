import { afterEach, expect, test, vi } from "vitest";
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
  expect(await card.buffer(4, 0)).toBe(0);
  expect(text(card.failure(16, 64))).toBe("it is not open");
  expect(text(card.failure(16, 5))).toBe("it is");
  expect(card.check()).toBe(0);
  expect(card.submit(0, 0)).toBe(0);
  card.release(7);
});

test("what waits suspends the engine where that can be, and fails elsewhere", () => {
  const card = new Card(null, () => new WebAssembly.Memory({ initial: 1 }));
  const waiting = () => ["open", "buffer", "compiled", "read"].map((name) => imports(card)[name]);
  for (const call of waiting()) expect((call as () => number)()).toBe(0);
  promises.Suspending = Suspending;
  for (const call of waiting()) expect(call).toBeInstanceOf(Suspending);
});

/** A device that notes what is asked of it. */
class Device {
  readonly asked: unknown[][] = [];
  readonly limits = {
    maxBufferSize: 4096,
    maxStorageBufferBindingSize: 2048,
    maxComputeWorkgroupsPerDimension: 100,
  };
  readonly lost = new Promise(() => {});
  /** Entry points that do not compile, and texts that are none. */
  readonly wrong = new Set<string>();
  full = false;
  /** What the buffer that is mapped holds. */
  words = new Uint32Array();
  /** Whether it fails where it is waited for. */
  fails = false;
  private gone: (event: object) => void = () => {};
  private readonly scopes: ({ message: string } | null)[] = [];

  private note = (...asked: unknown[]) => {
    this.asked.push(asked);
  };
  readonly queue = {
    writeBuffer: (buffer: object, at: number, bytes: Uint8Array) =>
      this.note("write", buffer, at, [...new Uint32Array(bytes.slice().buffer)]),
    submit: () => this.note("submit"),
  };
  addEventListener(_: string, gone: (event: object) => void) {
    this.gone = gone;
  }
  fail(message: string) {
    this.gone({ error: { message } });
  }
  destroy() {}
  pushErrorScope(sort: string) {
    this.scopes.push(this.full && sort === "out-of-memory" ? { message: "full" } : null);
  }
  async popErrorScope() {
    return this.scopes.pop() ?? null;
  }
  createBuffer({ size, usage }: { size: number; usage: number }) {
    const buffer = {
      size,
      usage,
      destroy: () => this.note("destroy", buffer),
      mapAsync: async () => {
        if (!this.fails) return;
        setTimeout(() => this.fail("gone in the middle"));
        throw new Error("mapping was aborted");
      },
      getMappedRange: (_: number, length: number) => this.words.buffer.slice(0, length),
      unmap: () => {},
    };
    return buffer;
  }
  createShaderModule({ code }: { code: string }) {
    this.note("module", code);
    if (this.wrong.has(code)) this.scopes[this.scopes.length - 1] = { message: `no text: ${code}` };
    return { code };
  }
  createBindGroupLayout = ({ entries }: { entries: object[] }) => ({ entries });
  createPipelineLayout = (layout: object) => layout;
  createBindGroup = (group: object) => {
    this.note("bind");
    return group;
  };
  async createComputePipelineAsync({ compute }: { compute: { entryPoint: string } }) {
    this.note("compile", compute.entryPoint);
    if (this.wrong.has(compute.entryPoint)) throw new Error(`${compute.entryPoint} is wrong`);
    return compute;
  }
  createCommandEncoder() {
    const { note } = this;
    return {
      beginComputePass: () => {
        note("pass");
        return {
          setPipeline: ({ entryPoint }: { entryPoint: string }) => note("kernel", entryPoint),
          setBindGroup: (_: number, { entries }: { entries: { binding: number }[] }) =>
            note(
              "sees",
              entries.map(({ binding }) => binding),
            ),
          dispatchWorkgroups: (count: number) => note("run", count),
          dispatchWorkgroupsIndirect: (told: object, at: number) => note("told", told, at),
          end: () => note("end"),
        };
      },
      copyBufferToBuffer: (_: object, from: number, __: object, to: number, size: number) =>
        note("copy", from, to, size),
      finish: () => null,
    };
  }
}

/** An open card, its device, and what writes words and texts where the card reads them. */
async function opened() {
  const memory = new WebAssembly.Memory({ initial: 1 });
  const device = new Device();
  const adapter = { limits: device.limits, requestDevice: async () => device } as unknown as GPUAdapter;
  const card = new Card({ adapter, name: "a card" }, () => memory);
  expect(await card.open()).toBe(1);
  let end = 16;
  const put = (bytes: Uint8Array) => {
    const at = end;
    new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
    end += 4 * Math.ceil(bytes.length / 4);
    return [at, bytes.length] as const;
  };
  const words = (...numbers: number[]) => put(new Uint8Array(new Uint32Array(numbers).buffer))[0];
  const text = (text: string) => put(new TextEncoder().encode(text));
  const reason = () => new TextDecoder().decode(new Uint8Array(memory.buffer, 8192, card.failure(8192, 200)));
  /** Begins to compile an entry point that sees these bindings of these kinds. */
  const kernel = (code: string, name: string, ...seen: [binding: number, kind: number][]) => {
    const own = card.text(...text(code));
    const number = card.kernel(own, ...text(name), words(...seen.flat()), seen.length);
    card.release(own);
    return number;
  };
  const read = (buffer: number, ...ranges: [start: number, length: number][]) =>
    card.read(buffer, words(...ranges.flat()), ranges.length, 12288);
  const fetched = (count: number) => [...new Uint32Array(memory.buffer, 12288, count)];
  return { card, device, words, kernel, reason, read, fetched };
}

test("commands run kernels on what they see, and copy between passes", async () => {
  const { card, device, words, kernel } = await opened();
  const [a, b] = [await card.buffer(8, 0), await card.buffer(8, 0)];
  const told = await card.buffer(6, 1);
  const plan = card.uniform(words(7, 9), 2);
  const [first, second] = [kernel("text", "first", [0, 0], [3, 2]), kernel("text", "second", [1, 1], [3, 2])];
  expect(await card.compiled()).toBe(1);
  const bindings = card.bind(words(a, b, told, plan), 4);
  expect(device.asked.filter(([what]) => what === "module").length).toBe(1);
  expect(device.asked.filter(([what]) => what === "write").map((write) => write[3])).toEqual([[7, 9]]);
  const run = [0, first, bindings, 3];
  const commands = [...run, 1, second, bindings, told, 1, 2, a, 4, b, 5, 3, ...run];
  const before = device.asked.length;
  expect(card.submit(words(...commands), commands.length)).toBe(1);
  const asked = device.asked.slice(before).map(([what, ...rest]) => [what, ...rest.slice(-1)]);
  expect(asked).toEqual([
    ["pass"],
    ["kernel", "first"],
    ["bind"],
    ["sees", [0, 3]],
    ["run", 3],
    ["kernel", "second"],
    ["bind"],
    ["sees", [1, 3]],
    // The second three words.
    ["told", 12],
    ["end"],
    ["copy", 12],
    ["pass"],
    ["kernel", "first"],
    ["sees", [0, 3]],
    ["run", 3],
    ["end"],
    ["submit"],
  ]);
  expect(device.asked.find(([what]) => what === "copy")).toEqual(["copy", 16, 20, 12]);
  expect(device.asked.find(([what]) => what === "told")?.[1]).toMatchObject({ size: 24, usage: 0x18c });
  card.release(a);
  expect(device.asked.at(-1)).toMatchObject(["destroy", { size: 32 }]);
  expect(card.bind(words(a, b), 2)).toBe(0);
});

test("what is no command, or not there, is refused and nothing is submitted", async () => {
  const { card, device, words, kernel, reason } = await opened();
  const refused = (commands: number[], why: string) => {
    expect(card.submit(words(...commands), commands.length)).toBe(0);
    expect(reason()).toContain(why);
  };
  refused([9], "there is no command 9");
  refused([0, 77, 1, 1], "it has no 77 any more");
  const begun = kernel("text", "main", [0, 0]);
  refused([0, begun, 1, 1], "is not compiled yet");
  expect(device.asked.some(([what]) => what === "submit")).toBe(false);
  expect(card.check()).toBe(1);
});

test("a kernel that does not compile is told once, and compiled anew where it is asked for again", async () => {
  const { card, device, kernel, reason } = await opened();
  const compiled = () => device.asked.filter(([what]) => what === "compile").length;
  device.wrong.add("bad");
  kernel("text", "good", [0, 0]);
  kernel("text", "bad", [0, 0]);
  expect(await card.compiled()).toBe(0);
  expect(reason()).toBe("bad is wrong");
  expect(await card.compiled()).toBe(1);
  device.wrong.clear();
  expect(compiled()).toBe(2);
  kernel("text", "good", [0, 0]);
  kernel("text", "bad", [0, 0]);
  expect(await card.compiled()).toBe(1);
  expect(compiled()).toBe(4);
  kernel("text", "good", [0, 0]);
  expect(compiled()).toBe(4);
});

test("memory that is not there is refused, and the card goes on", async () => {
  const { card, device, reason } = await opened();
  expect(card.mostBytes()).toBe(2048);
  expect(card.mostWorkgroups()).toBe(100);
  expect(await card.buffer(1025, 0)).toBe(0);
  expect(reason()).toContain("does not hold 4100 bytes more");
  device.full = true;
  expect(await card.buffer(4, 0)).toBe(0);
  device.full = false;
  expect(await card.buffer(1024, 0)).not.toBe(0);
  device.fail("gone");
  expect(card.check()).toBe(0);
  expect(reason()).toBe("gone");
  expect(await card.compiled()).toBe(0);
});

test("a text that is none is told, and the card goes on", async () => {
  const { card, device, kernel, reason } = await opened();
  device.wrong.add("nonsense");
  kernel("nonsense", "main", [0, 0]);
  expect(await card.compiled()).toBe(0);
  expect(reason()).toBe("no text: nonsense");
  expect(card.check()).toBe(1);
  kernel("text", "main", [0, 0]);
  expect(await card.compiled()).toBe(1);
});

test("texts are kept for the next model, and all of the present one", async () => {
  const { card, device, kernel } = await opened();
  const compiled = () => device.asked.filter(([what]) => what === "compile").length;
  const model = async (first: number, count: number) => {
    for (let i = first; i < first + count; i++) kernel(`text ${i}`, "main", [0, 0]);
    expect(await card.compiled()).toBe(1);
    return compiled();
  };
  expect(await model(0, 150)).toBe(150);
  expect(await model(0, 150)).toBe(150);
  expect(await model(200, 60)).toBe(210);
  // Of the first, the last 36 are still there.
  expect(await model(114, 36)).toBe(210);
  expect(await model(113, 1)).toBe(211);
});

test("ranges are read one after the other, through memory that grows", async () => {
  const { card, device, read, fetched } = await opened();
  const buffer = await card.buffer(64, 0);
  device.words = new Uint32Array([3, 1, 4, 1, 5, 9]);
  expect(await read(buffer, [2, 1], [8, 2])).toBe(1);
  expect(fetched(3)).toEqual([3, 1, 4]);
  expect(device.asked.filter(([what]) => what === "copy").map((copy) => copy.slice(1))).toEqual([
    [8, 0, 4],
    [32, 4, 8],
  ]);
  expect(await read(buffer, [0, 6])).toBe(1);
  expect(fetched(6)).toEqual([3, 1, 4, 1, 5, 9]);
  const destroyed = device.asked.filter(([what]) => what === "destroy");
  expect(destroyed).toMatchObject([["destroy", { size: 12 }]]);
  expect(await read(buffer)).toBe(1);
  expect(await read(buffer, [0, 1025])).toBe(0);
});

test("a card that fails while it is waited for says why, and what it held is lost with it", async () => {
  const { card, device, read, reason } = await opened();
  const buffer = await card.buffer(8, 0);
  device.fails = true;
  expect(await read(buffer, [0, 4])).toBe(0);
  expect(reason()).toBe("gone in the middle");
  device.fails = false;
  const again = new Device();
  const adapter = { info, limits: again.limits, requestDevice: async () => again };
  vi.stubGlobal("navigator", { gpu: webgpu(null) });
  promises.Suspending = Suspending;
  expect(await card.open()).toBe(0);
  expect(reason()).toContain("finds none");
  vi.stubGlobal("navigator", { gpu: webgpu(adapter) });
  expect(await card.open()).toBe(1);
  vi.unstubAllGlobals();
  expect(await read(buffer, [0, 4])).toBe(0);
  expect(reason()).toBe("gone in the middle, and with it what it held");
  expect(await card.buffer(8, 0)).not.toBe(0);
});
