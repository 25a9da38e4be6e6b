/** Another connection to the engine, which knows nothing of the page's code for it. */

import type { Browser, Page } from "playwright-core";

/** An engine's last frame, as bytes. */
export interface Reference {
  /** The last frame after a command, or the present one. */
  frame(...commands: object[]): Promise<Uint8Array>;
  close(): Promise<void>;
}

/** The engine behind a page: its server's session once more, or another engine from the same `engine.wasm`. */
export async function reference(address: string, browser: Browser): Promise<Reference> {
  const html = await (await fetch(address)).text();
  if (/kinetarium-engine" content="websocket"/.test(html))
    return new Connection(await plainPage(address, browser));
  return Machine.load(new URL("engine.wasm", address).href);
}

async function plainPage(address: string, browser: Browser): Promise<Page> {
  const page = await browser.newPage();
  await page.route(address, (route) => route.fulfill({ contentType: "text/html", body: "<p>plain</p>" }));
  await page.goto(address);
  return page;
}

/** A WebSocket of a page without code. */
class Connection implements Reference {
  constructor(private readonly page: Page) {}

  async frame(): Promise<Uint8Array> {
    const bytes = await this.page.evaluate(async () => {
      const address = new URL("session", location.href);
      address.protocol = "ws:";
      const socket = new WebSocket(address);
      socket.binaryType = "arraybuffer";
      const frame = await new Promise<ArrayBuffer>((done) => {
        socket.onmessage = ({ data }) => {
          if (data instanceof ArrayBuffer) done(data);
        };
      });
      socket.close();
      return [...new Uint8Array(frame)];
    });
    return new Uint8Array(bytes);
  }

  close(): Promise<void> {
    return this.page.close();
  }
}

/** An engine of its own, driven by the same commands. */
class Machine implements Reference {
  private constructor(
    private readonly wasm: Record<string, CallableFunction> & { memory: WebAssembly.Memory },
  ) {
    wasm.start();
  }

  static async load(address: string): Promise<Machine> {
    const bytes = await (await fetch(address)).arrayBuffer();
    // It has no graphics card, and asks for none.
    const gpu = new Proxy({}, { get: () => () => 0 });
    const imports = { page: { now: () => performance.now() / 1000 }, gpu };
    const { instance } = await WebAssembly.instantiate(bytes, imports);
    return new Machine(instance.exports as never);
  }

  async frame(...commands: object[]): Promise<Uint8Array> {
    const { wasm } = this;
    for (const command of commands) {
      const bytes = new TextEncoder().encode(JSON.stringify(command));
      const room = wasm.room(bytes.length);
      new Uint8Array(wasm.memory.buffer, room, bytes.length).set(bytes);
      wasm.receive();
      while (wasm.advance() === 1);
    }
    // A frame comes once a sixtieth of a second.
    await new Promise((done) => setTimeout(done, 50));
    wasm.advance();
    let last = new Uint8Array();
    for (let kind = wasm.next(); kind !== 0; kind = wasm.next()) {
      const at = wasm.message();
      if (kind === 2) last = new Uint8Array(wasm.memory.buffer.slice(at, at + wasm.message_length()));
    }
    return last;
  }

  async close(): Promise<void> {}
}
