import { readFileSync } from "node:fs";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { Controls } from "../src/controls";
import type { Notice } from "../src/notice";
import type { Command, Example, Scene } from "../src/protocol";
import { Session } from "../src/session";
import { Share } from "../src/share";
import type { View } from "../src/view/view";

const { messages } = JSON.parse(readFileSync(new URL("messages.json", import.meta.url), "utf8")) as {
  messages: { type: string }[];
};
const sample = (type: string, changes = {}) =>
  JSON.stringify({ ...messages.find((m) => m.type === type), ...changes });

const [welcomed] = (messages.find((m) => m.type === "welcome") as unknown as { examples: Example[] })
  .examples;
const runs = messages.find((m) => m.type === "scene") as unknown as Scene;

let sent: Command[];
let told: string[];
let share: Share;
/** Tells the page that its address has changed. */
let changed: (event: { newURL: string }) => void;
/** Tells it that one has gone back in the browser's history, or on. */
let travelled: (event: { state: unknown }) => void;

/** A page at an address, of a session that has said nothing yet. */
function at(hash: string): Session {
  vi.stubGlobal("location", { hash });
  const session = new Session(() => ({ send: (c) => sent.push(c), drawn: () => {}, close: () => {} }));
  const view = { lookFrom: () => {}, carried: null } as unknown as View;
  const clear = () => {
    told = [];
  };
  const notice = { tell: (text: string) => told.push(text), clear } as unknown as Notice;
  share = new Share(session, new Controls(session), view, notice);
  return session;
}

function goTo(hash: string): void {
  location.hash = hash;
  changed({ newURL: `http://page/${hash}` });
}

/** What the engine says when the page comes to it. */
function greet(session: Session, scene: { id: number; name?: string }): void {
  session.text(sample("welcome"));
  session.text(sample("scene", scene));
}

const opened = () => sent.filter(({ type }) => type === "open").length;
const written = () => {
  vi.advanceTimersByTime(1000);
  return vi.mocked(history.replaceState).mock.lastCall?.[2];
};

beforeEach(() => {
  [sent, told] = [[], []];
  vi.useFakeTimers();
  vi.stubGlobal("addEventListener", (name: string, listener: typeof changed & typeof travelled) => {
    if (name === "popstate") travelled = listener;
    else changed = listener;
  });
  vi.stubGlobal("history", { replaceState: vi.fn(), pushState: vi.fn() });
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test("what the address says is opened, whatever the engine shows", () => {
  const session = at("#example=pendula&replicas=2,2");
  greet(session, { id: 7, name: "first" });
  expect(sent).toEqual([{ type: "open", example: "pendula", build: {}, physics: {} }]);
  session.text(sample("scene", { id: 8 }));
  expect(sent.at(-1)).toEqual({ type: "show", worlds: [2, 3] });
});

test("a page that comes back goes on, unless the engine began anew", () => {
  const session = at("#example=pendula");
  greet(session, { id: 7, name: "first" });
  session.text(sample("scene", { id: 8 }));
  greet(session, { id: 8 });
  greet(session, { id: 9, name: "of another page" });
  expect(opened()).toBe(1);
  session.text(sample("scene", { id: 10 }));
  greet(session, { id: 1, name: "first" });
  expect(opened()).toBe(2);
});

test("what runs as the address says is joined, and not begun anew", () => {
  const joins = (hash: string) => {
    const session = at(hash);
    sent = [];
    greet(session, { id: 7 });
    return opened() === 0;
  };
  const [{ name, value }] = welcomed.build;
  const gravity = runs.physics.find((field) => field.name === "gravity")?.value;
  expect(joins("#example=pendula&replicas=2,2")).toBe(true);
  expect(sent).toEqual([{ type: "show", worlds: [2, 3] }]);
  expect(joins(`#example=pendula&build.${name}=${value}&physics.gravity=${gravity}`)).toBe(true);
  expect(joins(`#example=pendula&build.${name}=${value + 1}`)).toBe(false);
  expect(joins("#example=pendula&physics.gravity=1.62")).toBe(false);
  expect(joins("#example=pendula&build.nothing=1")).toBe(false);
});

test("what one opens becomes a step of the history, files too", () => {
  const session = at("");
  greet(session, { id: 1, name: "robot.xml" });
  written();
  expect(history.pushState).not.toHaveBeenCalled();
  share.openExample("pendula");
  session.text(sample("scene", { id: 2 }));
  written();
  expect(vi.mocked(history.pushState).mock.lastCall).toEqual([{ file: null }, "", "#example=pendula"]);
  const file = { type: "file", name: "cart.xml", text: "<mujoco/>" } as const;
  share.openFile(file);
  session.text(sample("scene", { id: 3, name: "cart.xml" }));
  written();
  expect(vi.mocked(history.pushState).mock.lastCall).toEqual([{ file: "cart.xml" }, "", "#"]);
  goTo("#example=pendula");
  session.text(sample("scene", { id: 4 }));
  // Back to the file: first its step comes, then its address, which names nothing.
  travelled({ state: { file: "cart.xml" } });
  goTo("#");
  expect(sent.at(-1)).toEqual(file);
  session.text(sample("scene", { id: 5, name: "cart.xml" }));
  expect(written()).toBe("#");
  expect(history.pushState).toHaveBeenCalledTimes(2);
});

test("a file that is refused is no step, and is not kept", () => {
  const session = at("");
  greet(session, { id: 1 });
  share.openFile({ type: "file", name: "broken.xml", text: "<" });
  session.text('{"type":"error","message":"no","refused":"file"}');
  session.text(sample("scene", { id: 2 }));
  written();
  expect(history.pushState).not.toHaveBeenCalled();
  expect([...share.files]).toEqual([]);
});

test("what was told is gone when something else is opened", () => {
  greet(at(""), { id: 7 });
  const file = { type: "file", name: "cart.xml", text: "<mujoco/>" } as const;
  for (const open of [
    () => goTo("#example=pendula"),
    () => share.openExample("pendula"),
    () => share.openFile(file),
  ]) {
    told.push("broken.xml: not well-formed XML");
    open();
    expect(told).toEqual([]);
  }
});

test("an example that does not exist is told, and not in the address any more", () => {
  greet(at("#example=nothing&physics.gravity=3"), { id: 1 });
  expect(opened()).toBe(0);
  expect(told).toEqual(["There is no example nothing."]);
  expect(written()).toBe("#example=pendula");
});

test("what was refused of an address is not in it any more", () => {
  const session = at("#example=pendula&physics.gravity=1e9");
  greet(session, { id: 1 });
  session.text('{"type":"error","message":"no","refused":"open"}');
  expect(sent.at(-1)).toEqual({ type: "open", example: "pendula", build: {}, physics: {} });
  session.text(sample("scene", { id: 2 }));
  expect(written()).toBe("#example=pendula");
});

test("a body that does not exist carries no camera", () => {
  const session = at("#example=pendula&ride=77");
  greet(session, { id: 1 });
  session.text(sample("scene", { id: 2 }));
  expect(written()).toBe("#example=pendula");
});

test("an address that changes is gone to, or says what is shown", () => {
  const session = at("");
  greet(session, { id: 1 });
  goTo("#example=pendula");
  expect(opened()).toBe(1);
  session.text(sample("scene", { id: 2 }));
  goTo("#example=nothing");
  expect(opened()).toBe(1);
  expect(written()).toBe("#example=pendula");
});

test("an address that changes is gone to, though the page writes its own before it is told", () => {
  const session = at("");
  greet(session, { id: 1 });
  location.hash = "#example=pendula";
  written();
  location.hash = "#example=first";
  changed({ newURL: "http://page/#example=pendula" });
  expect(opened()).toBe(1);
});
