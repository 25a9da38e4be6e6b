/** Simulations on a graphics card: on SwiftShader, a program that stands in for one. */

import { expect, test } from "vitest";
import { HEADER, POSE } from "../src/frame";
import { WEBGPU } from "./browser.mjs";
import { ADDRESS, browser, drop, middle, OUT, open, page, pages, poses, step } from "./harness";
import { reference } from "./reference";

// A small picture: the same processor draws it and computes.
pages({ viewport: { width: 1100, height: 300 } }, WEBGPU);

const card = () => page.evaluate(() => window.kinetarium.status?.card ?? null);
const time = () => page.evaluate(() => window.kinetarium.frame?.time ?? -1);
const notice = () => page.locator(".notice").textContent();
const place = () => page.getByRole("combobox", { name: "Runs on" });

/** Opens an example on the card. */
async function openThere(hash: string): Promise<void> {
  await open(`${hash}&physics.runs_on=1`);
  expect(await card()).toContain("swiftshader");
}

/** Poses of the same on the processor, after these commands, that end with so many steps. */
async function here(...commands: object[]): Promise<number[]> {
  const other = await reference(ADDRESS, browser);
  const bytes = await other.frame(...commands);
  await other.close();
  const header = new DataView(bytes.buffer);
  const count = header.getUint32(28, true) * header.getUint32(32, true);
  return [...new Float32Array(bytes.buffer, HEADER, POSE * count)];
}
const pendula = (steps: number) => here({ type: "open", example: "pendula" }, { type: "step", steps });

function distance(a: number[], b: number[]): number {
  expect(a.length).toBeGreaterThan(0);
  expect(a.length).toBe(b.length);
  return Math.max(...a.map((x, i) => Math.abs(x - b[i])));
}

test("a card steps as the processor does", async () => {
  await openThere("example=pendula");
  await step(1);
  const start = await poses();
  expect(distance(start, await pendula(1))).toBeLessThan(1e-5);
  await step(100);
  const end = await poses();
  expect(distance(end, await pendula(101))).toBeLessThan(1e-3);
  expect(distance(end, start)).toBeGreaterThan(0.1);
  expect(await card()).toContain("swiftshader");
  expect(await page.locator(".guide .facts").textContent()).toContain("swiftshader");
});

/** A box that falls onto the ground, askew. */
const BOX = `<mujoco model="box">
  <worldbody>
    <geom type="plane" size="5 5 0.1"/>
    <body name="box" pos="0 0 0.3" euler="20 10 0">
      <freejoint/>
      <geom type="box" size="0.2 0.15 0.1" density="500"/>
    </body>
  </worldbody>
</mujoco>`;

test("what falls comes to rest on a card as on the processor", async () => {
  await open("example=pendula");
  await drop("box.xml", BOX, await middle());
  await page.waitForFunction(() => window.kinetarium.scene?.name === "box.xml");
  await place().selectOption("graphics card");
  await expect.poll(card).toContain("swiftshader");
  const start = await poses();
  for (let i = 0; i < 6; i++) await step(100);
  const end = await poses();
  const open_box = { type: "file", name: "box.xml", text: BOX };
  expect(distance(end, await here(open_box, { type: "step", steps: 600 }))).toBeLessThan(1e-3);
  // Flat on the ground, half its height above it.
  expect(distance(end, start)).toBeGreaterThan(0.1);
  expect(Math.abs(end[2] - 0.1)).toBeLessThan(2e-3);
  await step(10);
  expect(distance(await poses(), end)).toBeLessThan(1e-4);
  expect(await card()).toContain("swiftshader");
});

test("a card is chosen on the page, and the address keeps it", async () => {
  await open("example=pendula");
  expect(await card()).toBe(null);
  await step(10);
  const before = await poses();
  await place().selectOption("graphics card");
  await expect.poll(card).toContain("swiftshader");
  // The state has moved there.
  expect(await time()).toBeGreaterThan(0);
  expect(await poses()).toEqual(before);
  await step(10);
  expect(distance(await poses(), await pendula(20))).toBeLessThan(1e-3);
  await page.waitForFunction(() => location.hash.includes("physics.runs_on=1"));
  await page.screenshot({ path: `${OUT}card.png` });
  await page.reload();
  await page.waitForFunction(() => window.kinetarium?.status?.card && window.kinetarium.frame?.steps === 0);
  await place().selectOption("processor");
  await expect.poll(card).toBe(null);
});

test("on a card joints follow sliders, and the past can be returned to", async () => {
  await openThere("example=prismatic");
  const drive = page.locator("details.drive").first();
  await drive.locator("summary").click();
  const digits = drive.locator('input[type="number"]').first();
  const target = await digits.evaluate((input: HTMLInputElement) => Number(input.value) + 0.25);
  await digits.fill(String(target));
  await digits.press("Enter");
  await step(100);
  await step(100);
  const after = await poses();
  const example = { type: "open", example: "prismatic" };
  const steps = { type: "step", steps: 200 };
  const followed = await here(example, { type: "joint", dof: 0, position: target }, steps);
  expect(distance(after, followed)).toBeLessThan(1e-3);
  expect(distance(after, await here(example, steps))).toBeGreaterThan(0.01);
  const half = (await time()) / 2;
  await page.getByRole("slider", { name: "Time", exact: true }).evaluate((input: HTMLInputElement, half) => {
    input.value = String(half);
    input.dispatchEvent(new Event("input"));
    input.dispatchEvent(new Event("change"));
  }, half);
  await page.waitForFunction(
    (half) => Math.abs((window.kinetarium.frame?.time ?? 0) - half) < 0.1 * half,
    half,
  );
  expect(await poses()).not.toEqual(after);
  await step(1);
  expect(await card()).toContain("swiftshader");
});

test("on a card bodies are drawn and pushed by hand", async () => {
  await openThere("example=prismatic");
  // Picks the body, and brings it into the middle.
  await page.locator(".stage").focus();
  await page.keyboard.press("j");
  await page.keyboard.press("f");
  await page.getByRole("button", { name: "Push", exact: true }).last().click();
  await step(1);
  const pushed = await poses();
  await page.getByRole("button", { name: "Restart" }).click();
  await page.waitForFunction(() => window.kinetarium.frame?.steps === 0);
  await step(1);
  expect(distance(await poses(), pushed)).toBeGreaterThan(1e-4);
  await page.getByRole("button", { name: "Run", exact: true }).click();
  const { x, y } = await middle();
  await page.keyboard.down("Control");
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 1; i <= 5; i++) await page.mouse.move(x, y - 8 * i);
  await page.waitForFunction(() => (window.kinetarium.frame?.steps ?? 0) > 20);
  await page.mouse.up();
  await page.keyboard.up("Control");
  await page.getByRole("button", { name: "Stop" }).click();
  expect(await page.locator(".notice").isVisible()).toBe(false);
  expect(await card()).toContain("swiftshader");
});

test("what is built anew stays on its card, with as many worlds as are shown", async () => {
  await openThere("example=pendula");
  const links = page.getByRole("spinbutton", { name: "Links" });
  await links.fill("5");
  await links.press("Enter");
  await page.locator(".toolbar").getByRole("button", { name: "Rebuild" }).click();
  await page.waitForFunction(() => window.kinetarium.scene?.bodies.length === 5);
  await page.getByRole("combobox", { name: "Replicas shown" }).selectOption("4 shown");
  await page.waitForFunction(() => window.kinetarium.frame?.worlds === 4);
  await step(10);
  expect(await card()).toContain("swiftshader");
});

/** Bytes that are less than a state, and more than all else that a step writes. */
const STATE = 4096;

/** Has the page count how often it writes as much as a state into the card's memory. */
async function counted(): Promise<() => Promise<number>> {
  const [worker] = page.workers();
  await worker.evaluate((least) => {
    const write = GPUQueue.prototype.writeBuffer;
    const counts = Object.assign(globalThis, { writes: 0 });
    GPUQueue.prototype.writeBuffer = function (...all: Parameters<GPUQueue["writeBuffer"]>) {
      counts.writes += Number(all[2].byteLength >= least);
      return write.apply(this, all);
    };
  }, STATE);
  return () => worker.evaluate(() => (globalThis as unknown as { writes: number }).writes);
}

test("piles on a card do as on the processor: several worlds, joints, what bounces, meshes", async () => {
  await open("example=balls");
  const writes = await counted();
  for (const [example, tens] of [
    ["pendula", 3],
    ["collide", 12],
    ["terrain", 3],
  ] as const) {
    const others = await writes();
    await openThere(`example=${example}&physics.solver=3`);
    expect(await page.evaluate(() => window.kinetarium.scene?.solver)).toBe("impulse");
    await step(1);
    const start = await poses();
    const before = await writes();
    expect(before).toBeGreaterThan(others);
    for (let i = 0; i < tens; i++) await step(10);
    // No state comes back that the processor has stepped.
    expect((await writes()) - before).toBe(0);
    const end = await poses();
    const solver = { type: "physics", values: { solver: 3 } };
    const there = await here({ type: "open", example }, solver, { type: "step", steps: 10 * tens + 1 });
    expect(distance(end, there)).toBeLessThan(1e-3);
    expect(distance(end, start)).toBeGreaterThan(0.01);
    expect(await card()).toContain("swiftshader");
  }
});

test("what a card cannot run is told, and all is as before", async () => {
  await open("example=balls");
  // A card of less memory than any has.
  await page.workers()[0].evaluate(() => {
    const ask = GPUAdapter.prototype.requestDevice;
    GPUAdapter.prototype.requestDevice = async function (wanted) {
      const device = await ask.call(this, wanted);
      return Object.defineProperty(device, "limits", {
        value: { maxBufferSize: 256, maxStorageBufferBindingSize: 256, maxComputeWorkgroupsPerDimension: 64 },
      });
    };
  });
  await step(1);
  const before = await poses();
  await place().selectOption("graphics card");
  await expect.poll(notice).toMatch(/bytes in one buffer, of which the card `.*swiftshader` takes 256/);
  expect(await poses()).toEqual(before);
  await expect.poll(() => place().inputValue()).toBe("processor");
  expect(await card()).toBe(null);
});

test.each(["pendula", "collide&physics.solver=3"])(
  "the processor takes over %s from a card that is lost, which can be chosen again",
  async (example) => {
    await open(`example=${example}`);
    const [worker] = page.workers();
    // Its device, once it asks for one.
    await worker.evaluate(() => {
      const ask = GPUAdapter.prototype.requestDevice;
      GPUAdapter.prototype.requestDevice = async function (wanted) {
        const device = await ask.call(this, wanted);
        Object.assign(globalThis, { lose: () => device.destroy() });
        return device;
      };
    });
    await place().selectOption("graphics card");
    await expect.poll(card).toContain("swiftshader");
    await step(10);
    const before = await time();
    await worker.evaluate(() => (globalThis as unknown as { lose(): void }).lose());
    await page.getByRole("button", { name: "10", exact: true }).click();
    await expect.poll(notice).toContain("The processor has taken over");
    await expect.poll(card).toBe(null);
    expect(await place().inputValue()).toBe("processor");
    // At most a thirtieth of a second is lost.
    expect(before - (await time())).toBeLessThan(1 / 30);
    await step(10);
    await place().selectOption("graphics card");
    await expect.poll(card).toContain("swiftshader");
    await step(10);
    expect(await card()).toContain("swiftshader");
  },
);
