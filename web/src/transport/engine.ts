/** An engine in WebAssembly, as the worker holds it. */

/** What `engine.wasm` exports. */
export interface EngineExports {
  memory: WebAssembly.Memory;
  /** Makes the session; its first messages are then waiting. 1 where that went well. */
  start(): number;
  /** Room for an incoming message of so many bytes of UTF-8. */
  room(length: number): number;
  /** Handles the message in the room. */
  receive(): void;
  /** Steps as the clock says, and queues messages. 1 where there is more to do at once. */
  advance(): number;
  /** Takes the next outgoing message: 0 none, 1 text, 2 binary. */
  next(): number;
  /** Where the message taken lies. */
  message(): number;
  message_length(): number;
}

/** What it imports: seconds of a clock that never goes back. */
const IMPORTS = { page: { now: () => performance.now() / 1000 } };

/** A message that the engine gave. */
export type Outgoing = string | ArrayBuffer;

export class Engine {
  /** Throws where the session cannot be made. */
  constructor(private readonly wasm: EngineExports) {
    if (wasm.start() !== 1) throw new Error("it could not make its first scene");
  }

  static async load(address: string): Promise<Engine> {
    const response = await fetch(address);
    if (!response.ok) throw new Error(`${address} cannot be had: ${response.status} ${response.statusText}`);
    const { instance } = await WebAssembly.instantiate(await response.arrayBuffer(), IMPORTS);
    return new Engine(instance.exports as unknown as EngineExports);
  }

  receive(json: string): void {
    const bytes = new TextEncoder().encode(json);
    const pointer = this.wasm.room(bytes.length);
    new Uint8Array(this.wasm.memory.buffer, pointer, bytes.length).set(bytes);
    this.wasm.receive();
  }

  /** Steps as the clock says. Returns whether there is more to do at once. */
  advance(): boolean {
    return this.wasm.advance() === 1;
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
