import { Page } from "../src/page";
import { Session } from "../src/session";
import "../src/style.css";
import type { Receiver } from "../src/transport/transport";
import { humanoids, particles, type Synthetic, zoo } from "./scenes";

const SCENES: Record<string, () => Synthetic> = {
  humanoids: () => humanoids(64),
  particles: () => particles(100_000),
  zoo,
};

/** Times of one scene [ms]. */
export interface Times {
  /** Reading a frame, and placing and colouring all that it moves. */
  update: number;
  /** From a frame's bytes to its picture, the graphics card's part included. */
  frame: number;
  /** Length of a frame [bytes]. */
  bytes: number;
}

declare global {
  interface Window {
    bench(scene: string, frames: number): Times;
  }
}

let receiver: Receiver | undefined;
const { view, session } = new Page(
  new Session((to) => {
    receiver = to;
    return { send: () => {}, drawn: () => {}, close: () => {} };
  }),
);

function show(name: string): Synthetic {
  const synthetic = SCENES[name]();
  receiver?.text(JSON.stringify(synthetic.scene));
  receiver?.binary(synthetic.frame(0, 0));
  view.draw(0);
  return synthetic;
}

/** Waits for the graphics card, by asking it for a pixel. */
function finish(): void {
  const gl = view.stage.renderer.getContext();
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
}

window.bench = (name, count) => {
  const synthetic = show(name);
  const frames = Array.from({ length: count + 3 }, (_, i) => synthetic.frame(i / 60, i + 1));
  const update: number[] = [];
  const whole: number[] = [];
  finish();
  for (const bytes of frames) {
    const began = performance.now();
    session.binary(bytes);
    if (session.frame) view.current?.draw(session.frame, null, false);
    update.push(performance.now() - began);
    view.draw(1 / 60);
    finish();
    whole.push(performance.now() - began);
  }
  // The first ones compile shaders.
  const bytes = frames[count].byteLength;
  return { update: median(update.slice(3)), frame: median(whole.slice(3)), bytes };
};

function median(values: number[]): number {
  return values.sort((a, b) => a - b)[values.length >> 1];
}

show(new URLSearchParams(location.search).get("scene") ?? "zoo");
