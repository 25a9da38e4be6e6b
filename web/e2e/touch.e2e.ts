import type { CDPSession } from "playwright-core";
import { beforeEach, expect, test } from "vitest";
import { parseAddress } from "../src/address";
import type { Viewpoint } from "../src/view/camera_rig";
import { middle, OUT, open, page, pages, picked, poses } from "./harness";

pages({ viewport: { width: 400, height: 800 }, hasTouch: true, isMobile: true });

type Point = [x: number, y: number];

/** Fingers on the screen. */
let fingers: CDPSession;
beforeEach(async () => {
  fingers = await page.context().newCDPSession(page);
});

async function touch(type: "touchStart" | "touchMove" | "touchEnd", points: Point[]): Promise<void> {
  const touchPoints = points.map(([x, y], id) => ({ x, y, id }));
  await fingers.send("Input.dispatchTouchEvent", { type, touchPoints });
}

/** Moves fingers from some points to others, and lifts them. */
async function slide(from: Point[], to: Point[], steps = 10): Promise<void> {
  await touch("touchStart", from);
  for (let i = 1; i <= steps; i++) {
    const between = (a: number, b: number) => a + ((b - a) * i) / steps;
    await touch(
      "touchMove",
      from.map(([x, y], f): Point => [between(x, to[f][0]), between(y, to[f][1])]),
    );
  }
  await touch("touchEnd", []);
}

/** From where the scene is seen, as the address says after a change. */
async function viewpoint(): Promise<Viewpoint> {
  await page.waitForTimeout(400);
  const { viewpoint } = parseAddress(await page.evaluate(() => location.hash));
  if (!viewpoint) throw new Error("The address tells no viewpoint.");
  return viewpoint;
}

const height = () => page.locator(".stage").evaluate((stage) => stage.clientHeight);
const apart = (a: number[], b: number[]) => Math.hypot(...a.map((x, i) => x - b[i]));

test("one finger turns the view", async () => {
  await open("example=tower");
  const { x, y } = await middle();
  await slide([[x, y]], [[x + 40, y]]);
  const before = await viewpoint();
  await slide([[x - 80, y]], [[x + 80, y - 40]]);
  const after = await viewpoint();
  // Half a turn for the height of the picture.
  expect(after.yaw - before.yaw).toBeCloseTo((-Math.PI * 160) / (await height()), 3);
  expect(after.pitch - before.pitch).toBeCloseTo((-Math.PI * 40) / (await height()), 3);
  expect(apart(after.target, before.target)).toBeLessThan(1e-4);
  expect(after.distance).toBeCloseTo(before.distance, 4);
});

test("two fingers move the view, and pinch it", async () => {
  await open("example=tower");
  const { x, y } = await middle();
  await slide([[x, y]], [[x + 40, y]]);
  const before = await viewpoint();
  const fingers: Point[] = [
    [x - 50, y],
    [x + 50, y],
  ];
  await slide(
    fingers,
    fingers.map(([x, y]) => [x, y - 60]),
  );
  const moved = await viewpoint();
  expect(moved.yaw).toBeCloseTo(before.yaw, 4);
  expect(moved.distance / before.distance).toBeCloseTo(1, 2);
  // The picture is 2 d tan(fov / 2) high where the target is, and goes along with the fingers.
  const high = 2 * before.distance * Math.tan((Math.PI / 180) * 20);
  expect(apart(moved.target, before.target)).toBeCloseTo((high * 60) / (await height()), 2);
  await slide(fingers, [
    [x - 100, y],
    [x + 100, y],
  ]);
  const closer = await viewpoint();
  expect(closer.distance / moved.distance).toBeCloseTo(0.5, 2);
  expect(apart(closer.target, moved.target)).toBeLessThan(0.01 * moved.distance);
  expect(await picked()).toBe(-1);
});

test("a tap picks, though the finger trembles, and two fingers do not", async () => {
  await open("example=tower");
  const { x, y } = await middle();
  await touch("touchStart", [
    [x, y],
    [x, y + 40],
  ]);
  await touch("touchEnd", []);
  await page.waitForTimeout(100);
  expect(await picked()).toBe(-1);
  await slide([[x, y]], [[x + 5, y + 3]], 3);
  await expect.poll(picked).toBeGreaterThanOrEqual(0);
});

test("a finger drags with the tool Grab, and pushes with the tool Push", async () => {
  await open("example=tower");
  await page.getByRole("button", { name: "Grab" }).tap();
  await page.getByRole("button", { name: "Run" }).tap();
  const { x, y } = await middle();
  const before = await page.evaluate(() => location.hash);
  await touch("touchStart", [[x, y]]);
  for (let i = 1; i <= 10; i++) await touch("touchMove", [[x + 8 * i, y - 2 * i]]);
  await page.waitForTimeout(700);
  await page.screenshot({ path: `${OUT}touch_spring.png` });
  await touch("touchEnd", []);
  const moved = async () => {
    const at = await poses();
    return Math.max(...Array.from({ length: at.length / 7 }, (_, i) => Math.hypot(at[7 * i], at[7 * i + 2])));
  };
  expect(await moved()).toBeGreaterThan(0.02);
  await page.waitForTimeout(400);
  expect(await page.evaluate(() => location.hash)).toBe(before);

  await page.getByRole("button", { name: "Restart" }).tap();
  await page.waitForFunction(() => window.kinetarium.frame?.steps === 0);
  await page.getByRole("button", { name: "Push", exact: true }).first().tap();
  const still = await poses();
  await slide([[x, y]], [[x, y]], 1);
  await page.getByRole("button", { name: "100", exact: true }).tap();
  await page.waitForFunction(() => window.kinetarium.frame?.steps === 100);
  expect(apart(await poses(), still)).toBeGreaterThan(0.01);
});
