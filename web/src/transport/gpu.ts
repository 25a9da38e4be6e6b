/**
 * The graphics card, as the engine in WebAssembly knows it: buffers of words and kernels, by numbers. What is
 * computed there, and on which words, is the engine's business alone.
 *
 * WebGPU answers in promises, and the engine does not wait for any: calls that have to wait suspend it (JavaScript
 * promise integration). A browser that lacks the one or the other has no card for the engine.
 */

/** A card that was found. */
export interface Found {
  adapter: GPUAdapter;
  name: string;
}

type Waiting = (...numbers: number[]) => Promise<number>;
/** JavaScript promise integration, of which TypeScript's library does not know yet; some browsers neither. */
interface Promises {
  /** A function for WebAssembly that suspends its caller until the promise has come true. */
  Suspending: new (
    call: Waiting,
  ) => WebAssembly.ImportValue;
  /** What calls an export that may be suspended. */
  promising<T>(exported: () => T): () => Promise<T>;
}
export const promises: Partial<Promises> = WebAssembly as object;

/** Bytes of a word. */
const WORD = 4;
/** Kernels that nobody uses any more and that are kept, as the next model may need them. */
const KEPT = 16;

/** Finds a card, or why there is none. */
export async function findCard(gpu: GPU | undefined): Promise<Found | string> {
  if (!gpu) return "this browser has no WebGPU here";
  if (!promises.Suspending) return "this browser cannot let WebAssembly wait for one (promise integration)";
  try {
    const adapter = await gpu.requestAdapter({ powerPreference: "high-performance" });
    if (!adapter) return "this browser's WebGPU finds none on this machine";
    const { vendor, architecture, description } = adapter.info;
    return { adapter, name: description || [vendor, architecture].filter(Boolean).join(" ") || "WebGPU" };
  } catch (error) {
    return `this browser's WebGPU does not answer: ${(error as Error).message}`;
  }
}

/** A device, with what the engine has of it. */
class Opened {
  /** What went wrong first; from then on, nothing it holds is to be trusted. */
  failure: string | null = null;
  readonly buffers = new Map<number, GPUBuffer>();
  readonly kernels = new Map<number, GPUComputePipeline>();
  /** By their texts, the one that was asked for last at the end. */
  readonly compiled = new Map<string, GPUComputePipeline>();
  readonly layout: GPUBindGroupLayout;
  readonly uniform: GPUBuffer;
  /** Where words wait on their way back; it grows, and is kept. */
  staging: GPUBuffer | null = null;

  constructor(readonly device: GPUDevice) {
    device.lost.then(({ message }) => this.fail(message || "it is lost"));
    device.addEventListener("uncapturederror", ({ error }) => this.fail(error.message));
    this.layout = device.createBindGroupLayout({ entries: KINDS.map(entry) });
    this.uniform = device.createBuffer({ size: 2 * WORD, usage: USAGE.uniform });
  }

  fail(reason: string): void {
    this.failure ??= reason;
  }
}

// By number, as the constants are not there where WebGPU is not.
const USAGE = { read: 0x1 | 0x8, storage: 0x80 | 0x4 | 0x8, uniform: 0x40 | 0x8 };
const COMPUTE = 0x4;
const READ = 0x1;

/** State, input, output, scratch, parameters, links, launch: the bindings of all kernels. */
const KINDS: GPUBufferBindingType[] = [
  "storage",
  "read-only-storage",
  "storage",
  "storage",
  "read-only-storage",
  "read-only-storage",
  "uniform",
];
const entry = (type: GPUBufferBindingType, binding: number): GPUBindGroupLayoutEntry => ({
  binding,
  visibility: COMPUTE,
  buffer: { type },
});

/** What the engine imports as `gpu`. All answer 0 where they fail, and `failure` then says why. */
export class Card {
  private opened: Opened | null = null;
  private numbers = 0;
  private reason = "";

  /** `memory` is the engine's. */
  constructor(
    private found: Found | null,
    private readonly memory: () => WebAssembly.Memory,
  ) {}

  /** Opens the card; anew, where it has failed. */
  async open(): Promise<number> {
    if (this.opened && this.opened.failure === null) return 1;
    return this.guarded(async () => {
      // An adapter gives one device.
      const found = this.opened ? await findCard(navigator.gpu) : (this.found ?? "there is none");
      if (typeof found === "string") throw new Error(found);
      this.opened?.device.destroy();
      this.found = found;
      const { maxStorageBufferBindingSize, maxBufferSize } = found.adapter.limits;
      const requiredLimits = { maxStorageBufferBindingSize, maxBufferSize };
      this.opened = new Opened(await found.adapter.requestDevice({ requiredLimits }));
      return 1;
    });
  }

  mostBytes(): number {
    const limits = this.opened?.device.limits;
    return limits ? Math.min(limits.maxStorageBufferBindingSize, limits.maxBufferSize) : 0;
  }

  buffer(words: number): Promise<number> {
    return this.waited(async (opened) => {
      const { device } = opened;
      device.pushErrorScope("out-of-memory");
      const buffer = device.createBuffer({ size: words * WORD, usage: USAGE.storage });
      const full = await device.popErrorScope();
      if (full) throw new Error(`its memory does not hold ${words * WORD} bytes more; simulate fewer worlds`);
      return this.number(opened.buffers, buffer);
    });
  }

  kernel(at: number, length: number): Promise<number> {
    const text = new TextDecoder().decode(this.bytes(at, length));
    return this.waited(async (opened) => {
      const kernel = opened.compiled.get(text) ?? (await this.compile(opened, text));
      opened.compiled.delete(text);
      opened.compiled.set(text, kernel);
      const [oldest] = opened.compiled.keys();
      if (opened.compiled.size > KEPT) opened.compiled.delete(oldest);
      return this.number(opened.kernels, kernel);
    });
  }

  private compile({ device, layout }: Opened, text: string): Promise<GPUComputePipeline> {
    return device.createComputePipelineAsync({
      layout: device.createPipelineLayout({ bindGroupLayouts: [layout] }),
      compute: { module: device.createShaderModule({ code: text }), entryPoint: "main" },
    });
  }

  release(number: number): void {
    this.opened?.buffers.get(number)?.destroy();
    this.opened?.buffers.delete(number);
    this.opened?.kernels.delete(number);
  }

  write(buffer: number, at: number, words: number, count: number): number {
    return this.ordered(({ device, buffers }) => {
      device.queue.writeBuffer(get(buffers, buffer), at * WORD, this.bytes(words, count * WORD));
    });
  }

  launch(
    kernel: number,
    buffers: number,
    worlds: number,
    rounds: number,
    workgroups: number,
    times: number,
  ): number {
    return this.ordered((opened) => {
      const { device, uniform } = opened;
      device.queue.writeBuffer(uniform, 0, new Uint32Array([worlds, rounds]));
      const numbers = new Uint32Array(this.bytes(buffers, (KINDS.length - 1) * WORD).slice().buffer);
      const bound = [...numbers].map((number) => get(opened.buffers, number));
      const entries = [...bound, uniform].map((buffer, binding) => ({ binding, resource: { buffer } }));
      const encoder = device.createCommandEncoder();
      const pass = encoder.beginComputePass();
      pass.setPipeline(get(opened.kernels, kernel));
      pass.setBindGroup(0, device.createBindGroup({ layout: opened.layout, entries }));
      for (let i = 0; i < times; i++) pass.dispatchWorkgroups(workgroups);
      pass.end();
      device.queue.submit([encoder.finish()]);
    });
  }

  read(buffer: number, ranges: number, count: number, words: number): Promise<number> {
    const pairs = new Uint32Array(this.bytes(ranges, 2 * count * WORD).slice().buffer);
    return this.waited(async (opened) => {
      const { device, buffers } = opened;
      let end = 0;
      const copies: [from: number, to: number, size: number][] = [];
      for (let i = 0; i < pairs.length; i += 2) {
        copies.push([pairs[i] * WORD, end, pairs[i + 1] * WORD]);
        end += pairs[i + 1] * WORD;
      }
      if (end === 0) return 1;
      const staging = this.stage(opened, end);
      const encoder = device.createCommandEncoder();
      for (const [from, to, size] of copies)
        encoder.copyBufferToBuffer(get(buffers, buffer), from, staging, to, size);
      device.queue.submit([encoder.finish()]);
      await staging.mapAsync(READ, 0, end);
      // The engine's memory may have grown, but not moved what it waits for.
      this.bytes(words, end).set(new Uint8Array(staging.getMappedRange(0, end)));
      staging.unmap();
      return 1;
    });
  }

  private stage(opened: Opened, bytes: number): GPUBuffer {
    if (opened.staging && opened.staging.size >= bytes) return opened.staging;
    opened.staging?.destroy();
    opened.staging = opened.device.createBuffer({ size: bytes, usage: USAGE.read });
    return opened.staging;
  }

  failure(text: number, room: number): number {
    const { written } = new TextEncoder().encodeInto(this.reason, this.bytes(text, room));
    return written;
  }

  private bytes(at: number, length: number): Uint8Array<ArrayBuffer> {
    return new Uint8Array(this.memory().buffer as ArrayBuffer, at >>> 0, length);
  }

  private number<T>(things: Map<number, T>, thing: T): number {
    this.numbers += 1;
    things.set(this.numbers, thing);
    return this.numbers;
  }

  /** What waits for the open card. */
  private waited(act: (opened: Opened) => Promise<number>): Promise<number> {
    return this.guarded(async () => {
      const answer = await act(this.trusted());
      // It may have failed meanwhile.
      this.trusted();
      return answer;
    });
  }

  /** What is done in its turn, without waiting. */
  private ordered(act: (opened: Opened) => void): number {
    try {
      act(this.trusted());
      return 1;
    } catch (error) {
      return this.fail(error as Error);
    }
  }

  private async guarded(act: () => Promise<number>): Promise<number> {
    try {
      return await act();
    } catch (error) {
      return this.fail(error as Error);
    }
  }

  private trusted(): Opened {
    if (this.opened === null) throw new Error("it is not open");
    if (this.opened.failure !== null) throw new Error(this.opened.failure);
    return this.opened;
  }

  private fail({ message }: Error): number {
    // What the card said first says more.
    this.reason = this.opened?.failure ?? message;
    return 0;
  }
}

function get<T>(things: Map<number, T>, number: number): T {
  const thing = things.get(number);
  if (thing === undefined) throw new Error(`it has no ${number} any more`);
  return thing;
}

/** The imports by their names; those that wait suspend the engine, where that can be. */
export function imports(card: Card): WebAssembly.ModuleImports {
  const { Suspending } = promises;
  const waits = (call: Waiting) => (Suspending ? new Suspending(call) : () => 0);
  return {
    open: waits(() => card.open()),
    most_bytes: () => card.mostBytes(),
    buffer: waits((words) => card.buffer(words)),
    kernel: waits((at, length) => card.kernel(at, length)),
    release: (number: number) => card.release(number),
    write: (...numbers: Parameters<Card["write"]>) => card.write(...numbers),
    launch: (...numbers: Parameters<Card["launch"]>) => card.launch(...numbers),
    read: waits((...numbers) => card.read(...(numbers as Parameters<Card["read"]>))),
    failure: (text: number, room: number) => card.failure(text, room),
  };
}
