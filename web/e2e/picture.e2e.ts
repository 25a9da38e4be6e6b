/** The picture, and the page about it, when something is missing or comes later. */

import { readFileSync } from "node:fs";
import { expect, test } from "vitest";
import { ADDRESS, broken, drop, middle, OUT, open, page, pages, step } from "./harness";

// Small, since a processor draws it.
pages({ viewport: { width: 1120, height: 640 }, deviceScaleFactor: 1 });

const notice = () => page.locator(".notice");
const stage = () => page.locator(".stage");
const press = async (key: string, times = 1) => {
  for (let i = 0; i < times; i++) await page.keyboard.press(key);
};

test("a film of what does not move has pictures", async () => {
  await open("example=arch");
  await page.getByRole("button", { name: "Record" }).click();
  await page.waitForTimeout(1500);
  const coming = page.waitForEvent("download");
  await page.getByRole("button", { name: "Record" }).click();
  await (await coming).saveAs(`${OUT}still.webm`);
  expect(readFileSync(`${OUT}still.webm`).readUInt32BE(0)).toBe(0x1a45dfa3);
  expect(await page.getByRole("button", { name: "Record" }).getAttribute("aria-pressed")).toBe("false");
});

test("a browser that records no films says so", async () => {
  await page.addInitScript(() => Reflect.deleteProperty(window, "MediaRecorder"));
  await open("example=arch");
  await page.getByRole("button", { name: "Record" }).click();
  expect(await notice().textContent()).toContain("cannot record WebM");
});

test("without WebGL the page says what it needs", async () => {
  await page.addInitScript(() => {
    HTMLCanvasElement.prototype.getContext = () => null;
  });
  await page.goto(ADDRESS);
  await page.waitForSelector("[role=alert]");
  expect(await page.locator("[role=alert]").textContent()).toContain("WebGL 2");
});

test("the picture comes back with the graphics card", async () => {
  await open("example=tower");
  const before = await stage().screenshot();
  await page.evaluate(() => {
    const context = document.querySelector<HTMLCanvasElement>(".stage")?.getContext("webgl2");
    const lost = context?.getExtension("WEBGL_lose_context");
    Object.assign(window, { lost });
    lost?.loseContext();
  });
  await expect.poll(() => notice().isVisible()).toBe(true);
  expect(await notice().textContent()).toContain("graphics card away");
  await page.evaluate(() => (window as unknown as { lost: WEBGL_lose_context }).lost.restoreContext());
  await expect.poll(() => notice().isVisible()).toBe(false);
  await expect.poll(async () => (await stage().screenshot()).equals(before)).toBe(true);
});

test("the picture is as fine as the screen that it is on", async () => {
  await open("example=tower");
  const width = () => stage().evaluate((canvas: HTMLCanvasElement) => canvas.width / canvas.clientWidth);
  expect(await width()).toBe(1);
  const screen = await page.context().newCDPSession(page);
  await screen.send("Emulation.setDeviceMetricsOverride", {
    width: 1400,
    height: 860,
    deviceScaleFactor: 2,
    mobile: false,
  });
  await expect.poll(width).toBe(2);
});

test("the page says that its engine is yet to come, or away, whatever else it says", async () => {
  await page.addInitScript(() => {
    const Native = window.Worker;
    window.Worker = class extends Native {
      constructor(address: string, options?: WorkerOptions) {
        super(address, options);
        Object.assign(window, { worker: this });
      }
    } as never;
  });
  const connection = page.locator(".connection");
  let load = () => {};
  const waiting = new Promise<void>((done) => {
    load = done;
  });
  await page.route("**/engine.wasm", async (route) => {
    await waiting;
    await route.continue();
  });
  await page.goto(`${ADDRESS}#example=tower`);
  expect(await connection.textContent()).toContain("is loading");
  load();
  await page.waitForFunction(() => window.kinetarium?.scene?.name === "tower" && window.kinetarium.frame);
  expect(await connection.count()).toBe(0);
  const connected = (connected: boolean) =>
    page.evaluate((connected) => {
      const { worker } = window as unknown as { worker: Worker };
      worker.onmessage?.({ data: { connected } } as MessageEvent);
    }, connected);
  await drop("notes.txt", "what is to be done", await middle());
  await expect.poll(() => notice().isVisible()).toBe(true);
  await connected(false);
  expect(await connection.textContent()).toContain("is away");
  expect(await notice().textContent()).toContain("notes.txt");
  expect(await page.getByRole("button", { name: "Run" }).isDisabled()).toBe(true);
  await page.getByRole("button", { name: "Dismiss" }).click();
  expect(await connection.isVisible()).toBe(true);
  await connected(true);
  expect(await connection.count()).toBe(0);
  await step(1);
});

test("nothing moves at the start, nor when a body is picked", async () => {
  await page.addInitScript(() => {
    const shifts: { value: number; from: string[] }[] = [];
    Object.assign(window, { shifts });
    new PerformanceObserver((list) => {
      for (const entry of list.getEntries()) {
        const { value, sources } = entry as unknown as { value: number; sources: { node: Element }[] };
        shifts.push({ value, from: sources.map(({ node }) => node?.className ?? "") });
      }
    }).observe({ type: "layout-shift", buffered: true });
  });
  await page.goto(`${ADDRESS}#example=humanoid`);
  await page.waitForFunction(() => window.kinetarium?.scene?.name === "humanoid" && window.kinetarium.frame);
  await page.waitForTimeout(800);
  const shifts = await page.evaluate(() => (window as unknown as { shifts: { value: number }[] }).shifts);
  // A hundredth is what nobody sees: https://web.dev/articles/cls calls a tenth good.
  expect(
    shifts.reduce((sum, { value }) => sum + value, 0),
    JSON.stringify(shifts),
  ).toBeLessThan(0.01);
  const top = () =>
    page.getByText("Joints and actuators").evaluate((title) => title.getBoundingClientRect().top);
  const before = await top();
  await stage().focus();
  for (let body = 0; body < 4; body++) {
    await press("j");
    expect(await top()).toBe(before);
  }
});

test("gauges are told apart, and a skin goes to no other model", async () => {
  await open("example=tower");
  const skin = page.getByRole("combobox", { name: "Skin" });
  await stage().focus();
  await press("j");
  await skin.selectOption("By height");
  await expect.poll(() => page.locator(".scale").count()).toBe(1);
  await press("Escape");
  await stage().focus();
  await press("j", 2);
  await skin.selectOption("By speed");
  await expect
    .poll(() => page.locator(".scale").allTextContents())
    .toEqual([expect.stringContaining("Height"), expect.stringContaining("Speed")]);
  await page.locator('.example[data-name="pyramid"]').click();
  await page.waitForFunction(() => window.kinetarium.scene?.name === "pyramid" && window.kinetarium.frame);
  await expect.poll(() => page.locator(".scale").count()).toBe(0);
  await stage().focus();
  await press("j");
  expect(await skin.inputValue()).toBe("Its own colours");
});

test("what is plotted may be of the last of many bodies", async () => {
  await open("example=pyramid&build.rows=25");
  await page.waitForFunction(() => window.kinetarium.scene?.bodies.length === 325);
  const name = await page.evaluate(() => window.kinetarium.scene?.bodies.at(-1)?.name);
  await page.getByRole("button", { name: "Choose…" }).click();
  expect(await page.locator(".chooser .muted").textContent()).toMatch(/^\d+ more are found/);
  await page.getByRole("searchbox", { name: "Find a quantity" }).fill(`${name} height`);
  await page.locator(".chooser input[type=checkbox]").first().check();
  await expect.poll(() => page.getByRole("img", { name: `${name} height` }).count()).toBe(1);
});

test("what is plotted is chosen in peace", async () => {
  await open("example=humanoid");
  await page.getByRole("button", { name: "Run" }).click();
  await page.getByRole("button", { name: "Choose…" }).click();
  const find = page.getByRole("searchbox", { name: "Find a quantity" });
  await find.fill("knee");
  const boxes = page.locator(".chooser .check:not([hidden]) input");
  const some = await boxes.count();
  expect(some).toBeGreaterThan(1);
  await boxes.nth(0).check();
  await boxes.nth(1).check();
  await page.waitForTimeout(1500);
  expect(await find.inputValue()).toBe("knee");
  expect(await boxes.count()).toBe(some);
  expect(await boxes.nth(0).isChecked()).toBe(true);
  expect(await page.evaluate(() => (document.activeElement as HTMLInputElement).type)).toBe("checkbox");
  expect(await page.getByRole("img", { name: /knee.* over time/ }).count()).toBeGreaterThan(0);
  await page.locator(".run").dispatchEvent("click");
  await find.fill("");
  const free = page.locator(".chooser input[type=checkbox]:not(:checked)");
  const chosen = await page.locator(".chooser input:checked").count();
  for (let i = chosen; i < 16; i++) await free.first().check();
  await free.first().click();
  expect(await page.locator(".chooser input:checked").count()).toBe(16);
  expect(await notice().textContent()).toContain("At most 16");
});

test("an inset that is not wanted stays away, and one is not clicked through", async () => {
  await open("example=room");
  const inset = page.locator(".inset");
  expect(await inset.isVisible()).toBe(true);
  await inset.click();
  expect(await page.locator(".body-panel select").inputValue()).toBe("None: click one");
  await page.getByRole("combobox", { name: "Inset" }).selectOption("No inset");
  await page.locator('.example[data-name="tower"]').click();
  await page.waitForFunction(() => window.kinetarium.scene?.name === "tower");
  await page.locator('.example[data-name="room"]').click();
  await page.waitForFunction(() => window.kinetarium.scene?.name === "room" && window.kinetarium.frame);
  expect(await inset.isVisible()).toBe(false);
});

test("back to what was open, a file too, and panels stay as they were", async () => {
  await open("example=tower");
  await drop("cart.xml", CART, await middle());
  await page.waitForFunction(() => window.kinetarium.scene?.name === "cart.xml");
  await page.waitForTimeout(400);
  await page.locator('.example[data-name="dominoes"]').click();
  await page.waitForFunction(() => location.hash.includes("dominoes"));
  await page.waitForTimeout(400);
  await page.goBack();
  await page.waitForFunction(() => window.kinetarium.scene?.name === "cart.xml");
  expect(await page.locator('.example[data-name="cart.xml"]').getAttribute("aria-current")).toBe("true");
  await page.goBack();
  await page.waitForFunction(() => window.kinetarium.scene?.name === "tower");
  await page.locator('.example[data-name="cart.xml"]').click();
  await page.waitForFunction(() => window.kinetarium.scene?.name === "cart.xml");
  await page.getByRole("button", { name: "Plots" }).click();
  await page.getByRole("button", { name: "Scene" }).click();
  await page.reload();
  await page.waitForFunction(() => window.kinetarium?.frame);
  expect(await page.locator(".plots").isVisible()).toBe(false);
  expect(await page.getByRole("complementary", { name: "Scene" }).isVisible()).toBe(false);
  expect(await page.getByRole("complementary", { name: "Inspect" }).isVisible()).toBe(true);
});

test("within another page the wheel scrolls that one, until the picture is pressed", async () => {
  const frame = `<body style="margin:0;height:3000px"><iframe src="${ADDRESS}#example=tower" width="900" height="600"></iframe>`;
  await page.route("**/chapter", (route) => route.fulfill({ contentType: "text/html", body: frame }));
  await page.goto(new URL("chapter", ADDRESS).href);
  const live = page.frames()[1];
  await live.waitForFunction(() => window.kinetarium?.frame);
  const scrolled = () => page.evaluate(() => scrollY);
  const address = () => live.evaluate(() => location.hash);
  const before = await address();
  await page.mouse.move(450, 350);
  await page.mouse.wheel(0, 100);
  await expect.poll(scrolled).toBe(100);
  await page.waitForTimeout(400);
  expect(await address()).toBe(before);
  expect(await live.locator(".stage").evaluate((canvas) => getComputedStyle(canvas).touchAction)).toBe(
    "pan-y",
  );
  await page.mouse.click(450, 200);
  await page.mouse.wheel(0, 100);
  await expect.poll(address).toContain("view=");
  expect(await scrolled()).toBe(100);
});

test("nothing of the toolbar goes to a second row on a usual screen", async () => {
  await open("example=grid");
  for (const width of [1200, 1280, 1400]) {
    await page.setViewportSize({ width, height: 800 });
    expect(await page.locator(".toolbar").evaluate((bar) => bar.clientHeight), `${width} px`).toBeLessThan(
      50,
    );
  }
  expect(broken).toEqual([]);
});

const CART = `<mujoco model="cart"><worldbody><body name="cart" pos="0 0 1">
  <joint name="x" type="slide" axis="1 0 0"/><geom type="box" size=".1 .1 .1"/></body></worldbody></mujoco>`;
