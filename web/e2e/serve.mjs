/**
 * Serves web/dist as it is served to people: beside an `engine.wasm`, or by an engine's server, to which it
 * then passes `/session` on.
 */

import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { connect } from "node:net";

const PAGE = new URL("../dist/index.html", import.meta.url);

/** Serves until closed. `engine` is the path of an `engine.wasm`, or the address of a server. */
export async function serve(engine) {
  const remote = engine.startsWith("http") ? new URL(engine) : null;
  const server = createServer((incoming, response) => {
    const { pathname } = new URL(incoming.url, "http://page");
    if (pathname === "/") {
      response.setHeader("content-type", "text/html; charset=utf-8");
      response.end(page(remote !== null));
    } else if (pathname === "/engine.wasm" && !remote) {
      response.setHeader("content-type", "application/wasm");
      response.end(readFileSync(engine));
    } else {
      response.statusCode = 404;
      response.end();
    }
  });
  server.on("upgrade", (incoming, socket, head) => {
    if (remote) pass(remote, incoming, socket, head);
    else socket.destroy();
  });
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  return {
    address: `http://127.0.0.1:${server.address().port}/`,
    close: () => {
      server.closeAllConnections();
      server.close();
    },
  };
}

function page(websocket) {
  const html = readFileSync(PAGE, "utf8");
  return websocket ? html.replace('engine" content="worker"', 'engine" content="websocket"') : html;
}

/** Passes a WebSocket on, as it is: the server sees the page's own host. */
function pass(remote, incoming, socket, head) {
  const onward = connect(Number(remote.port), remote.hostname, () => {
    const headers = Object.entries(incoming.headers).map(([name, value]) => `${name}: ${value}`);
    onward.write(`GET ${incoming.url} HTTP/1.1\r\n${headers.join("\r\n")}\r\n\r\n`);
    onward.write(head);
    onward.pipe(socket);
    socket.pipe(onward);
  });
  for (const end of [onward, socket]) {
    end.on("error", () => {
      onward.destroy();
      socket.destroy();
    });
  }
}
