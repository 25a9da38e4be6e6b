/** An engine behind a WebSocket, at `/session` of the host that serves the page. */

import type { Command } from "../protocol";
import { Decimator } from "./decimate";
import type { Receiver, Transport } from "./transport";

/** Waits before the first and the last attempts to connect again [ms]. */
const [FIRST_WAIT, LONGEST_WAIT] = [250, 5000];

/** The engine's address beside the page's; a `token` in the page's query goes along. */
export function sessionAddress(page: string): string {
  const address = new URL("session", page);
  const token = new URL(page).searchParams.get("token");
  address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
  address.search = token === null ? "" : `?token=${encodeURIComponent(token)}`;
  address.hash = "";
  return address.href;
}

/** Connects, and again whenever the connection is lost. */
export class WebSocketTransport implements Transport {
  private socket: WebSocket | null = null;
  private retry: ReturnType<typeof setTimeout> | undefined;
  private wait = FIRST_WAIT;
  private readonly frames: Decimator;

  constructor(
    private readonly address: string,
    private readonly receiver: Receiver,
  ) {
    this.frames = new Decimator((frame) => receiver.binary(frame));
    this.connect();
  }

  send(command: Command): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(command));
  }

  drawn(): void {
    this.frames.drawn();
  }

  close(): void {
    clearTimeout(this.retry);
    const socket = this.socket;
    this.socket = null;
    socket?.close();
  }

  private connect(): void {
    const socket = new WebSocket(this.address);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      this.wait = FIRST_WAIT;
      this.receiver.connected(true);
    };
    socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) => {
      if (typeof data === "string") this.receiver.text(data);
      else this.frames.offer(data);
    };
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.receiver.connected(false);
      this.retry = setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
    };
  }
}
