/** An engine in WebAssembly, as the worker holds it. */

/** What `engine.wasm` exports; it imports nothing. */
export interface EngineExports {
  memory: WebAssembly.Memory;
  /** Makes the session; its first messages are then waiting. */
  start(): void;
  /** Room for an incoming message of so many bytes of UTF-8. */
  room(length: number): number;
  /** Handles the message in the room. */
  receive(): void;
  /** Steps as the clock says [ms], and queues messages. */
  advance(now: number): void;
  /** Takes the next outgoing message: 0 none, 1 text, 2 binary. */
  next(): number;
  /** Where the message taken lies. */
  message(): number;
  message_length(): number;
}

/** A message that the engine gave. */
export type Outgoing = string | ArrayBuffer;

export class Engine {
  constructor(private readonly wasm: EngineExports) {
    wasm.start();
  }

  static async load(address: string): Promise<Engine> {
    const response = await fetch(address);
    if (!response.ok) throw new Error(`${address} cannot be had: ${response.status} ${response.statusText}`);
    const { instance } = await WebAssembly.instantiate(await response.arrayBuffer(), {});
    return new Engine(instance.exports as unknown as EngineExports);
  }

  receive(json: string): void {
    const bytes = new TextEncoder().encode(json);
    const pointer = this.wasm.room(bytes.length);
    new Uint8Array(this.wasm.memory.buffer, pointer, bytes.length).set(bytes);
    this.wasm.receive();
  }

  advance(now: number): void {
    this.wasm.advance(now);
  }

  /** Takes all messages that wait, in order. */
  *outgoing(): Generator<Outgoing> {
    for (let kind = this.wasm.next(); kind !== 0; kind = this.wasm.next()) {
      const pointer = this.wasm.message();
      const bytes = this.wasm.memory.buffer.slice(pointer, pointer + this.wasm.message_length());
      yield kind === 1 ? new TextDecoder().decode(bytes) : bytes;
    }
  }
}
