/** `npm run bench`: times of reading and drawing frames made up, in Chromium. */

import { createServer } from "vite";
import { launch } from "../e2e/browser.mjs";

const CASES = [
  ["humanoids", "64 figures of 15 bodies", 40],
  ["particles", "100,000 particles", 40],
];

const server = await createServer({ server: { port: 0 }, logLevel: "error" });
await server.listen();
const address = server.resolvedUrls.local[0];
const browser = await launch();
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  await page.goto(`${address}bench/index.html`);
  await page.waitForFunction(() => "bench" in window);
  for (const [name, title, frames] of CASES) {
    const { update, frame, bytes } = await page.evaluate(([n, f]) => window.bench(n, f), [name, frames]);
    console.log(
      `${title}: ${update.toFixed(2)} ms to read and place, ${frame.toFixed(1)} ms with its picture;`,
      `${(1e-3 * bytes).toFixed(1)} kB a frame, ${(60e-6 * bytes).toFixed(1)} MB/s at 60 frames a second`,
    );
  }
} finally {
  await browser.close();
  await server.close();
}
