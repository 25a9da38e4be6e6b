import { readFileSync } from "node:fs";
import { Color, Texture } from "three";
import { beforeEach, describe, expect, test } from "vitest";
import { readMessage, type Scene, type SkinFile } from "../src/protocol";
import { Session } from "../src/session";
import { measure } from "../src/view/layout";
import { Materials } from "../src/view/materials";
import { PartMaker } from "../src/view/parts";
import { Forms } from "../src/view/shape_geometry";
import { Dresser } from "../src/view/skins/dresser";
import { type Skin, sameParts, Wardrobe, type Worn } from "../src/view/skins/skin";

const { messages } = JSON.parse(readFileSync(new URL("messages.json", import.meta.url), "utf8")) as {
  messages: { type: string }[];
};
const sample = (type: string) => JSON.stringify(messages.find((m) => m.type === type));
const scene = () => readMessage(sample("scene")) as Scene;
const file = (id: string) => JSON.stringify({ ...JSON.parse(sample("skin_file")), id });
const dress = (skin: object, bodies: number[] | null = [0], of = 1) =>
  JSON.stringify({ type: "dress", scene: of, outfits: [{ bodies, skin }], forget: [] });
const wearing = (id: string) => dress({ kind: "file", file: id, fitted: false });
const picture = (): Skin => ({ kind: "picture", picture: new Texture() });
const settled = () => new Promise((done) => setTimeout(done));

describe("a program dresses bodies", () => {
  let session: Session;
  let worn: Worn[];
  let errors: string[];
  let read: Map<string, { done: (skin: Skin) => void; fail: (error: Error) => void }>;

  beforeEach(() => {
    session = new Session(() => ({ send: () => {}, drawn: () => {}, close: () => {} }));
    [worn, errors, read] = [[], [], new Map()];
    session.on("error", (error) => errors.push(error));
    const reader = ({ id }: SkinFile) =>
      new Promise<Skin>((done, fail) => {
        read.set(id, { done, fail });
      });
    new Dresser(session, (some) => worn.push(...some), reader);
    session.text(sample("scene"));
  });
  const kinds = () => worn.map(({ skin }) => skin.kind);

  test("in colours, sRGB, and by gauges", async () => {
    session.text(dress({ kind: "color", color: [1, 0.5, 0, 0.25001] }));
    session.text(dress({ kind: "gauge", gauge: "force" }, null));
    await settled();
    const [color, gauge] = worn;
    expect(color).toEqual({
      bodies: [0],
      skin: { kind: "color", color: new Color().setRGB(1, 0.5, 0, "srgb"), opacity: 64 / 255 },
    });
    expect(gauge).toEqual({ bodies: null, skin: { kind: "gauge", gauge: "force" } });
    expect(errors).toEqual([]);
  });
  test("in its order, though a picture is read slowly", async () => {
    session.text(file("a"));
    session.text(wearing("a"));
    session.text(dress({ kind: "replica" }));
    await settled();
    expect(worn).toEqual([]);
    read.get("a")?.done(picture());
    await settled();
    expect(kinds()).toEqual(["picture", "replica"]);
  });
  test("what cannot be read is told, and the body stays as it is", async () => {
    session.text(file("a"));
    session.text(wearing("a"));
    session.text(wearing("b"));
    session.text(dress({ kind: "plain" }));
    read.get("a")?.fail(new Error("white.png is no picture"));
    await settled();
    expect(kinds()).toEqual(["plain"]);
    expect(errors[0]).toBe("white.png is no picture");
    expect(errors[1]).toContain("did not send, b");
  });
  test("a file is there until it is forgotten, whose texture is let go", async () => {
    const skin = picture();
    let disposed = 0;
    if (skin.kind === "picture") skin.picture.addEventListener("dispose", () => disposed++);
    session.text(file("a"));
    read.get("a")?.done(skin);
    session.text(wearing("a"));
    session.text(wearing("a"));
    await settled();
    expect([kinds(), disposed]).toEqual([["picture", "picture"], 0]);
    session.text(JSON.stringify({ type: "dress", scene: 1, outfits: [], forget: ["a"] }));
    session.text(wearing("a"));
    await settled();
    expect([kinds().length, disposed, errors.length]).toEqual([2, 1, 1]);
  });
  test("of another scene, and beyond this one's bodies, nobody", async () => {
    session.text(dress({ kind: "plain" }, [0], 2));
    session.text(dress({ kind: "plain" }, [1]));
    session.text(file("a"));
    session.text(wearing("a"));
    session.text(dress({ kind: "replica" }, null));
    session.text(JSON.stringify({ ...scene(), id: 2 }));
    read.get("a")?.done(picture());
    await settled();
    // What all of them wear, those of the next scene do, too.
    expect(kinds()).toEqual(["replica"]);
    expect(errors).toEqual([expect.stringContaining("dresses body 1 of 1")]);
  });
});

describe("parts", () => {
  const style = { translucent: false, wireframe: false };
  const red = (opacity?: number): Skin => {
    const skin = { kind: "color", color: new Color("red") } as const;
    return opacity === undefined ? skin : { ...skin, opacity };
  };

  test("are made anew where another form or opacity is worn", () => {
    expect(sameParts(red(1), { kind: "color", color: new Color("blue"), opacity: 1 })).toBe(true);
    expect(sameParts({ kind: "plain" }, { kind: "gauge", gauge: "spin" })).toBe(true);
    expect(sameParts(red(1), red(0.5))).toBe(false);
    expect(sameParts(picture(), { kind: "plain" })).toBe(false);
    expect(sameParts({ kind: "plain" }, picture())).toBe(false);
  });
  test("a colour's opacity is worn instead of the shapes'", () => {
    const model = scene();
    const [materials, wardrobe] = [new Materials(), new Wardrobe()];
    const maker = new PartMaker(model, measure(model), new Forms(12), materials);
    const opacities = () =>
      maker.make(wardrobe, style).flatMap((p) => (p.body === 0 ? p.material.opacity : []));
    const plain = opacities();
    wardrobe.dress(0, red());
    expect(opacities()).toEqual(plain);
    wardrobe.dress(0, red(0.25));
    expect(Math.max(...opacities())).toBe(0.25);
  });
  test("a picture that is worn no more is let go", () => {
    const model = scene();
    const [materials, wardrobe] = [new Materials(), new Wardrobe()];
    const maker = new PartMaker(model, measure(model), new Forms(12), materials);
    wardrobe.dress(0, picture());
    const parts = maker.make(wardrobe, style);
    const pictured = parts.find(({ body }) => body === 0)?.material;
    let disposed = 0;
    pictured?.addEventListener("dispose", () => disposed++);
    materials.keep(parts);
    expect(disposed).toBe(0);
    wardrobe.dress(0, { kind: "plain" });
    materials.keep(maker.make(wardrobe, style));
    expect(disposed).toBe(1);
  });
});
