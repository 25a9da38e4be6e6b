import { beforeEach, expect, test } from "vitest";
import { open, page, pages, triangle } from "./harness";

pages();

const notice = () => page.locator(".notice");
const skin = () => page.getByRole("combobox", { name: "Skin" });
const worn = () => skin().evaluate((select: HTMLSelectElement) => select.value);

declare global {
  interface Window {
    /** The worker through which the page hears its engine. */
    ears: Worker;
  }
}

beforeEach(() =>
  page.addInitScript(() => {
    window.Worker = class extends Worker {
      constructor(address: string | URL, options?: WorkerOptions) {
        super(address, options);
        window.ears = this;
      }
    };
  }),
);

/** The engine says something, as where a program dresses bodies. */
const say = (message: object) =>
  page.evaluate((text) => {
    window.ears.dispatchEvent(new MessageEvent("message", { data: { text } }));
  }, JSON.stringify(message));

async function dress(skin: object, bodies: number[] | null = null): Promise<void> {
  const scene = await page.evaluate(() => window.kinetarium.scene?.id);
  await say({ type: "dress", scene, outfits: [{ bodies, skin }], forget: [] });
}

async function send(id: string, format: string, content: Buffer): Promise<void> {
  await say({ type: "skin_file", id, name: `${id}.${format}`, format, data: content.toString("base64") });
}

/** How many pixels of the picture are mostly red, mostly green. */
async function tints(): Promise<{ red: number; green: number }> {
  const shot = await page.locator(".stage").screenshot();
  return page.evaluate(async (png) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${png}`)).blob());
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    if (!canvas) throw new Error("A picture cannot be looked at.");
    canvas.drawImage(bitmap, 0, 0);
    const { data } = canvas.getImageData(0, 0, bitmap.width, bitmap.height);
    let [red, green] = [0, 0];
    for (let i = 0; i < data.length; i += 4) {
      const [r, g, b] = data.subarray(i, i + 3);
      if (r > 2 * g && r > 2 * b) red++;
      if (g > 2 * r && g > 2 * b) green++;
    }
    return { red, green };
  }, shot.toString("base64"));
}

/** A picture of one green pixel. */
const GREEN = Buffer.from(
  "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M/wHwAEBgIApD5fRAAAAABJRU5ErkJggg==",
  "base64",
);

test("bodies wear what a program says: a colour, a picture, a model", async () => {
  await open("example=tower");
  expect((await tints()).red).toBeLessThan(200);
  await dress({ kind: "color", color: [0.9, 0.05, 0.05, 1] });
  await expect.poll(worn).toBe("One colour");
  await expect.poll(async () => (await tints()).red).toBeGreaterThan(5000);
  const { red } = await tints();
  await dress({ kind: "color", color: [0.05, 0.8, 0.05, 1] }, [0]);
  await expect.poll(async () => (await tints()).green).toBeGreaterThan(200);
  expect((await tints()).red).toBeLessThan(red);
  await send("green", "png", GREEN);
  await dress({ kind: "file", file: "green", fitted: true });
  await expect.poll(async () => (await tints()).green).toBeGreaterThan(5000);
  await send("triangle", "glb", triangle());
  await dress({ kind: "file", file: "triangle", fitted: true });
  await expect.poll(async () => (await tints()).green).toBeLessThan(200);
  await expect.poll(worn).toBe("Picture or model…");
  // A person may choose otherwise, until the program dresses them again.
  await skin().selectOption("Its own colours");
  expect(await worn()).toBe("Its own colours");
  await dress({ kind: "gauge", gauge: "height" });
  await expect.poll(worn).toBe("By height");
  await expect.poll(() => page.locator(".scales").isVisible()).toBe(true);
  expect(await notice().isVisible()).toBe(false);
});

test("a picture that cannot be decoded is told, and bodies stay as they are", async () => {
  await open("example=tower");
  await send("broken", "png", Buffer.from("\x89PNG\r\n\x1a\n and no more", "latin1"));
  await dress({ kind: "file", file: "broken", fitted: true });
  await expect.poll(() => notice().textContent()).toContain("broken.png is no picture");
  expect(await worn()).toBe("Its own colours");
  await send("empty", "glb", Buffer.from("glTF"));
  await dress({ kind: "file", file: "empty", fitted: true });
  await expect.poll(() => notice().textContent()).toContain("empty.glb cannot be read as GLB");
});
