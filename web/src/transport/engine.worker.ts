/** The worker that the engine runs in. */

import { Decimator } from "./decimate";
import { Engine } from "./engine";
import { findCard } from "./gpu";
import type { FromWorker, ToWorker } from "./transport";

/** Time between advances while there is nothing to do at once [ms]. */
const TICK = 1000 / 60;

function post(message: FromWorker, transfer: Transferable[] = []): void {
  self.postMessage(message, { transfer });
}

const frames = new Decimator((binary) => post({ binary }, [binary]));
let engine: Engine | null = null;

function forward(): void {
  for (const message of engine?.outgoing() ?? []) {
    if (typeof message === "string") post({ text: message });
    else frames.offer(message);
  }
}

/** What the engine does, one after the other: while it waits for a graphics card, nothing else of it may be called. */
let turns: Promise<void> = Promise.resolve();

/** Calls what may trap, in its turn; after a trap the engine's memory is not to be trusted, so it is let go. */
function inTurn(act: (engine: Engine) => Promise<void>): Promise<void> {
  turns = turns.then(async () => {
    try {
      if (engine) await act(engine);
    } catch (error) {
      engine = null;
      post({ failed: `The engine broke down: ${(error as Error).message}. Reload the page.` });
    }
  });
  return turns;
}

/** Goes on after the commands that came meanwhile; a timer would wait for some milliseconds. */
const onward = new MessageChannel();
onward.port1.onmessage = tick;

async function tick(): Promise<void> {
  const began = performance.now();
  let more = false;
  await inTurn(async (engine) => {
    more = await engine.advance();
    forward();
  });
  if (more) onward.port2.postMessage(null);
  else if (engine) setTimeout(tick, Math.max(0, TICK - (performance.now() - began)));
}

async function load(address: string): Promise<void> {
  try {
    engine = await Engine.load(address, findCard(navigator.gpu));
  } catch (error) {
    post({ failed: `The engine did not load: ${(error as Error).message}` });
    return;
  }
  post({ connected: true });
  tick();
}

self.onmessage = ({ data }: MessageEvent<ToWorker>) => {
  if ("load" in data) {
    load(data.load);
  } else if ("command" in data) {
    inTurn(async (engine) => {
      await engine.receive(JSON.stringify(data.command));
      forward();
    });
  } else {
    frames.drawn();
  }
};
