/** An engine in WebAssembly, as the worker holds it. */

import { Card, type Found, imports, promises } from "./gpu";

/** What `engine.wasm` exports. */
export interface EngineExports {
  memory: WebAssembly.Memory;
  /**
   * Makes the session; its first messages are then waiting. 1 where that went well. `card` is 1 where the room
   * holds the name of a graphics card, 2 where it holds why there is none.
   */
  start(card: number): number;
  /** Room for an incoming message of so many bytes of UTF-8. */
  room(length: number): number;
  /** Handles the message in the room. May wait for the card. */
  receive(): void;
  /** Steps as the clock says, and queues messages. 1 where there is more to do at once. May wait for the card. */
  advance(): number;
  /** Takes the next outgoing message: 0 none, 1 text, 2 binary. */
  next(): number;
  /** Where the message taken lies. */
  message(): number;
  message_length(): number;
}

/** A message that the engine gave. */
export type Outgoing = string | ArrayBuffer;

/**
 * The engine. While it waits for its graphics card, in `receive` or `advance`, nothing else of it may be called: who
 * holds it lets one call end before the next.
 */
export class Engine {
  private readonly doReceive: () => Promise<void>;
  private readonly doAdvance: () => Promise<number>;

  /** Throws where the session cannot be made. `card` is the card that was found, or why there is none. */
  constructor(
    private readonly wasm: EngineExports,
    card: Found | string,
  ) {
    const [kind, told] = typeof card === "string" ? [2, card] : [1, card.name];
    this.fill(told);
    if (wasm.start(kind) !== 1) throw new Error("it could not make its first scene");
    const { receive, advance } = wasm;
    this.doReceive = waiting(receive, kind === 1);
    this.doAdvance = waiting(advance, kind === 1);
  }

  static async load(address: string, finding: Promise<Found | string>): Promise<Engine> {
    const response = await fetch(address);
    if (!response.ok) throw new Error(`${address} cannot be had: ${response.status} ${response.statusText}`);
    const [bytes, card] = await Promise.all([response.arrayBuffer(), finding]);
    return Engine.of(bytes, card);
  }

  /** From `engine.wasm`. */
  static async of(bytes: BufferSource, found: Found | string): Promise<Engine> {
    let exports: EngineExports;
    const card = new Card(typeof found === "string" ? null : found, () => exports.memory);
    // A clock that never goes back, in seconds.
    const page = { now: () => performance.now() / 1000 };
    const { instance } = await WebAssembly.instantiate(bytes, { page, gpu: imports(card) });
    exports = instance.exports as unknown as EngineExports;
    return new Engine(exports, found);
  }

  async receive(json: string): Promise<void> {
    this.fill(json);
    await this.doReceive();
  }

  /** Steps as the clock says. Returns whether there is more to do at once. */
  async advance(): Promise<boolean> {
    return (await this.doAdvance()) === 1;
  }

  /** Takes all messages that wait, in order. */
  *outgoing(): Generator<Outgoing> {
    for (let kind = this.wasm.next(); kind !== 0; kind = this.wasm.next()) {
      const pointer = this.wasm.message();
      const bytes = this.wasm.memory.buffer.slice(pointer, pointer + this.wasm.message_length());
      yield kind === 1 ? new TextDecoder().decode(bytes) : bytes;
    }
  }

  private fill(text: string): void {
    const bytes = new TextEncoder().encode(text);
    const pointer = this.wasm.room(bytes.length);
    new Uint8Array(this.wasm.memory.buffer, pointer, bytes.length).set(bytes);
  }
}

/** An export that may be suspended, where there is what it waits for. */
function waiting<T>(exported: () => T, waits: boolean): () => Promise<T> {
  return waits && promises.promising ? promises.promising(exported) : async () => exported();
}
