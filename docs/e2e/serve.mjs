/** Serves a folder below a path, as any static host does: files as they are, and index.html of a folder. */

import { createReadStream, statSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join } from "node:path";

const TYPES = {
  ".css": "text/css",
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript",
  ".json": "application/json",
  ".png": "image/png",
  ".svg": "image/svg+xml",
  ".wasm": "application/wasm",
  ".woff2": "font/woff2",
};

/** Serves until closed; the address ends in `path`, which begins and ends with a slash. */
export async function serve(folder, path) {
  const server = createServer((incoming, response) => {
    const file = find(folder, path, decodeURIComponent(new URL(incoming.url, "http://host").pathname));
    if (!file) {
      response.statusCode = 404;
      response.end();
      return;
    }
    response.setHeader("content-type", TYPES[extname(file)] ?? "application/octet-stream");
    createReadStream(file).pipe(response);
  });
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  return {
    address: `http://127.0.0.1:${server.address().port}${path}`,
    close: () => {
      server.closeAllConnections();
      server.close();
    },
  };
}

/** The file of an address, if there is one. */
function find(folder, path, address) {
  if (!address.startsWith(path) || address.includes("..")) return null;
  const file = join(folder, address.slice(path.length), address.endsWith("/") ? "index.html" : "");
  return statSync(file, { throwIfNoEntry: false })?.isFile() ? file : null;
}
