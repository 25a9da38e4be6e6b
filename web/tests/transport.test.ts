import { afterEach, beforeEach, describe, expect, test, vi } from "vitest";
import type { Command } from "../src/protocol";
import { Decimator } from "../src/transport/decimate";
import { Engine, type EngineExports } from "../src/transport/engine";
import type { Receiver } from "../src/transport/transport";
import { sessionAddress, WebSocketTransport } from "../src/transport/websocket";

test("the session is beside the page, and its token goes along", () => {
  expect(sessionAddress("http://localhost:8080/")).toBe("ws://localhost:8080/session");
  expect(sessionAddress("https://lab/demo/index.html?token=a%2Bb&x=1#example=tower")).toBe(
    "wss://lab/demo/session?token=a%2Bb",
  );
});

describe("frames are passed on as fast as they are drawn", () => {
  const frame = (n: number) => new Uint8Array([n]).buffer;
  const seen: number[] = [];
  const decimator = () => new Decimator((bytes) => seen.push(new Uint8Array(bytes)[0]));
  beforeEach(() => void seen.splice(0));

  test("the first at once, of those that wait the last", () => {
    const frames = decimator();
    for (const n of [1, 2, 3]) frames.offer(frame(n));
    expect(seen).toEqual([1]);
    frames.drawn();
    expect(seen).toEqual([1, 3]);
    frames.drawn();
    frames.offer(frame(4));
    expect(seen).toEqual([1, 3, 4]);
  });
});

describe("an engine in WebAssembly", () => {
  /** Answers every message with itself, as text and then as bytes; its room moves when memory grows. */
  function echo(): EngineExports {
    const memory = new WebAssembly.Memory({ initial: 1 });
    const queue: number[] = [];
    let [place, length] = [0, 0];
    return {
      memory,
      start: () => 1,
      room: (wanted) => {
        memory.grow(1);
        place = 65536;
        length = wanted;
        return place;
      },
      receive: () => void queue.push(1, 2),
      advance: () => 0,
      next: () => queue.shift() ?? 0,
      message: () => place,
      message_length: () => length,
    };
  }

  test("texts are UTF-8, and memory may grow", async () => {
    const engine = new Engine(echo(), "none");
    await engine.receive('{"é":"−1"}');
    const [text, bytes] = engine.outgoing();
    expect(text).toBe('{"é":"−1"}');
    expect(new TextDecoder().decode(bytes as ArrayBuffer)).toBe(text);
    expect([...engine.outgoing()]).toEqual([]);
    expect(await engine.advance()).toBe(false);
  });

  test("one that cannot start is told", () => {
    expect(() => new Engine({ ...echo(), start: () => 0 }, "none")).toThrow("could not make its first scene");
  });

  test("it is told of the card, or why there is none", () => {
    const told = (card: ConstructorParameters<typeof Engine>[1]) => {
      const wasm = echo();
      const said: [number, string][] = [];
      let room = 0;
      const start = (kind: number) => {
        said.push([kind, new TextDecoder().decode(new Uint8Array(wasm.memory.buffer, 65536, room))]);
        return 1;
      };
      new Engine(
        {
          ...wasm,
          start,
          room: (length) => {
            room = length;
            return wasm.room(length);
          },
        },
        card,
      );
      return said;
    };
    expect(told("no WebGPU")).toEqual([[2, "no WebGPU"]]);
    expect(told({ name: "a card", adapter: {} as GPUAdapter })).toEqual([[1, "a card"]]);
  });
});

describe("a WebSocket", () => {
  class Socket {
    static readonly OPEN = 1;
    static all: Socket[] = [];
    readyState = 0;
    sent: string[] = [];
    onopen = () => {};
    onclose = () => {};
    onmessage = (_: { data: unknown }) => {};
    constructor(readonly address: string) {
      Socket.all.push(this);
    }
    send(text: string) {
      this.sent.push(text);
    }
    close() {
      this.onclose();
    }
    open() {
      this.readyState = Socket.OPEN;
      this.onopen();
    }
  }
  const told: unknown[] = [];
  const receiver: Receiver = {
    connected: (yes) => told.push(yes),
    text: (json) => told.push(json),
    binary: (bytes) => told.push(bytes.byteLength),
    failed: (reason) => told.push(reason),
  };
  beforeEach(() => {
    vi.useFakeTimers();
    vi.stubGlobal("WebSocket", Socket);
    Socket.all = [];
    told.length = 0;
  });
  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });

  test("commands go out once it is open, messages come in", () => {
    const transport = new WebSocketTransport("ws://host/session", receiver);
    const [socket] = Socket.all;
    const run: Command = { type: "run" };
    transport.send(run);
    socket.open();
    transport.send(run);
    expect(socket.sent).toEqual(['{"type":"run"}']);
    socket.onmessage({ data: "{}" });
    socket.onmessage({ data: new ArrayBuffer(8) });
    expect(told).toEqual([true, "{}", 8]);
  });

  test("of frames that come while one is drawn, the last is passed on", () => {
    const transport = new WebSocketTransport("ws://host/session", receiver);
    const [socket] = Socket.all;
    for (const length of [1, 2, 3]) socket.onmessage({ data: new ArrayBuffer(length) });
    expect(told).toEqual([1]);
    transport.drawn();
    expect(told).toEqual([1, 3]);
  });

  test("it connects again, with longer and longer waits, until closed", () => {
    const transport = new WebSocketTransport("ws://host/session", receiver);
    Socket.all[0].close();
    vi.advanceTimersByTime(249);
    expect(Socket.all.length).toBe(1);
    vi.advanceTimersByTime(1);
    expect(Socket.all.length).toBe(2);
    Socket.all[1].close();
    vi.advanceTimersByTime(499);
    expect(Socket.all.length).toBe(2);
    vi.advanceTimersByTime(1);
    Socket.all[2].open();
    expect(told).toEqual([false, false, true]);
    transport.close();
    vi.advanceTimersByTime(60_000);
    expect(Socket.all.length).toBe(3);
  });
});
