import type { Browser } from "playwright-core";

/** The browser of `CHROMIUM`, or the system's. */
export function launch(): Promise<Browser>;
