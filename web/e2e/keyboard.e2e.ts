/** What keys do, and where the focus stays. */

import { beforeEach, expect, test } from "vitest";
import { open, page, pages, picked, poses, step } from "./harness";

// Small, since a processor draws it.
pages({ viewport: { width: 1120, height: 320 } });

const press = async (key: string, times = 1) => {
  for (let i = 0; i < times; i++) await page.keyboard.press(key);
};
/** What has the focus, by its name. */
const focused = () =>
  page.evaluate(() => {
    const element = document.activeElement;
    return element?.getAttribute("aria-label") ?? element?.textContent ?? null;
  });
const stage = () => page.locator(".stage");
const hash = () => page.evaluate(() => location.hash);

beforeEach(() => page.emulateMedia({ reducedMotion: "reduce" }));

test("arrow keys move sliders on, to the end", async () => {
  await open("example=prismatic");
  const [slider, digits] = (["slider", "spinbutton"] as const).map((role) =>
    page.getByRole(role, { name: "Time step", exact: true }),
  );
  const max = Number(await slider.getAttribute("max"));
  await slider.focus();
  await press("Home");
  const values = await digits.evaluateHandle((digits: HTMLInputElement) => {
    const values = [digits.valueAsNumber];
    addEventListener("keyup", () => values.push(digits.valueAsNumber));
    return values;
  });
  await press("ArrowRight", max);
  expect(await slider.inputValue()).toBe(String(max));
  const told = await values.jsonValue();
  expect(told.length).toBe(max + 1);
  expect(
    told.every((value, i) => i === 0 || value > told[i - 1]),
    told.join(),
  ).toBe(true);
  // A server's session is others', too.
  await digits.fill("0.001");
  await press("Enter");
});

test("a joint's slider that a key moves is what the engine has", async () => {
  await open("example=prismatic");
  await page.locator("details.drive summary").first().click();
  const target = page.getByRole("slider", { name: "Target" });
  const before = Number(await target.inputValue());
  await target.focus();
  await press("ArrowRight", 5);
  expect(Number(await target.inputValue())).toBe(before + 5);
  const value = await page.getByRole("spinbutton", { name: "Target" }).inputValue();
  await expect
    .poll(() => page.evaluate(() => window.kinetarium.scene?.joints.flatMap(({ dofs }) => dofs)[0].position))
    .toBeCloseTo(Number(value), 9);
});

test("digits that are being typed stay, though random motors run", async () => {
  await open("example=ant&build.wander=1");
  await page.waitForFunction(() => window.kinetarium.scene?.build[0].value === 1);
  const control = (row: number) => page.locator("div.drive").nth(row).locator('input[type="number"]');
  await page.getByRole("button", { name: "Run" }).click();
  await control(1).focus();
  await control(1).fill("0.2");
  const other = await control(0).inputValue();
  await expect.poll(() => control(0).inputValue()).not.toBe(other);
  await page.keyboard.type("5");
  expect(await control(1).inputValue()).toBe("0.25");
  await press("Enter");
  await page.waitForFunction(() => window.kinetarium.scene?.actuators[1].value === 0.25);
});

test("the space bar runs and stops, whichever button a mouse has pressed", async () => {
  await open("example=dominoes");
  await page.getByRole("button", { name: "Grab" }).click();
  await press("Space");
  await page.waitForFunction(() => window.kinetarium.status?.running === true);
  expect(await page.getByRole("button", { name: "Grab" }).getAttribute("aria-pressed")).toBe("true");
  await press("Space");
  await page.waitForFunction(() => window.kinetarium.status?.running === false);
  // One that the keyboard has gone to is pressed.
  await press("Tab");
  expect(await focused()).toBe("Push");
  await press("Space");
  expect(
    await page.getByRole("button", { name: "Push", exact: true }).first().getAttribute("aria-pressed"),
  ).toBe("true");
});

test("the focus stays where it is", async () => {
  await open("example=humanoid");
  await page.getByRole("combobox", { name: "Body" }).focus();
  await press("ArrowDown", 2);
  expect(await picked()).toBe(1);
  expect(await focused()).toBe("Body");
  const follow = page.getByRole("button", { name: "Follow" });
  await follow.focus();
  await press("Enter");
  expect(await focused()).toBe("Follow");
  expect(await follow.getAttribute("aria-pressed")).toBe("true");
  await page.getByRole("button", { name: "Keep viewpoint" }).focus();
  await press("Enter");
  expect(await focused()).toBe("Keep viewpoint");
  await page.getByRole("button", { name: "Forget" }).focus();
  await press("Enter");
  expect(await focused()).toBe("Keep viewpoint");
  await page.getByRole("checkbox", { name: "All joints" }).focus();
  await press("Space");
  expect(await page.locator("details.drive").count()).toBeGreaterThan(10);
  expect(await page.evaluate(() => (document.activeElement as HTMLInputElement).checked)).toBe(true);
});

test("Esc closes one thing at a time", async () => {
  await open("example=tower");
  await stage().focus();
  await press("j");
  await press("o");
  await page.getByRole("button", { name: "Choose…" }).click();
  await press("Escape");
  expect(await page.locator(".chooser").isVisible()).toBe(false);
  expect(await picked()).toBe(0);
  await page.setViewportSize({ width: 700, height: 800 });
  const inspect = page.getByRole("complementary", { name: "Inspect" });
  await page.getByRole("button", { name: "Scene" }).click();
  await page.getByRole("button", { name: "Inspect" }).click();
  expect(await inspect.isVisible()).toBe(true);
  await press("Escape");
  expect(await inspect.isVisible()).toBe(false);
  expect(await picked()).toBe(0);
  await press("Escape");
  expect(await picked()).toBe(-1);
});

test("a body is held and pulled by keys", async () => {
  await open("example=tower");
  await stage().focus();
  await press("j");
  const before = await poses();
  const address = await hash();
  await press("h");
  await press("ArrowRight", 8);
  await press("Shift+ArrowDown", 3);
  expect(await page.locator(".spoken").textContent()).toContain("is held");
  await step(1000);
  const after = await poses();
  expect(Math.hypot(after[0] - before[0], after[2] - before[2])).toBeGreaterThan(0.01);
  // The view has not moved.
  expect(await hash()).toBe(address);
  await stage().focus();
  await press("h");
  await press("ArrowRight");
  await expect.poll(hash).toContain("view=");
});

test("viewpoints are kept with what carries them", async () => {
  await open("example=humanoid");
  await stage().focus();
  await press("j", 2);
  await press("c");
  await press("ArrowRight", 3);
  await expect.poll(hash).toContain("follow=1,0");
  const followed = await hash();
  const picture = await stage().screenshot();
  await press("Shift+Digit1");
  await press("x");
  await press("f");
  await expect.poll(hash).not.toContain("follow");
  await press("1");
  await expect.poll(hash).toBe(followed);
  await expect.poll(async () => (await stage().screenshot()).equals(picture)).toBe(true);
});

test("with a body's eyes one looks about, and the address tells how", async () => {
  await open("example=humanoid");
  await stage().focus();
  await press("j");
  const view = async () => new URLSearchParams((await hash()).slice(1)).get("view");
  await press("ArrowRight");
  await expect.poll(hash).toContain("view=");
  const free = await view();
  await press("v");
  await press("Shift+ArrowRight", 3);
  await press("ArrowLeft", 2);
  await press("+");
  await expect.poll(hash).toMatch(/ride=0,0,[-.\d]+,0,/);
  const told = await hash();
  // The camera that it comes back to has not moved.
  expect(await view()).toBe(free);
  await page.reload();
  await page.waitForFunction(() => window.kinetarium?.frame);
  await page.waitForTimeout(400);
  // What the camera does now is told after a move to and fro.
  await stage().focus();
  await press("+");
  await expect.poll(hash).not.toBe(told);
  await press("-");
  await expect.poll(hash).toBe(told);
  await press("f");
  await expect.poll(hash).toMatch(/ride=0,0,[-.\d]+,0,70/);
});

test("keys step through time, worlds, trails and themes", async () => {
  await open("example=pendula");
  await stage().focus();
  await press("]");
  await page.waitForFunction(() => window.kinetarium.shown[0] === 1);
  await press("[");
  await page.waitForFunction(() => window.kinetarium.shown[0] === 0);
  await step(1000);
  await page.waitForFunction(() => window.kinetarium.status?.steps === 1000);
  const end = await page.evaluate(() => window.kinetarium.frame?.time ?? 0);
  await press(",", 10);
  await page.waitForFunction((end) => (window.kinetarium.frame?.time ?? end) < 0.93 * end, end);
  await page.getByRole("combobox", { name: "Speed" }).selectOption("1/10 ×");
  await page.waitForFunction(() => window.kinetarium.status?.speed === 0.1);
  await press("t", 2);
  expect(await page.getByRole("combobox", { name: "Trails" }).inputValue()).toBe("Trails of all bodies");
  await press("l");
  expect(await page.getByRole("button", { name: "Theme: light" }).count()).toBe(1);
});

test("letters act where the picture has the focus alone, if one wants", async () => {
  await open("example=tower");
  await press("?");
  await page.getByRole("checkbox", { name: /act anywhere/ }).uncheck();
  await press("Escape");
  await page.getByRole("button", { name: "Help" }).focus();
  await press("j");
  expect(await picked()).toBe(-1);
  await stage().focus();
  await press("j");
  expect(await picked()).toBe(0);
  expect(await page.locator(".spoken").textContent()).toBe("Picked: box_0");
});
