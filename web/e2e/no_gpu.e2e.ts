/** A browser that has no graphics card for the engine. */

import { expect, test } from "vitest";
import { open, page, pages, step } from "./harness";

pages();

test("without a card the page runs in WebAssembly, and says so", async ({ skip }) => {
  await open("example=pendula&physics.runs_on=1&physics.gravity=1.62");
  // A server has its own card, or none.
  skip((await page.locator('meta[name="kinetarium-engine"]').getAttribute("content")) !== "worker");
  expect(await page.locator(".notice").textContent()).toContain("It runs on the processor");
  expect(await page.locator(".note").textContent()).toContain("No graphics card: this browser");
  const gravity = page.getByRole("spinbutton", { name: "Gravity" });
  expect(await gravity.inputValue()).toBe("1.62");
  await step(10);
  expect(await page.evaluate(() => window.kinetarium.status?.card)).toBe(null);
  expect(await page.locator(".guide .facts").textContent()).toContain("processor");
});
