/** An engine that a worker of the page has, or is connected to. */

import type { Command } from "../protocol";
import type { FromWorker, Receiver, ToWorker, Transport } from "./transport";

export class WorkerTransport implements Transport {
  /** `engine` is the address of what the worker loads. */
  constructor(
    private readonly worker: Worker,
    engine: string,
    receiver: Receiver,
  ) {
    this.worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
      if ("text" in data) receiver.text(data.text);
      else if ("binary" in data) receiver.binary(data.binary);
      else if ("failed" in data) receiver.failed(data.failed);
      else receiver.connected(data.connected);
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
