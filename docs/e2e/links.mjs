/** Looks whether what the pages refer to is there. */

import { existsSync, readdirSync, readFileSync, statSync } from "node:fs";
import { join, relative } from "node:path";

/** Made by others, who look after their own links. */
const FOREIGN = ["api", "live"];

/** What is referred to and not there, as `page: address`. */
export function brokenLinks(site) {
  return pages(site).flatMap((page) => {
    const html = readFileSync(page, "utf8");
    const addresses = [...html.matchAll(/\s(?:href|src)="([^"]*)"/g)].map(([, address]) => address);
    const broken = addresses.filter((address) => !resolves(site, page, address.replaceAll("&amp;", "&")));
    return [...new Set(broken)].map((address) => `${relative(site, page)}: ${address}`);
  });
}

function pages(site) {
  const files = readdirSync(site, { recursive: true }).filter((file) => file.endsWith(".html"));
  return files.filter((file) => !FOREIGN.includes(file.split("/")[0])).map((file) => join(site, file));
}

function resolves(site, page, address) {
  const root = "http://site/folder/";
  const url = new URL(address, root + relative(site, page));
  if (!address.startsWith("http") && !url.href.startsWith(root)) return url.protocol === "data:";
  if (!url.href.startsWith(root)) return true; // another host's
  const path = join(site, decodeURIComponent(url.pathname.slice("/folder/".length)));
  const file = url.pathname.endsWith("/") ? join(path, "index.html") : path;
  if (!existsSync(file) || !statSync(file).isFile()) return false;
  const anchor = decodeURIComponent(url.hash.slice(1));
  // What follows the hash of a live page is its state.
  return !anchor || anchor.includes("=") || readFileSync(file, "utf8").includes(`id="${anchor}"`);
}
