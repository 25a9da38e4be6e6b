import { readFileSync } from "node:fs";
import { describe, expect, test } from "vitest";
import { command, readMessage } from "../src/protocol";

const samples = JSON.parse(readFileSync(new URL("messages.json", import.meta.url), "utf8")) as {
  commands: { type: string }[];
  messages: { type: string }[];
};
const sample = (type: string) => structuredClone(samples.messages.find((m) => m.type === type)) as never;
// biome-ignore lint/suspicious/noExplicitAny: what is broken on purpose has no type
type Anything = any;
const broken = (type: string, change: (message: Anything) => void) => {
  const message = sample(type);
  change(message);
  return () => readMessage(JSON.stringify(message));
};

describe("commands", () => {
  test.each(samples.commands)("$type", (value) => {
    expect(command(value)).toEqual(value);
  });

  test("one of every kind is among the samples", () => {
    const kinds = [
      "open",
      "file",
      "rebuild",
      "physics",
      "run",
      "stop",
      "step",
      "restart",
      "speed",
      "show",
      "joint",
    ];
    kinds.push("control", "grab", "release", "push", "plot", "scrub");
    expect([...new Set(samples.commands.map((c) => c.type))]).toEqual(kinds);
  });
});

describe("messages", () => {
  test.each(samples.messages)("$type", (value) => {
    expect(readMessage(JSON.stringify(value))).toEqual(value);
  });

  test("what is malformed is named with its place", () => {
    expect(() => readMessage("{")).toThrow("not JSON");
    expect(() => readMessage("[]")).toThrow("not an object");
    expect(() => readMessage('{"type":"hello"}')).toThrow(
      "type: not one of welcome, scene, status, changed, skin_file, dress, error",
    );
    expect(broken("status", (m) => delete m.pace)).toThrow("pace: not a finite number");
    expect(broken("status", (m) => Object.assign(m, { mood: 1 }))).toThrow("mood: unknown field");
    expect(
      broken("scene", (m) => {
        m.bodies[0].color = [1, 1, 1];
      }),
    ).toThrow("bodies[0].color: not 4 numbers");
    expect(
      broken("scene", (m) => {
        m.shapes[2].geometry.radius = "wide";
      }),
    ).toThrow("shapes[2].geometry.radius: not a finite number");
  });

  test("indices must point somewhere", () => {
    const places = ["shapes[2].body", "bodies[0].joint", "joints[0].child", "cameras[0].body"];
    for (const place of places) {
      const [, list, row, field] = place.match(/(\w+)\[(\d)\]\.(\w+)/) ?? [];
      const change = (m: Anything) => Object.assign(m[list][Number(row)], { [field]: 7 });
      expect(broken("scene", change)).toThrow(`${place}: points at 7 of 1`);
    }
    expect(broken("scene", (m) => m.shapes[8].geometry.triangles.push(4))).toThrow(
      "shapes[8].geometry.triangles: points at 4 of 4",
    );
    expect(broken("scene", (m) => m.plots.push(2))).toThrow("plots: points at 2 of 2");
    expect(broken("scene", (m) => m.shown.push(4))).toThrow("shown: points at 4 of 4");
  });

  test("another protocol is refused, with a remedy", () => {
    expect(
      broken("welcome", (m) => {
        m.protocol = 2;
      }),
    ).toThrow("the engine speaks protocol 2, this page 1; update the older");
  });
});
