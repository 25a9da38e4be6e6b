import { expect, test } from "vitest";
import { parseAddress } from "../src/address";
import { ADDRESS, drop, middle, open, page, pages, poses, step, triangle } from "./harness";

pages();

const CART = `<mujoco model="cart"><worldbody><light pos="0 0 3" specular="1 1 1"/><camera name="eye" pos="0 -3 1" xyaxes="1 0 0 0 0 1" fovy="50"/><body name="cart" pos="0 0 1">
  <joint name="x" type="slide" axis="1 0 0"/><geom type="box" size=".1 .1 .1"/></body></worldbody></mujoco>`;
const ARM = `<robot name="arm"><link name="base"/><link name="tip"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial><visual><geometry><sphere radius="0.1"/>
  </geometry></visual></link><joint name="hinge" type="continuous"><parent link="base"/><child link="tip"/>
  <axis xyz="0 1 0"/></joint></robot>`;

const shown = (name: string) =>
  page.waitForFunction((wanted) => window.kinetarium.scene?.name === wanted, name);
const notice = () => page.locator(".notice");

test("a robot file that is dropped on the picture opens", async () => {
  await open("example=tower");
  await drop("cart.xml", CART, await middle());
  await shown("cart.xml");
  expect(await page.title()).toBe("cart – Kinetarium");
  expect(await page.locator(".guide").textContent()).toContain("left out:\ncart.xml:1: <light>");
  await step(100);
  // Only its joint lets it move, and gravity does not.
  expect((await poses()).map((x) => Number(x.toFixed(4)))).toEqual([0, 0, 1, 0, 0, 0, 1]);
  await page.getByRole("button", { name: "Restart" }).click();
  await page.waitForFunction(() => window.kinetarium.frame?.steps === 0);
  await expect.poll(() => page.evaluate(() => location.hash)).not.toContain("tower");
  expect(await page.locator('.example[aria-current="true"]').allTextContents()).toEqual([
    "cart.xmlYour file.",
  ]);
  expect(await notice().isVisible()).toBe(false);
  await page.locator(".example").first().click();
  await page.waitForFunction(() => window.kinetarium.scene?.name !== "cart.xml");
});

test("a camera of a file is seen through, and gone to", async () => {
  await open("example=tower");
  await drop("cart.xml", CART, await middle());
  await shown("cart.xml");
  // No robot's eye, it is not shown at first.
  expect(await page.locator(".inset").isVisible()).toBe(false);
  await page.getByRole("combobox", { name: "Inset" }).selectOption("Camera eye");
  expect(await page.locator(".inset").textContent()).toBe("eye");
  await page.getByRole("button", { name: "eye", exact: true }).click();
  await page.waitForFunction(() => location.hash.includes("view="));
  const { viewpoint } = parseAddress(await page.evaluate(() => location.hash));
  // At (0, −3, 1), level, towards +y, which is −z of the screen: towards the cart, 3 m away.
  expect(viewpoint?.yaw).toBeCloseTo(0, 4);
  expect(viewpoint?.pitch).toBeCloseTo(0, 4);
  expect(viewpoint?.distance).toBeCloseTo(3, 3);
  viewpoint?.target.forEach((x, i) => {
    expect(x).toBeCloseTo([0, 1, 0][i], 3);
  });
});

test("so it does anywhere else on the page, and from the file dialog", async () => {
  await open("example=tower");
  await drop("arm.urdf", ARM, { x: 700, y: 20 });
  await shown("arm.urdf");
  const choosing = page.waitForEvent("filechooser");
  await page.getByRole("button", { name: "Open a robot file…" }).click();
  const chooser = await choosing;
  await chooser.setFiles({ name: "cart.xml", mimeType: "text/xml", buffer: Buffer.from(CART) });
  await shown("cart.xml");
});

test("a file that is no robot changes nothing, and is told", async () => {
  await open("example=tower");
  await drop("broken.xml", "<mujoco>", await middle());
  await expect.poll(() => notice().textContent()).toContain("broken.xml");
  const meshes = CART.replace("<worldbody>", '<asset><mesh name="m" file="m.obj"/></asset><worldbody>');
  await drop(
    "meshes.xml",
    meshes.replace('type="box" size=".1 .1 .1"', 'type="mesh" mesh="m"'),
    await middle(),
  );
  await expect.poll(() => notice().textContent()).toContain("open it with `kinetarium view`");
  await drop("huge.xml", " ".repeat(1 << 20), await middle());
  await expect.poll(() => notice().textContent()).toContain("huge.xml is larger than 1 MB");
  await drop("notes.txt", "what is to be done", await middle());
  await expect.poll(() => notice().textContent()).toContain("notes.txt is no picture");
  // The browser has not left for any of them.
  expect(await page.evaluate(() => location.href)).toContain(ADDRESS);
  expect(await page.evaluate(() => window.kinetarium.scene?.name)).toBe("tower");
  await step(10);
});

test("a model that is dropped on a body dresses it, and beside the picture all of them", async () => {
  await open("example=tower");
  const worn = () => page.getByRole("combobox", { name: "Skin" }).evaluate((s: HTMLSelectElement) => s.value);
  const picture = () => page.locator(".stage").screenshot();
  const plain = await picture();
  await drop("triangle.glb", triangle(), await middle());
  await page.waitForTimeout(500);
  const dressed = await picture();
  expect(dressed.equals(plain)).toBe(false);
  // Of all bodies, which are plain.
  expect(await worn()).toBe("Its own colours");
  await drop("triangle.glb", triangle(), { x: 700, y: 20 });
  await expect.poll(worn).toBe("Picture or model…");
  expect((await picture()).equals(dressed)).toBe(false);
});

test("the link that is copied shows the same", async () => {
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await open("example=pendula&build.links=4");
  await page.locator(".stage").focus();
  for (let i = 0; i < 4; i++) await page.keyboard.press("ArrowRight");
  await page.getByRole("button", { name: "Copy link" }).click();
  await expect.poll(() => notice().textContent()).toContain("is copied");
  const copied = await page.evaluate(() => navigator.clipboard.readText());
  expect(copied).toBe(await page.evaluate(() => location.href));
  expect(copied).toMatch(/#example=pendula&build\.links=4&.*view=/);
  const other = await page.context().newPage();
  await other.goto(copied);
  await other.waitForFunction(() => window.kinetarium?.frame && window.kinetarium.scene?.bodies.length === 4);
  await other.waitForTimeout(600);
  expect(await other.evaluate(() => location.href)).toBe(copied);
});

test("where the clipboard is closed, the page says what to do", async () => {
  await page.addInitScript(() => Object.defineProperty(navigator, "clipboard", { value: undefined }));
  await open("example=tower");
  await page.getByRole("button", { name: "Copy link" }).click();
  await expect.poll(() => notice().textContent()).toContain("copy the address by hand");
});
