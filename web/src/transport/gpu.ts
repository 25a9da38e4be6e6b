/**
 * The graphics card, as the engine in WebAssembly knows it: buffers of words, kernels, and what these bind, by numbers.
 * What is computed there, and on which words, is the engine's business alone.
 *
 * WebGPU answers in promises, and the engine does not wait for any: calls that have to wait suspend it (JavaScript
 * promise integration). A browser that lacks the one or the other has no card for the engine.
 */

import { encode, WORD } from "./commands";
import { Bindings, Compiler, type Kernel, type Text } from "./kernels";

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
  readonly texts = new Map<number, Text>();
  readonly kernels = new Map<number, Kernel>();
  readonly bindings = new Map<number, Bindings>();
  readonly compiler: Compiler;
  /** Where words wait on their way back; it grows, and is kept. */
  staging: GPUBuffer | null = null;

  constructor(readonly device: GPUDevice) {
    this.compiler = new Compiler(device);
    device.lost.then(({ message }) => this.fail(message || "it is lost"));
    device.addEventListener("uncapturederror", ({ error }) => this.fail(error.message));
  }

  fail(reason: string): void {
    this.failure ??= reason;
  }

  /** A buffer, if its memory holds so many words more. */
  async buffer(words: number, usage: number): Promise<GPUBuffer> {
    const { device } = this;
    const size = words * WORD;
    const full = () => new Error(`its memory does not hold ${size} bytes more; simulate fewer worlds`);
    // More than that is no shortage to WebGPU, but a mistake, by which the card would fail.
    if (size > device.limits.maxBufferSize) throw full();
    device.pushErrorScope("out-of-memory");
    const buffer = device.createBuffer({ size, usage });
    if (await device.popErrorScope()) throw full();
    return buffer;
  }

  release(number: number): void {
    this.buffers.get(number)?.destroy();
    for (const things of [this.buffers, this.texts, this.kernels, this.bindings]) things.delete(number);
  }
}

// By number, as the constants are not there where WebGPU is not.
const USAGE = {
  read: 0x1 | 0x8,
  storage: 0x80 | 0x4 | 0x8,
  launches: 0x80 | 0x4 | 0x8 | 0x100,
  uniform: 0x40 | 0x8,
};
const READ = 0x1;
/** What a device is asked for: all that the card has. */
const LIMITS = ["maxStorageBufferBindingSize", "maxBufferSize", "maxComputeWorkgroupsPerDimension"] as const;

/** What the engine imports as `gpu`. All answer 0 where they fail, and `failure` then says why. */
export class Card {
  private opened: Opened | null = null;
  private numbers = 0;
  /** Up to which number things were on a device that has failed, and why it has. */
  private lost = { numbers: 0, reason: "" };
  private reason = "";

  /** `memory` is the engine's. */
  constructor(
    private found: Found | null,
    private readonly memory: () => WebAssembly.Memory,
  ) {}

  /** Opens the card; anew, where it has failed. */
  async open(): Promise<number> {
    const before = this.opened;
    if (before && before.failure === null) return 1;
    try {
      // An adapter gives one device.
      const found = before ? await findCard(navigator.gpu) : (this.found ?? "there is none");
      if (typeof found === "string") throw new Error(found);
      before?.device.destroy();
      this.found = found;
      const requiredLimits = Object.fromEntries(LIMITS.map((limit) => [limit, found.adapter.limits[limit]]));
      this.opened = new Opened(await found.adapter.requestDevice({ requiredLimits }));
      this.lost = { numbers: this.numbers, reason: before?.failure ?? "" };
      return 1;
    } catch (error) {
      this.reason = (error as Error).message;
      return 0;
    }
  }

  /** Whether nothing has gone wrong. */
  check(): number {
    return this.ordered(() => 1);
  }

  mostBytes(): number {
    const limits = this.opened?.device.limits;
    return limits ? Math.min(limits.maxStorageBufferBindingSize, limits.maxBufferSize) : 0;
  }

  mostWorkgroups(): number {
    return this.opened?.device.limits.maxComputeWorkgroupsPerDimension ?? 0;
  }

  /** `launches` is 1 where it is to hold numbers of workgroups. */
  buffer(words: number, launches: number): Promise<number> {
    return this.waited(async (opened) => {
      const buffer = await opened.buffer(words, launches === 1 ? USAGE.launches : USAGE.storage);
      return this.number(opened.buffers, buffer);
    });
  }

  uniform(words: number, count: number): number {
    return this.ordered(({ device, buffers }) => {
      const buffer = device.createBuffer({ size: count * WORD, usage: USAGE.uniform });
      device.queue.writeBuffer(buffer, 0, this.bytes(words, count * WORD));
      return this.number(buffers, buffer);
    });
  }

  text(at: number, length: number): number {
    return this.ordered(({ compiler, texts }) => this.number(texts, compiler.text(this.decoded(at, length))));
  }

  /** Of each binding that it sees, its number and its kind. */
  kernel(text: number, name: number, length: number, seen: number, count: number): number {
    return this.ordered(({ compiler, texts, kernels }) => {
      const words = [...this.words(seen, 2 * count)];
      const [sees, kinds] = [0, 1].map((nth) => words.filter((_, i) => i % 2 === nth));
      const kernel = compiler.kernel(this.get(texts, text), this.decoded(name, length), sees, kinds);
      return this.number(kernels, kernel);
    });
  }

  /** Waits until all kernels are compiled. */
  compiled(): Promise<number> {
    return this.waited(async ({ compiler }) => {
      await compiler.compiled();
      return 1;
    });
  }

  bind(buffers: number, count: number): number {
    return this.ordered((opened) => {
      const bound = [...this.words(buffers, count)].map((number) => this.get(opened.buffers, number));
      return this.number(opened.bindings, new Bindings(bound));
    });
  }

  release(number: number): void {
    this.opened?.release(number);
  }

  write(buffer: number, at: number, words: number, count: number): number {
    return this.ordered(({ device, buffers }) => {
      device.queue.writeBuffer(this.get(buffers, buffer), at * WORD, this.bytes(words, count * WORD));
      return 1;
    });
  }

  submit(words: number, count: number): number {
    return this.ordered(({ device, kernels, bindings, buffers }) => {
      const asked = new Uint32Array(this.memory().buffer, words >>> 0, count);
      const commands = encode(device, asked, {
        kernel: (number) => this.get(kernels, number),
        bindings: (number) => this.get(bindings, number),
        buffer: (number) => this.get(buffers, number),
      });
      device.queue.submit([commands]);
      return 1;
    });
  }

  read(buffer: number, ranges: number, count: number, words: number): Promise<number> {
    const pairs = this.words(ranges, 2 * count);
    return this.waited(async (opened) => {
      const { device, buffers } = opened;
      let end = 0;
      const copies: [from: number, to: number, size: number][] = [];
      for (let i = 0; i < pairs.length; i += 2) {
        copies.push([pairs[i] * WORD, end, pairs[i + 1] * WORD]);
        end += pairs[i + 1] * WORD;
      }
      if (end === 0) return 1;
      const staging = await this.stage(opened, end);
      const encoder = device.createCommandEncoder();
      for (const [from, to, size] of copies)
        encoder.copyBufferToBuffer(this.get(buffers, buffer), from, staging, to, size);
      device.queue.submit([encoder.finish()]);
      await staging.mapAsync(READ, 0, end);
      // The engine's memory may have grown, but not moved what it waits for.
      this.bytes(words, end).set(new Uint8Array(staging.getMappedRange(0, end)));
      staging.unmap();
      return 1;
    });
  }

  private async stage(opened: Opened, bytes: number): Promise<GPUBuffer> {
    if (opened.staging && opened.staging.size >= bytes) return opened.staging;
    opened.staging?.destroy();
    opened.staging = null;
    opened.staging = await opened.buffer(bytes / WORD, USAGE.read);
    return opened.staging;
  }

  failure(text: number, room: number): number {
    const { written } = new TextEncoder().encodeInto(this.reason, this.bytes(text, room));
    return written;
  }

  private bytes(at: number, length: number): Uint8Array<ArrayBuffer> {
    return new Uint8Array(this.memory().buffer as ArrayBuffer, at >>> 0, length);
  }

  /** A copy of what may move. */
  private words(at: number, count: number): Uint32Array {
    return new Uint32Array(this.bytes(at, count * WORD).slice().buffer);
  }

  private decoded(at: number, length: number): string {
    return new TextDecoder().decode(this.bytes(at, length));
  }

  private number<T>(things: Map<number, T>, thing: T): number {
    this.numbers += 1;
    things.set(this.numbers, thing);
    return this.numbers;
  }

  private get<T>(things: Map<number, T>, number: number): T {
    const thing = things.get(number);
    if (thing !== undefined) return thing;
    const { numbers, reason } = this.lost;
    throw new Error(
      number <= numbers ? `${reason}, and with it what it held` : `it has no ${number} any more`,
    );
  }

  /** What waits for the open card. */
  private async waited(act: (opened: Opened) => Promise<number>): Promise<number> {
    try {
      const answer = await act(this.trusted());
      // It may have failed meanwhile.
      this.trusted();
      return answer;
    } catch (error) {
      // That it has may be told after what failed by that.
      await new Promise((told) => setTimeout(told));
      return this.fail(error as Error);
    }
  }

  /** What is done in its turn, without waiting. */
  private ordered(act: (opened: Opened) => number): number {
    try {
      return act(this.trusted());
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

/** The imports by their names; those that wait suspend the engine, where that can be. */
export function imports(card: Card): WebAssembly.ModuleImports {
  const { Suspending } = promises;
  const waits = (call: Waiting) => (Suspending ? new Suspending(call) : () => 0);
  return {
    open: waits(() => card.open()),
    check: () => card.check(),
    most_bytes: () => card.mostBytes(),
    most_workgroups: () => card.mostWorkgroups(),
    buffer: waits((words, launches) => card.buffer(words, launches)),
    uniform: (words: number, count: number) => card.uniform(words, count),
    text: (at: number, length: number) => card.text(at, length),
    kernel: (...numbers: Parameters<Card["kernel"]>) => card.kernel(...numbers),
    compiled: waits(() => card.compiled()),
    bind: (buffers: number, count: number) => card.bind(buffers, count),
    release: (number: number) => card.release(number),
    write: (...numbers: Parameters<Card["write"]>) => card.write(...numbers),
    submit: (words: number, count: number) => card.submit(words, count),
    read: waits((...numbers) => card.read(...(numbers as Parameters<Card["read"]>))),
    failure: (text: number, room: number) => card.failure(text, room),
  };
}
