import EngineWorker from "./engine.worker?worker&inline";
import SocketWorker from "./socket.worker?worker&inline";
import type { Receiver, Transport } from "./transport";
import { sessionAddress } from "./websocket";
import { WorkerTransport } from "./worker";

/**
 * Goes to the engine that the page names: `<meta name="kinetarium-engine" content="worker">`, or `websocket`,
 * which a server writes there when it serves the page.
 */
export function connect(receiver: Receiver): Transport {
  const meta = document.querySelector<HTMLMetaElement>('meta[name="kinetarium-engine"]');
  return meta?.content === "websocket"
    ? new WorkerTransport(new SocketWorker(), sessionAddress(location.href), receiver)
    : new WorkerTransport(new EngineWorker(), new URL("engine.wasm", document.baseURI).href, receiver);
}
