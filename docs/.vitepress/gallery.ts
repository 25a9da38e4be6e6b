/** The examples, as the engine itself tells them: no text of theirs is written here. */

import { readFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { Engine } from "../../web/src/transport/engine";

const BUILT = "../../target/wasm32-unknown-unknown/release/kinetarium_wasm.wasm";
/** Path of `engine.wasm`: `KINETARIUM_ENGINE`, or where cargo builds it. */
const ENGINE = process.env.KINETARIUM_ENGINE ?? fileURLToPath(new URL(BUILT, import.meta.url));

export interface Example {
  name: string;
  title: string;
  /** What there is to see, in a line. */
  about: string;
  /** What to try, and what to observe. */
  guide: string;
}

async function read(): Promise<Example[]> {
  const engine = await Engine.of(await readFile(ENGINE), "none is needed to build the site");
  const messages = [...engine.outgoing()].filter((message) => typeof message === "string");
  const welcome = messages.map((json) => JSON.parse(json)).find(({ type }) => type === "welcome");
  if (!welcome) throw new Error(`${ENGINE} names no examples; build it with \`cargo xtask docs\``);
  return welcome.examples;
}

export const gallery = await read();
