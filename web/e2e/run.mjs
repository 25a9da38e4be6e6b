/**
 * `npm run e2e -- --url URL`: tests the page that is served at an address, with the engine behind it.
 *
 * `--engine` instead serves web/dist itself, with the engine named: the path of an `engine.wasm`, or the
 * address of an engine's server. Pictures of tests that fail go to e2e/out, with KINETARIUM_PICTURES=1 of all.
 */

import { mkdirSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { startVitest } from "vitest/node";
import { serve } from "./serve.mjs";

const { values } = parseArgs({
  options: { url: { type: "string" }, engine: { type: "string" }, only: { type: "string" } },
});
if (!values.url === !values.engine) {
  console.error(
    "Say where the page is, with --url URL, or which engine it is to have, with --engine PATH|URL.",
  );
  process.exit(2);
}

const server = values.engine ? await serve(values.engine) : null;
process.env.KINETARIUM_PAGE = values.url ?? server.address;
mkdirSync(new URL("out/", import.meta.url), { recursive: true });
const vitest = await startVitest("test", [], {
  root: fileURLToPath(new URL("..", import.meta.url)),
  include: ["e2e/**/*.e2e.ts"],
  // They may share a session, and do share the processor.
  fileParallelism: false,
  testTimeout: 180_000,
  hookTimeout: 180_000,
  // A card is a program here, which compiles kernels for seconds where the machine is busy.
  expect: { poll: { timeout: 60_000 } },
  watch: false,
  ...(values.only && { testNamePattern: values.only }),
});
await vitest.close();
server?.close();
