/**
 * The worker that holds the connection to a server. A page that is busy drawing would leave frames in the connection,
 * and show them seconds late, its own Stop behind them; here they are taken at once, and what is late is dropped.
 */

import type { FromWorker, ToWorker, Transport } from "./transport";
import { WebSocketTransport } from "./websocket";

function post(message: FromWorker, transfer: Transferable[] = []): void {
  self.postMessage(message, { transfer });
}

let transport: Transport | null = null;

self.onmessage = ({ data }: MessageEvent<ToWorker>) => {
  if ("load" in data) {
    transport = new WebSocketTransport(data.load, {
      connected: (connected) => post({ connected }),
      text: (text) => post({ text }),
      binary: (binary) => post({ binary }, [binary]),
      failed: (failed) => post({ failed }),
    });
  } else if ("command" in data) {
    transport?.send(data.command);
  } else {
    transport?.drawn();
  }
};
