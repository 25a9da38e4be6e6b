import { readFileSync } from "node:fs";
import type { Page } from "playwright-core";
import { expect, test } from "vitest";
import { HEADER, POSE } from "../src/frame";
import {
  ADDRESS,
  broken,
  browser,
  middle,
  OUT,
  open,
  page,
  pages,
  picked,
  poses,
  step,
  triangle,
} from "./harness";
import { type Reference, reference } from "./reference";

pages();

const coordinates = () => page.evaluate(() => [...(window.kinetarium.frame?.coordinates ?? [])]);
const time = () => page.evaluate(() => window.kinetarium.frame?.time ?? -1);

test("load", async () => {
  await open("example=humanoid");
  expect(await page.title()).toBe("Humanoid – Kinetarium");
  expect(await page.locator(".example").count()).toBeGreaterThan(5);
  expect(await page.locator(".notice").isVisible()).toBe(false);
});

test("a hundred steps are those of another connection", async () => {
  const other: Reference = await reference(ADDRESS, browser);
  await open("example=pendula");
  await step(100);
  const mine = await poses();
  const bytes = await other.frame({ type: "open", example: "pendula" }, { type: "step", steps: 100 });
  const header = new DataView(bytes.buffer);
  const count = header.getUint32(28, true) * header.getUint32(32, true);
  const theirs = [...new Float32Array(bytes.buffer, HEADER, POSE * count)];
  await other.close();
  expect(header.getUint32(24, true)).toBe(100);
  expect(mine.length).toBeGreaterThan(0);
  expect(mine).toEqual(theirs);
});

test("a joint follows its slider", async () => {
  await open("example=prismatic");
  const drive = page.locator("details.drive").first();
  await drive.locator("summary").click();
  const digits = drive.locator('input[type="number"]').first();
  const target = await digits.evaluate((input: HTMLInputElement) => Number(input.value) + 0.25);
  const [before] = await coordinates();
  await digits.fill(String(target));
  await digits.press("Enter");
  await step(1000);
  await step(1000);
  const [after] = await coordinates();
  expect(Math.abs(after - target)).toBeLessThan(0.3 * Math.abs(before - target));
  const slider = drive.locator('input[type="range"]').first();
  expect(await slider.getAttribute("aria-label")).toBe("Target");
});

test("restart", async () => {
  await open("example=dominoes");
  const before = await poses();
  await step(100);
  expect(await poses()).not.toEqual(before);
  await page.getByRole("button", { name: "Restart" }).click();
  await page.waitForFunction(() => window.kinetarium.frame?.steps === 0);
  expect(await poses()).toEqual(before);
});

test("rebuild with another number", async () => {
  await open("example=pendula");
  const links = page.getByRole("spinbutton", { name: "Links" });
  await links.fill("5");
  await links.press("Enter");
  await page.locator(".toolbar").getByRole("button", { name: "Rebuild" }).click();
  await page.waitForFunction(() => window.kinetarium.scene?.bodies.length === 5);
  await page.waitForFunction(() => location.hash.includes("build.links=5"));
});

test("replicas", async () => {
  await open("example=pendula");
  await page.getByRole("spinbutton", { name: "Replica" }).fill("3");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => window.kinetarium.shown[0] === 3);
  await page.getByRole("combobox", { name: "Replicas shown" }).selectOption("4 shown");
  await page.waitForFunction(() => window.kinetarium.frame?.worlds === 4);
  expect(await page.evaluate(() => window.kinetarium.shown)).toEqual([3, 4, 5, 6]);
});

test("physics", async () => {
  await open("example=balls");
  const gravity = page.getByRole("spinbutton", { name: "Gravity" });
  await gravity.fill("1.62");
  await gravity.press("Enter");
  await page.waitForFunction(() => location.hash.includes("physics.gravity=1.62"));
  const timeStep = page.getByRole("spinbutton", { name: "Time step" });
  await timeStep.fill("0.002");
  await timeStep.press("Enter");
  expect(await page.locator(".guide").textContent()).toContain("Time step2 ms");
  await timeStep.fill("0.001");
  await timeStep.press("Enter");
  const height = async () => (await poses())[await up()];
  const up = () => page.evaluate(() => (window.kinetarium.scene?.up === "z" ? 2 : 1));
  const before = await height();
  await step(100);
  const fallen = before - (await height());
  const seconds = await time();
  // ½ g t², to the order of the step.
  expect(fallen).toBeGreaterThan(0.5 * 1.62 * seconds ** 2 * 0.97);
  expect(fallen).toBeLessThan(0.5 * 1.62 * seconds ** 2 * 1.05);
});

test("two pages show what one of them sets", async ({ skip }) => {
  await open("example=prismatic");
  // A worker has one page.
  const engine = await page.locator('meta[name="kinetarium-engine"]').getAttribute("content");
  skip(engine === "worker");
  const other = await page.context().newPage();
  other.on("pageerror", (error) => broken.push(String(error.stack)));
  await other.goto(ADDRESS);
  await other.waitForFunction(() => window.kinetarium?.frame);
  const gravity = (of: Page) => of.getByRole("spinbutton", { name: "Gravity" });
  const target = (of: Page) => of.locator('details.drive input[type="number"]').first();
  for (const each of [page, other]) await each.locator("details.drive summary").first().click();
  await gravity(page).fill("1.62");
  await gravity(page).press("Enter");
  await target(other).fill("-0.25");
  await target(other).press("Enter");
  await expect.poll(() => gravity(other).inputValue()).toBe("1.62");
  await expect.poll(() => target(page).inputValue()).toBe("-0.25");
  await other.waitForFunction(() => location.hash.includes("physics.gravity=1.62"));
  // The one who hears says nothing back, so that the last word stays.
  await page.waitForTimeout(300);
  expect(await gravity(page).inputValue()).toBe("1.62");
  expect(await target(other).inputValue()).toBe("-0.25");
  await other.close();
});

test("scrub", async () => {
  await open("example=pyramid");
  await step(1000);
  const end = await time();
  const slider = page.getByRole("slider", { name: "Time", exact: true });
  await slider.evaluate((input: HTMLInputElement, half) => {
    input.value = String(half);
    input.dispatchEvent(new Event("input"));
    input.dispatchEvent(new Event("change"));
  }, end / 2);
  await page.waitForFunction(
    (half) => Math.abs((window.kinetarium.frame?.time ?? 0) - half) < 0.1 * half,
    end / 2,
  );
  const { recorded } = await page.evaluate(() => window.kinetarium.status ?? { recorded: [0, 0] });
  expect(recorded[1]).toBeGreaterThan(0.95 * end);
});

test("save picture", async () => {
  await open("example=arch");
  const coming = page.waitForEvent("download");
  await page.getByRole("button", { name: "Save picture" }).click();
  const picture = await coming;
  expect(picture.suggestedFilename()).toBe("arch-0.000s.png");
  await picture.saveAs(`${OUT}picture.png`);
  const data = readFileSync(`${OUT}picture.png`).toString("base64");
  const colors = await page.evaluate(async (base64) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext("2d");
    context?.drawImage(image, 0, 0);
    const pixels = context?.getImageData(0, 0, image.width, image.height).data ?? [];
    return new Set(Array.from({ length: 4000 }, (_, i) => pixels.slice(400 * i, 400 * i + 3).join())).size;
  }, data);
  expect(colors).toBeGreaterThan(50);
});

test("the sky is there from near and from afar", async () => {
  for (const distance of [0.01, 200]) {
    await page.goto("about:blank");
    await open(`example=grid&view=-50,3,-50,0.6,0.1,${distance}`);
    const picture = (await page.locator(".stage").screenshot()).toString("base64");
    const darkest = await page.evaluate(async (base64) => {
      const image = new Image();
      image.src = `data:image/png;base64,${base64}`;
      await image.decode();
      const context = new OffscreenCanvas(image.width, 8).getContext("2d");
      context?.drawImage(image, 0, 0);
      return Math.min(...(context?.getImageData(0, 0, image.width, 8).data ?? [0]));
    }, picture);
    expect(darkest, `${distance} m`).toBeGreaterThan(150);
  }
});

test("record a film", async () => {
  await open("example=dominoes");
  await page.getByRole("button", { name: "Record" }).click();
  await page.getByRole("button", { name: "Run" }).click();
  await page.waitForTimeout(1500);
  const coming = page.waitForEvent("download");
  await page.getByRole("button", { name: "Record" }).click();
  const film = await coming;
  expect(film.suggestedFilename()).toMatch(/^dominoes-.*\.webm$/);
  await film.saveAs(`${OUT}film.webm`);
  const bytes = readFileSync(`${OUT}film.webm`);
  // EBML, as all of Matroska.
  expect(bytes.readUInt32BE(0)).toBe(0x1a45dfa3);
  expect(bytes.length).toBeGreaterThan(10_000);
});

test("reload from the address", async () => {
  await open("example=pendula&build.links=4&replicas=2,4");
  await page.waitForFunction(() => window.kinetarium.frame?.worlds === 4);
  await page.locator(".stage").focus();
  for (let i = 0; i < 4; i++) await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => location.hash.includes("view="));
  const { hash, shown } = await page.evaluate(() => ({
    hash: location.hash,
    shown: window.kinetarium.shown,
  }));
  await page.reload();
  await page.waitForFunction(
    () => window.kinetarium?.scene?.bodies.length === 4 && window.kinetarium.frame?.worlds === 4,
  );
  await page.waitForTimeout(600);
  expect(await page.evaluate(() => window.kinetarium.shown)).toEqual(shown);
  expect(await page.evaluate(() => location.hash)).toBe(hash);
});

test("keyboard alone", async () => {
  await open("example=dominoes");
  await page.locator(".stage").focus();
  await page.keyboard.press("n");
  await page.waitForFunction(() => window.kinetarium.frame?.steps === 1);
  await page.keyboard.press("Space");
  await page.waitForFunction(() => (window.kinetarium.frame?.steps ?? 0) > 20);
  await page.keyboard.press("Space");
  await page.waitForFunction(() => window.kinetarium.status?.running === false);
  await page.keyboard.press("j");
  await page.keyboard.press("j");
  expect(await picked()).toBe(1);
  await page.keyboard.press("r");
  await page.waitForFunction(() => window.kinetarium.frame?.steps === 0);
  const before = await poses();
  await page.keyboard.press("u");
  await page.keyboard.press("Shift+N");
  await page.waitForFunction(() => window.kinetarium.frame?.steps === 100);
  expect(await poses()).not.toEqual(before);
  await page.keyboard.press("?");
  expect(await page.getByRole("dialog", { name: "Help" }).isVisible()).toBe(true);
  await page.keyboard.press("Escape");
  expect(await page.getByRole("dialog", { name: "Help" }).isVisible()).toBe(false);
  // Tab goes through all that can be pressed.
  await page.locator(".toolbar button").first().focus();
  const seen = new Set<string | null>();
  for (let i = 0; i < 60; i++) {
    await page.keyboard.press("Tab");
    seen.add(await page.evaluate(() => document.activeElement?.getAttribute("aria-label") ?? null));
  }
  for (const name of ["Run", "Restart", "Save picture", "Help"]) expect(seen).toContain(name);
});

test("pick, drag by a spring, push", async () => {
  await open("example=tower");
  const { x, y } = await middle();
  await page.mouse.click(x, y);
  await expect.poll(picked).toBeGreaterThanOrEqual(0);
  await page.getByRole("button", { name: "Run" }).click();
  await page.keyboard.down("Control");
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 1; i <= 10; i++) await page.mouse.move(x + 16 * i, y - 4 * i);
  await page.waitForTimeout(700);
  await page.screenshot({ path: `${OUT}spring.png` });
  await page.mouse.up();
  await page.keyboard.up("Control");
  const moved = await page.evaluate(() => {
    const { frame, scene } = window.kinetarium;
    const at = frame?.poses ?? [];
    return Math.max(...(scene?.bodies ?? []).map((_, body) => Math.hypot(at[7 * body], at[7 * body + 2])));
  });
  expect(moved).toBeGreaterThan(0.02);
  await page.getByRole("button", { name: "Push", exact: true }).last().click();
  expect(await page.locator(".notice").isVisible()).toBe(false);
});

test("skins", async () => {
  await open("example=tower");
  const before = await poses();
  const picture = () => page.locator(".stage").screenshot();
  const plain = await picture();
  const file = page.locator('.skins input[type="file"]');
  await file.setInputFiles({ name: "triangle.glb", mimeType: "model/gltf-binary", buffer: triangle() });
  await page.waitForSelector('select[aria-label="Size of the model"]:not([hidden])');
  await page.waitForTimeout(300);
  expect((await picture()).equals(plain)).toBe(false);
  await page.getByRole("combobox", { name: "Skin" }).selectOption("By contact force");
  await step(10);
  expect(await page.locator(".scale").isVisible()).toBe(true);
  await page.getByRole("button", { name: "Restart" }).click();
  await page.waitForFunction(() => window.kinetarium.frame?.steps === 0);
  expect(await poses()).toEqual(before);
  await file.setInputFiles({ name: "broken.glb", mimeType: "model/gltf-binary", buffer: Buffer.from("no") });
  await page.waitForSelector(".notice:not([hidden])");
  expect(await page.locator(".notice").textContent()).toContain("broken.glb is no GLB file");
});

test("what is drawn over the bodies", async () => {
  await open("example=humanoid");
  await step(100);
  await page.locator(".stage").focus();
  await page.keyboard.press("j");
  const names = ["Contact points", "Contact forces", "Joints", "Frames", "Centres of mass", "See-through"];
  const picture = () => page.locator(".stage").screenshot();
  let last = await picture();
  for (const name of names) {
    await page.getByRole("checkbox", { name, exact: true }).check();
    await page.waitForTimeout(250);
    const next = await picture();
    // Contacts are there when it has fallen.
    if (!name.startsWith("Contact")) expect(next.equals(last), name).toBe(false);
    last = next;
  }
  await page.keyboard.press("v");
  await page.waitForTimeout(250);
  expect((await picture()).equals(last)).toBe(false);
});

test("nothing of the toolbar is lost in a narrow window", async () => {
  await open("example=humanoid");
  for (const width of [400, 700, 900]) {
    await page.setViewportSize({ width, height: 780 });
    await page.screenshot({ path: `${OUT}toolbar_${width}.png` });
    const outside = await page.evaluate(() => {
      const things = document.querySelectorAll(".toolbar button, .toolbar select, .toolbar input");
      const corners = [...things].map((thing) => thing.getBoundingClientRect());
      return corners.filter(({ left, right }) => left < 0 || right > innerWidth).length;
    });
    expect(outside, `${width} px`).toBe(0);
  }
});

test("a page that draws slowly is not late", async () => {
  // So many that a processor draws some ten pictures a second of them.
  await open("example=grid");
  await page.getByRole("button", { name: "Run" }).click();
  await page.waitForTimeout(6000);
  const late = await page.evaluate(async () => {
    const began = performance.now();
    document.querySelector<HTMLElement>('[aria-label="Stop"]')?.click();
    while (window.kinetarium.status?.running) await new Promise((turn) => setTimeout(turn));
    return performance.now() - began;
  });
  expect(late).toBeLessThan(2000);
});

test("what is no number, or none that may be, does not stay", async () => {
  await open("example=prismatic");
  const gravity = page.getByRole("spinbutton", { name: "Gravity" });
  for (const wrong of ["", "1e9"]) {
    await gravity.fill(wrong);
    await gravity.press("Enter");
    await gravity.blur();
    expect(await gravity.inputValue()).toBe("9.81");
  }
  const slider = page.getByRole("slider", { name: "Gravity" });
  expect(await slider.getAttribute("aria-valuetext")).toBe("9.81 m/s²");
  await page.locator("details.drive summary").first().click();
  const stiffness = page.getByRole("spinbutton", { name: "Stiffness" });
  await stiffness.fill("-1");
  await stiffness.press("Enter");
  await expect.poll(() => stiffness.inputValue()).toBe("200");
});

test("nothing moves where there are more replicas", async () => {
  await page.setViewportSize({ width: 1280, height: 800 });
  const places = () =>
    page.evaluate(() => {
      const things = document.querySelectorAll(".toolbar button, .toolbar select, .toolbar input, .stage");
      return [...things].map((thing) => thing.getBoundingClientRect().toJSON());
    });
  await open("example=tower");
  const before = await places();
  await open("example=grid");
  expect(await places()).toEqual(before);
  const tops = before.slice(0, -1).map(({ y, height }) => y + height / 2);
  expect(Math.max(...tops) - Math.min(...tops), "one row").toBeLessThan(2);
});

test("a small screen, in the dark", async () => {
  await page.setViewportSize({ width: 400, height: 780 });
  await page.emulateMedia({ colorScheme: "dark" });
  await open("example=humanoid");
  expect(await page.evaluate(() => document.documentElement.dataset.theme)).toBe("dark");
  expect(await page.evaluate(() => document.documentElement.scrollWidth)).toBe(400);
  await page.getByRole("button", { name: "Inspect" }).click();
  expect(await page.getByRole("complementary", { name: "Inspect" }).isVisible()).toBe(true);
});

test("malformed messages are told, and change nothing", async () => {
  await page.addInitScript(() => {
    // Whatever the transport, its first frame is followed by nonsense.
    const garbage = ["{", '{"type":"scene"}', new ArrayBuffer(7), new ArrayBuffer(80)];
    const disturb = (
      target: { onmessage: ((event: never) => void) | null },
      wrap: (data: unknown) => unknown,
    ) => {
      for (const data of garbage) target.onmessage?.({ data: wrap(data) } as never);
    };
    const [NativeSocket, NativeWorker] = [window.WebSocket, window.Worker];
    window.WebSocket = class extends NativeSocket {
      constructor(address: string) {
        super(address);
        setTimeout(() => disturb(this, (data) => data), 1500);
      }
    } as never;
    window.Worker = class extends NativeWorker {
      constructor(address: string, options?: WorkerOptions) {
        super(address, options);
        setTimeout(
          () => disturb(this, (data) => (typeof data === "string" ? { text: data } : { binary: data })),
          1500,
        );
      }
    } as never;
  });
  await open("example=dominoes");
  await page.waitForSelector(".notice:not([hidden])");
  expect(await page.locator(".notice").textContent()).toContain("was not understood");
  await step(10);
  expect(await page.evaluate(() => window.kinetarium.scene?.name)).toBe("dominoes");
});

test("sliders follow random motors, but for those that are set", async () => {
  await open("example=ant&build.wander=1");
  await page.waitForFunction(() => window.kinetarium.scene?.build[0].value === 1);
  const control = (row: number) => page.locator("div.drive").nth(row).locator('input[type="number"]');
  await control(1).fill("0.5");
  await control(1).press("Enter");
  await step(100);
  const first = await control(0).inputValue();
  expect(Number(first)).not.toBe(0);
  await step(100);
  await expect.poll(() => control(0).inputValue()).not.toBe(first);
  expect(await control(1).inputValue()).toBe("0.5");
});
