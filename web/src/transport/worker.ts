/** An engine in a worker of the page: `engine.wasm` beside it. */

import type { Command } from "../protocol";
import type { FromWorker, ToWorker } from "./engine.worker";
import EngineWorker from "./engine.worker?worker&inline";
import type { Receiver, Transport } from "./transport";

export class WorkerTransport implements Transport {
  private readonly worker = new EngineWorker();

  constructor(engine: string, receiver: Receiver) {
    this.worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
      if ("text" in data) receiver.text(data.text);
      else if ("binary" in data) receiver.binary(data.binary);
      else if ("failed" in data) receiver.failed(data.failed);
      else receiver.connected(true);
    };
    this.worker.onerror = (event) => receiver.failed(`The engine's worker failed: ${event.message}`);
    this.post({ load: engine });
  }

  send(command: Command): void {
    this.post({ command });
  }

  drawn(): void {
    this.post({ drawn: true });
  }

  close(): void {
    this.worker.terminate();
  }

  private post(message: ToWorker): void {
    this.worker.postMessage(message);
  }
}
