/**
 * Looks at the finished site as a reader does, below a folder of a plain static host: `node e2e/run.mjs SITE`.
 * Chromium and its flags are those of the page's own tests in `web/`, whose packages must be installed.
 */

import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { launch } from "../../web/e2e/browser.mjs";
import { brokenLinks } from "./links.mjs";
import { serve } from "./serve.mjs";

const SITE = process.argv[2] ?? "../target/site";
const OUT = new URL("out/", import.meta.url).pathname;
/** For the engine to load and draw, in software [ms]. */
const PATIENCE = 180_000;
/** Not with every image drawn, of which there are few where a processor draws them [ms]. */
const POLLING = { polling: 200 };

/** A page that notes what goes wrong on it. */
async function open(browser, host, colorScheme, viewport = { width: 1440, height: 900 }) {
  const page = await browser.newPage({ colorScheme, viewport });
  page.setDefaultTimeout(PATIENCE);
  const faults = [];
  page.on("request", (request) => {
    const url = request.url();
    if (!/^(data|blob):/.test(url) && !url.startsWith(host.address)) faults.push(`asks ${url}`);
  });
  page.on("response", (response) => {
    if (response.status() >= 400) faults.push(`${response.status()} ${response.url()}`);
  });
  page.on("requestfailed", (request) => {
    // A page that is left lets go of what it was loading.
    const reason = request.failure()?.errorText;
    if (reason !== "net::ERR_ABORTED") faults.push(`${reason} ${request.url()}`);
  });
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("console", (message) => {
    if (message.type() === "error") faults.push(message.text());
  });
  return { page, faults };
}

/** The live page in a page. */
async function live(page) {
  const frame = await (await page.waitForSelector(".live iframe")).contentFrame();
  await frame.waitForFunction(() => window.kinetarium?.frame, null, POLLING);
  return frame;
}

/** Presses Run and waits until the engine has stepped. */
async function run(frame) {
  const before = await frame.evaluate(() => window.kinetarium.frame.time);
  await frame.getByRole("button", { name: "Run", exact: true }).click();
  await frame.waitForFunction((time) => window.kinetarium.frame.time > time + 0.05, before, POLLING);
}

async function reads(browser, host, colorScheme) {
  const { page, faults } = await open(browser, host, colorScheme);
  const shot = (name) => page.screenshot({ path: `${OUT}${name}_${colorScheme}.png` });
  const title = (text) => page.waitForSelector(`h1:has-text("${text}")`);

  await page.goto(host.address);
  const first = await live(page);
  assert.equal(await first.evaluate(() => window.kinetarium.scene.name), "ragdolls");
  assert.equal(await first.evaluate(() => document.documentElement.dataset.theme), colorScheme);
  await run(first);
  await shot("index");

  // From page to page without loading one, from folder to folder.
  const menu = (name) => page.getByRole("navigation").getByRole("link", { name, exact: true }).first();
  await menu("Examples").click();
  await title("Examples");
  await shot("examples");
  await page.getByRole("link", { name: "Dominoes" }).last().click();
  await title("Dominoes");
  const dominoes = await live(page);
  assert.equal(await dominoes.evaluate(() => window.kinetarium.scene.name), "dominoes");
  await run(dominoes);
  await shot("dominoes");
  await menu("Guide").click();
  await title("First picture");
  await shot("first_picture");
  await menu("Benchmarks").click();
  await title("Benchmarks");
  await shot("benchmarks");
  await menu("Concepts").click();
  await title("Units and conventions");

  await page.getByRole("button", { name: "Search" }).click();
  await page.getByRole("searchbox").fill("keystone");
  await page.locator(".VPLocalSearchBox .result").first().click();
  await title("Arch");
  assert.equal(new URL(page.url()).pathname, `${new URL(host.address).pathname}examples/arch.html`);

  await page.goto(`${host.address}concepts/kernels.html`);
  await title("Kernels");
  await shot("kernels");
  await menu("API").click();
  await page.waitForURL("**/api/kinetarium/index.html");
  await page.close();
  assert.deepEqual(faults, []);
}

async function readsOnATelephone(browser, host) {
  const { page, faults } = await open(browser, host, "light", { width: 390, height: 844 });
  await page.goto(`${host.address}guide/controls.html`);
  await page.screenshot({ path: `${OUT}controls_narrow.png` });
  await page.goto(`${host.address}examples/tower.html`);
  await run(await live(page));
  await page.screenshot({ path: `${OUT}tower_narrow.png` });
  await page.close();
  assert.deepEqual(faults, []);
}

mkdirSync(OUT, { recursive: true });
const broken = brokenLinks(SITE);
assert.ok(broken.length === 0, `These links lead nowhere:\n${broken.join("\n")}`);
const host = await serve(SITE, "/some/folder/");
const browser = await launch();
try {
  await reads(browser, host, "light");
  await reads(browser, host, "dark");
  await readsOnATelephone(browser, host);
  console.log(`The site is whole; pictures of it are in ${OUT}`);
} finally {
  await browser.close();
  host.close();
}
