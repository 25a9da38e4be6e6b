import { readFileSync } from "node:fs";
import { beforeEach, expect, test, vi } from "vitest";
import type { Command } from "../src/protocol";
import { Session } from "../src/session";
import { writeFrame } from "./frames";

const { messages } = JSON.parse(readFileSync(new URL("messages.json", import.meta.url), "utf8")) as {
  messages: { type: string }[];
};
const sample = (type: string) => JSON.stringify(messages.find((m) => m.type === type));
const still = [0, 0, 0, 0, 0, 0, 1];

let session: Session;
let sent: Command[];
let drawn: number;
let errors: string[];

beforeEach(() => {
  sent = [];
  errors = [];
  drawn = 0;
  session = new Session(() => ({ send: (c) => sent.push(c), drawn: () => drawn++, close: () => {} }));
  session.on("error", (e) => errors.push(e));
});

test("the last of everything is kept", () => {
  session.text(sample("welcome"));
  session.text(sample("scene"));
  session.text(sample("status"));
  session.binary(writeFrame({ scene: 1, worlds: 1, bodies: 1, poses: still, time: 0.5 }));
  expect(session.examples.map((e) => e.name)).toEqual(["pendula"]);
  expect(session.scene?.title).toBe("Pendula");
  expect(session.shown).toEqual([0, 1, 2, 3]);
  expect(session.status?.steps).toBe(625);
  expect(session.frame?.time).toBe(0.5);
  expect(errors).toEqual([]);
});

test("whether it runs is as the last status says, or a frame that tells of its end", () => {
  const told: boolean[] = [];
  session.on("running", (running) => told.push(running));
  const status = (running: boolean) => {
    session.text(JSON.stringify({ ...JSON.parse(sample("status")), running }));
  };
  const frame = (running: boolean) => {
    session.binary(writeFrame({ scene: 1, worlds: 1, bodies: 1, poses: still, running }));
  };
  session.text(sample("scene"));
  status(true);
  // The frame of a step that is done comes before its status.
  frame(false);
  expect(session.running).toBe(false);
  status(false);
  // One that has waited while another was drawn is of before.
  frame(true);
  expect(session.running).toBe(false);
  session.send({ type: "run" });
  status(true);
  session.send({ type: "run" });
  frame(false);
  expect(session.running).toBe(true);
  expect(told).toEqual([true, false, true]);
});

test("frames of another scene are dropped, and the next may come", () => {
  session.text(sample("scene"));
  session.binary(writeFrame({ scene: 2, worlds: 1, bodies: 1, poses: still }));
  expect(session.frame).toBeNull();
  expect(errors).toEqual([]);
  expect(drawn).toBe(1);
});

test("a new scene frees the way for its frames", () => {
  session.text(sample("scene"));
  session.binary(writeFrame({ scene: 1, worlds: 1, bodies: 1, poses: still }));
  expect(drawn).toBe(0);
  session.text(sample("scene"));
  expect(drawn).toBe(1);
  session.text(sample("scene"));
  expect(drawn).toBe(1);
});

test("what is malformed is told and changes nothing", () => {
  session.text(sample("scene"));
  session.text('{"type":"scene"}');
  session.binary(new ArrayBuffer(3));
  session.binary(writeFrame({ scene: 1, worlds: 1, bodies: 2, poses: [...still, ...still] }));
  expect(session.scene?.title).toBe("Pendula");
  expect(errors.length).toBe(3);
  expect(errors[2]).toContain("2 bodies, its scene 1");
  expect(drawn).toBe(2);
});

test("physics that is set is what forms show", () => {
  session.text(sample("scene"));
  const shown: number[][] = [];
  session.on("physics", (fields) => shown.push(fields.map((field) => field.value)));
  session.send({ type: "physics", values: { gravity: -1.62 } });
  expect(shown).toEqual([[-1.62, 0, 1, 0]]);
});

test("what another page sets is shown, and not said again", () => {
  session.text(sample("scene"));
  const physics: number[][] = [];
  const changed: string[][] = [];
  session.on("physics", (fields) => physics.push(fields.map((field) => field.value)));
  session.on("changed", (settings) => changed.push(settings.map(({ type }) => type)));
  for (const message of messages.filter((m) => m.type === "changed")) session.text(JSON.stringify(message));
  expect(physics).toEqual([[-1.62, 0, 1, 0]]);
  expect(session.scene?.joints[0].dofs[0].position).toBe(0.5);
  expect(session.scene?.actuators[0].value).toBe(-0.4);
  expect(changed).toEqual([["physics"], ["joint", "control"]]);
  expect(sent).toEqual([]);
  expect(errors).toEqual([]);
});

test("physics that is refused is as another page has set it since", () => {
  session.text(sample("scene"));
  session.send({ type: "physics", values: { gravity: 5 } });
  session.text('{"type":"changed","commands":[{"type":"physics","values":{"gravity":-3}}]}');
  session.text('{"type":"error","message":"no","refused":"physics"}');
  expect(session.scene?.physics.find(({ name }) => name === "gravity")?.value).toBe(-3);
});

test("worlds asked for are those shown", () => {
  session.send({ type: "show", worlds: [2] });
  expect(sent).toEqual([{ type: "show", worlds: [2] }]);
  expect(session.shown).toEqual([2]);
});

test("physics that is refused is as before", () => {
  session.text(sample("scene"));
  const refused: string[] = [];
  session.on("refused", (type) => refused.push(type));
  const [field] = session.scene?.physics ?? [];
  const before = field.value;
  session.send({ type: "physics", values: { [field.name]: before + 1 } });
  session.send({ type: "physics", values: { [field.name]: before + 2 } });
  expect(field.value).toBe(before + 2);
  session.text('{"type":"error","message":"no","refused":"physics"}');
  expect(field.value).toBe(before);
  expect(refused).toEqual(["physics"]);
  expect(errors).toEqual(["no"]);
});

test("a drive that is refused is as before", () => {
  session.text(sample("scene"));
  const dof = session.scene?.joints[0].dofs[0];
  const changed: string[][] = [];
  session.on("changed", (settings) => changed.push(settings.map(({ type }) => type)));
  if (!dof) throw new Error("The sample has no joint.");
  session.send({ type: "joint", dof: dof.dof, position: 0.25 });
  const { stiffness } = dof;
  session.send({ type: "joint", dof: dof.dof, stiffness: -1 });
  expect(dof.stiffness).toBe(-1);
  session.text('{"type":"error","message":"no","refused":"joint"}');
  expect(dof.stiffness).toBe(stiffness);
  expect(dof.position).toBe(0.25);
  expect(changed).toEqual([["joint"]]);
});

test("what is refused does not undo what was set after it", () => {
  session.text(sample("scene"));
  const dof = session.scene?.joints[0].dofs[0];
  const actuator = session.scene?.actuators[0];
  if (!dof || !actuator) throw new Error("The sample has no joint or no actuator.");
  const { stiffness } = dof;
  session.send({ type: "joint", dof: dof.dof, stiffness: -1 });
  session.send({ type: "joint", dof: dof.dof, position: 0.25 });
  session.send({ type: "joint", dof: dof.dof, stiffness: -2 });
  session.send({ type: "joint", dof: dof.dof, damping: 3 });
  session.send({ type: "control", actuator: 0, value: 0.125 });
  session.text('{"type":"error","message":"no","refused":"joint"}');
  session.text('{"type":"error","message":"no","refused":"joint"}');
  expect([dof.stiffness, dof.position, dof.damping]).toEqual([stiffness, 0.25, 3]);
  expect(actuator.value).toBe(0.125);
});

test("a motor's random control that was under way does not take back what one has set", () => {
  vi.useFakeTimers();
  session.text(sample("scene"));
  const actuator = session.scene?.actuators[0];
  const changed = '{"type":"changed","commands":[{"type":"control","actuator":0,"value":-0.5}]}';
  session.send({ type: "control", actuator: 0, value: 0.25 });
  session.text(changed);
  expect(actuator?.value).toBe(0.25);
  vi.advanceTimersByTime(1000);
  session.text(changed);
  expect(actuator?.value).toBe(-0.5);
  vi.useRealTimers();
});

test("what is refused is as another page has set it since, and what was accepted long ago stays", () => {
  session.text(sample("scene"));
  const dof = session.scene?.joints[0].dofs[0];
  if (!dof) throw new Error("The sample has no joint.");
  const refuse = () => session.text('{"type":"error","message":"no","refused":"joint"}');
  session.send({ type: "joint", dof: dof.dof, damping: -1 });
  session.text(JSON.stringify({ type: "changed", commands: [{ type: "joint", dof: dof.dof, damping: 7 }] }));
  session.send({ type: "joint", dof: dof.dof, damping: -1 });
  refuse();
  expect(dof.damping).toBe(7);
  session.send({ type: "joint", dof: dof.dof, damping: 8 });
  session.text(sample("status"));
  session.text(sample("status"));
  refuse();
  expect(dof.damping).toBe(8);
});
