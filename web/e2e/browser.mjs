/** Chromium without a screen, drawing in software. */

import { existsSync } from "node:fs";
import { chromium } from "playwright-core";

const FLAGS = [
  "--no-sandbox",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--enable-unsafe-swiftshader",
  // A page whose text a test gives may reach this machine, too.
  "--disable-features=LocalNetworkAccessChecks",
];

/** WebGPU, computed in software, too. */
export const WEBGPU = ["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader"];

/** The browser of `CHROMIUM`, or the system's. */
export function launch(more = []) {
  const usual = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
  const executablePath = process.env.CHROMIUM ?? usual.find((path) => existsSync(path));
  if (!executablePath) throw new Error("There is no Chromium. Install it, or name it in CHROMIUM.");
  return chromium.launch({ executablePath, args: [...FLAGS, ...more] });
}
