import type { Command } from "../protocol";

/** What a transport tells. */
export interface Receiver {
  /** Whether the engine is there now. */
  connected(connected: boolean): void;
  /** A message came. */
  text(json: string): void;
  /** A frame came. */
  binary(bytes: ArrayBuffer): void;
  /** It broke; what to do about it. */
  failed(reason: string): void;
}

/** The way to an engine, wherever it runs. */
export interface Transport {
  /** Sends a command; lost where the engine is not there. */
  send(command: Command): void;
  /** The last frame that came was drawn: the next may come. */
  drawn(): void;
  close(): void;
}

/** From a page to the worker that holds its transport. `load` says where the engine is. */
export type ToWorker = { load: string } | { command: Command } | { drawn: true };
/** From that worker to the page. */
export type FromWorker =
  | { connected: boolean }
  | { text: string }
  | { binary: ArrayBuffer }
  | { failed: string };
