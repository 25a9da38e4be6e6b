// As crates/session/examples/frames.rs, of the engine for browsers: `node frames.mjs engine.wasm`.

import { readFileSync } from "node:fs";

const HEADER = 60;
// A graphics card that is missing.
const gpu = new Proxy({}, { get: () => () => 0 });
const module = new WebAssembly.Module(readFileSync(process.argv[2]));

/** The engine, and the messages that it has not told yet. */
function engine() {
  const { exports } = new WebAssembly.Instance(module, { page: { now: () => 0 }, gpu });
  const bytes = (at, length) => new Uint8Array(exports.memory.buffer, at, length);
  return {
    say(command) {
      const text = new TextEncoder().encode(JSON.stringify(command));
      const at = exports.room(text.length);
      bytes(at, text.length).set(text);
      exports.receive();
    },
    work() {
      while (exports.advance() === 1);
    },
    *messages() {
      for (let kind = exports.next(); kind !== 0; kind = exports.next()) {
        yield { kind, bytes: bytes(exports.message(), exports.message_length()).slice() };
      }
    },
    start: () => exports.start(),
  };
}

function hash(bytes) {
  let hash = 0xcbf29ce484222325n;
  for (const byte of bytes) hash = BigInt.asUintN(64, (hash ^ BigInt(byte)) * 0x100000001b3n);
  return hash.toString(16).padStart(16, "0");
}

const first = engine();
if (first.start() !== 1) throw new Error("the engine does not start");
const welcome = JSON.parse(new TextDecoder().decode(first.messages().next().value.bytes));
for (const { name } of welcome.examples) {
  const own = engine();
  own.start();
  own.say({ type: "open", example: name });
  own.say({ type: "step", steps: 100 });
  own.work();
  const frames = [...own.messages()].filter(({ kind }) => kind === 2);
  console.log(name, hash(frames.at(-1).bytes.subarray(HEADER)));
}
