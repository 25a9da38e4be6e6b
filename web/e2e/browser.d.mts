import type { Browser } from "playwright-core";

/** Flags for WebGPU. */
export const WEBGPU: string[];

/** The browser of `CHROMIUM`, or the system's, with more flags. */
export function launch(more?: string[]): Promise<Browser>;
