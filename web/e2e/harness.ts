/** A browser, and a page in it for each test; pictures of how tests ended go to e2e/out. */

import { writeFileSync } from "node:fs";
import type { Browser, BrowserContextOptions, Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, beforeEach, expect } from "vitest";
import { launch } from "./browser.mjs";

export const ADDRESS = process.env.KINETARIUM_PAGE ?? "";
/** Whether all tests leave a picture, not just those that fail. */
const PICTURES = process.env.KINETARIUM_PICTURES === "1";
export const OUT = new URL("out/", import.meta.url).pathname;

export let browser: Browser;
export let page: Page;
/** Errors that the page did not catch. */
export let broken: string[];

/** Gives each test of a file a page of its own, in a browser with these flags. */
export function pages(options: BrowserContextOptions = {}, flags: string[] = []): void {
  beforeAll(async () => {
    browser = await launch(flags);
  });
  afterAll(() => browser.close());

  beforeEach(async () => {
    const context = await browser.newContext({
      viewport: { width: 1400, height: 860 },
      acceptDownloads: true,
      // What is drawn is drawn by a program: a quarter of the points is enough.
      deviceScaleFactor: 0.5,
      ...options,
    });
    page = await context.newPage();
    broken = [];
    page.on("pageerror", (error) => broken.push(String(error.stack)));
  });
  afterEach(async ({ task }) => {
    if (PICTURES || task.result?.state === "fail")
      await page.screenshot({ path: `${OUT}${task.name.replace(/\W+/g, "_")}.png` });
    await page.context().close();
    expect(broken, "errors of the page").toEqual([]);
  });
}

/** Opens the page with an example, and waits for its first frame. */
export async function open(hash: string): Promise<void> {
  await page.goto(`${ADDRESS}#${hash}`);
  const example = new URLSearchParams(hash).get("example");
  await page.waitForFunction((name) => {
    const { scene, frame } = window.kinetarium ?? {};
    return frame && (name === null || scene?.name === name);
  }, example);
  // A session shared with others may be at any time.
  await page.getByRole("button", { name: "Restart" }).click();
  await page.waitForFunction(() => window.kinetarium.frame?.steps === 0);
}

export async function step(steps: number): Promise<void> {
  const before = await page.evaluate(() => window.kinetarium.frame?.steps ?? 0);
  await page.getByRole("button", { name: String(steps), exact: true }).click();
  await page.waitForFunction((after) => window.kinetarium.frame?.steps === after, before + steps);
}

export const poses = () => page.evaluate(() => [...(window.kinetarium.frame?.poses ?? [])]);

/** The body that is picked; −1 where none is. */
export const picked = () =>
  page.locator(".body-panel select").evaluate((select: HTMLSelectElement) => select.selectedIndex - 1);

/** The middle of the picture on the screen. */
export async function middle(): Promise<{ x: number; y: number }> {
  const box = await page.locator(".stage").boundingBox();
  if (!box) throw new Error("The picture is not to be seen.");
  return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
}

/** Drags a file from the desktop to a point of the window. */
export async function drop(
  name: string,
  content: string | Buffer,
  { x, y }: { x: number; y: number },
): Promise<void> {
  const path = `${OUT}${name}`;
  writeFileSync(path, content);
  const desktop = await page.context().newCDPSession(page);
  const data = { items: [], files: [path], dragOperationsMask: 1 };
  for (const type of ["dragEnter", "dragOver", "drop"] as const) {
    await desktop.send("Input.dispatchDragEvent", { type, x, y, data });
  }
}

/** A GLB of one triangle. */
export function triangle(): Buffer {
  const points = Buffer.from(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]).buffer);
  const json = JSON.stringify({
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] },
    ],
    bufferViews: [{ buffer: 0, byteLength: 36 }],
    buffers: [{ byteLength: 36 }],
  });
  const text = Buffer.from(json.padEnd(Math.ceil(json.length / 4) * 4));
  const word = (...values: number[]) => Buffer.from(new Uint32Array(values).buffer);
  return Buffer.concat([
    word(0x46546c67, 2, 28 + text.length + 36, text.length, 0x4e4f534a),
    text,
    word(36, 0x004e4942),
    points,
  ]);
}
