import { readFileSync } from "node:fs";
import { Color, type Line, Matrix4, Quaternion, Vector3 } from "three";
import { describe, expect, test } from "vitest";
import { readFrame } from "../src/frame";
import { readMessage, type Scene } from "../src/protocol";
import { multiply, placed, writePose } from "../src/view/affine";
import { fading, held, Lamps, sunOf } from "../src/view/lamps";
import { measure, moves, reach, worldShifts } from "../src/view/layout";
import { Materials } from "../src/view/materials";
import { ordinaryWeight } from "../src/view/overlays/contacts";
import { JointAxes } from "../src/view/overlays/joints";
import { Trails } from "../src/view/overlays/trails";
import { isFloor, PartMaker } from "../src/view/parts";
import { Poses } from "../src/view/poses";
import { Forms, sides } from "../src/view/shape_geometry";
import { Gauge, viridis } from "../src/view/skins/gauges";
import { Wardrobe } from "../src/view/skins/skin";
import { writeFrame } from "./frames";

const { messages } = JSON.parse(readFileSync(new URL("messages.json", import.meta.url), "utf8")) as {
  messages: { type: string }[];
};
const scene = () => readMessage(JSON.stringify(messages.find((m) => m.type === "scene"))) as Scene;
const turned = new Quaternion().setFromAxisAngle(new Vector3(1, 2, 3).normalize(), 0.7);
const pose = [1, 2, 3, ...turned.toArray()];

function expectClose(got: ArrayLike<number>, wanted: ArrayLike<number>): void {
  expect(got.length).toBe(wanted.length);
  for (let i = 0; i < wanted.length; i++) expect(got[i]).toBeCloseTo(wanted[i], 5);
}

describe("maps", () => {
  const reference = new Matrix4().compose(new Vector3(1, 2, 3), turned, new Vector3(1, 1, 1));

  test("of a pose, moved", () => {
    const out = new Float32Array(16);
    writePose(out, 0, pose, 0, [10, 0, -1], 0);
    expectClose(out, new Matrix4().makeTranslation(10, 0, -1).multiply(reference).elements);
  });
  test("products", () => {
    const out = new Float32Array(16);
    multiply(out, 0, reference.elements, 0, reference.elements, 0);
    expectClose(out, reference.clone().multiply(reference).elements);
  });
  test("of a placement, scaled", () => {
    const placement = { position: [1, 2, 3] as [number, number, number], orientation: turned.toArray() };
    const scaled = new Matrix4().compose(new Vector3(1, 2, 3), turned, new Vector3(2, 3, 4));
    expectClose(placed(placement, [2, 3, 4]), scaled.elements);
  });
});

describe("layout", () => {
  test("one world stands in the middle", () => {
    expect([...worldShifts(1, 2, "y")]).toEqual([0, 0, 0]);
  });
  test("worlds stand on the ground, about the middle, a spacing apart", () => {
    expect([...worldShifts(4, 2, "y")]).toEqual([-1, 0, -1, 1, 0, -1, -1, 0, 1, 1, 0, 1]);
    const shifts = worldShifts(4, 2, "z");
    expect([2, 5, 8, 11].map((i) => shifts[i])).toEqual([0, 0, 0, 0]);
    expect([...shifts.slice(0, 3)]).toEqual([-1, 1, 0]);
  });
  test("reach of a shape holds its offset", () => {
    const shape = scene().shapes[3];
    expect(reach(shape)).toBeCloseTo(0.5 + 0.125);
  });
  test("what hangs on the world may swing all about", () => {
    const model = scene();
    model.bounds = [
      [0, -0.1, -0.1],
      [0.5, 0.1, 0.1],
    ];
    const [low, high] = moves(model, measure(model));
    expect(low[0]).toBeCloseTo(-high[0]);
    expect(low[1]).toBeLessThan(-0.5);
    // A hinge about z swings in its plane alone.
    expect([low[2], high[2]]).toEqual([-0.1, 0.1]);
  });
  test("fewer sides where there are more shapes", () => {
    expect([1, 500, 5000].map(sides)).toEqual([32, 20, 12]);
  });
});

describe("lamps", () => {
  test("one of them is the sun", () => {
    const model = scene();
    // Turned by half a turn about x, it shines upwards along z.
    const sun = sunOf(model);
    expectClose(sun?.to ?? [], [0, 0, -1]);
    expect(sun?.color).toEqual([1, 0.75, 0.5]);
    expect(sunOf({ ...model, sun: -1 })?.color).toEqual([0, 0, 0]);
    expect(sunOf({ ...model, lamps: [], sun: -1 })).toBeNull();
  });
  test("fade by the power that touches their law", () => {
    expect(fading([2, 0, 0], 5)).toEqual({ power: 0, strength: 0.5 });
    expect(fading([0, 0, 4], 5)).toEqual({ power: 2, strength: 0.25 });
    const law = (d: number) => 1 / (1 + 2 * d + 3 * d ** 2);
    const { power, strength } = fading([1, 2, 3], 1.5);
    const [d, h] = [1.5, 1e-4];
    expect(strength * d ** -power).toBeCloseTo(law(d), 12);
    const slope = (strength * (d + h) ** -power - strength * (d - h) ** -power) / (2 * h);
    expect(slope).toBeCloseTo((law(d + h) - law(d - h)) / (2 * h), 6);
  });
  test("shine out of what holds them", () => {
    const { lamps, shapes } = scene();
    const lamp = { ...lamps[1], mode: "fixed" as const };
    const at = (y: number) => ({
      ...lamp,
      placement: { ...lamp.placement, position: [0, y, 0] as [number, number, number] },
    });
    // A ball of radius 0.125 at y = −0.5.
    expect(held(at(-0.5), shapes.slice(3, 4))).toBeCloseTo(0.125);
    expect(held(at(-0.4), shapes.slice(3, 4))).toBeCloseTo(0.225);
    expect(held(at(-0.3), shapes.slice(3, 4))).toBe(0);
    expect(held({ ...at(-0.5), body: -1 }, shapes.slice(3, 4))).toBe(0);
  });
  test("go along with their bodies, and those that track do not turn", () => {
    const model = scene();
    model.lamps[1].placement.position = [1, 0, 0];
    const poses = new Poses(model);
    const bodies = model.bodies.flatMap(() => pose);
    const at = (mode: "fixed" | "track") => {
      model.lamps[1].mode = mode;
      const lamps = new Lamps(model, measure(model));
      poses.update(readFrame(writeFrame({ worlds: 1, bodies: model.bodies.length, poses: bodies })));
      lamps.move(poses);
      const [light] = lamps.children;
      const shift = new Vector3().fromArray(poses.shifts);
      return light.position
        .clone()
        .sub(shift)
        .sub(new Vector3(1, 2, 3))
        .toArray();
    };
    expectClose(at("track"), [1, 0, 0]);
    expectClose(at("fixed"), new Vector3(1, 0, 0).applyQuaternion(turned).toArray());
  });
});

test("poses of worlds are beside each other", () => {
  const poses = new Poses(scene());
  poses.update(readFrame(writeFrame({ worlds: 2, bodies: 1, poses: [...pose, ...pose] })));
  const [matrices, second] = poses.of(1, 0);
  const [, first] = poses.of(0, 0);
  expect(matrices[second + 12] - matrices[first + 12]).toBeCloseTo(2.5);
  const [origins, world] = poses.of(1, -1);
  expect(origins[world + 12]).toBeCloseTo(1.25);
});

describe("parts", () => {
  const maker = (model: Scene) => new PartMaker(model, measure(model), new Forms(12), new Materials());
  const style = { translucent: false, wireframe: false };

  test("all shapes but the floor, which is drawn apart", () => {
    const model = scene();
    expect(model.shapes.map((shape) => isFloor(shape, "y"))).toEqual(model.shapes.map((_, row) => row === 0));
    const parts = maker(model).make(new Wardrobe(), style);
    expect(parts.map((part) => part.shape)).toEqual([1, 2, 3, 4, 5, 6, 7, 8]);
  });
  test("a skin of its own for one body leaves the world's shapes alone", () => {
    const wardrobe = new Wardrobe();
    wardrobe.dressAll({ kind: "gauge", gauge: "speed" });
    wardrobe.dress(0, { kind: "color", color: new Color("red") });
    expect(wardrobe.of(0).kind).toBe("color");
    expect(wardrobe.of(1).kind).toBe("gauge");
    expect(wardrobe.of(-1).kind).toBe("plain");
    expect([...wardrobe.gauges]).toEqual(["speed"]);
  });
  test("gauges are read apart, and what one body wears is forgotten alone", () => {
    const wardrobe = new Wardrobe();
    wardrobe.dressAll({ kind: "gauge", gauge: "height" });
    wardrobe.dress(0, { kind: "gauge", gauge: "speed" });
    expect([...wardrobe.gauges]).toEqual(["height", "speed"]);
    wardrobe.undress();
    expect(wardrobe.of(0)).toEqual({ kind: "gauge", gauge: "height" });
  });
  test("forms that differ by a scaling share their triangles", () => {
    const forms = new Forms(12);
    const small = forms.of({ kind: "sphere", radius: 1 }, 1);
    const large = forms.of({ kind: "ellipsoid", half: [1, 2, 3] }, 1);
    expect(large.geometry).toBe(small.geometry);
    const capsule = (radius: number) =>
      forms.of({ kind: "capsule", radius, half_height: 2 * radius }, 1).geometry;
    expect(capsule(1)).toBe(capsule(3));
  });
  test("a capsule is as high as its half height says, ends included", () => {
    const { geometry, scale } = new Forms(12).of({ kind: "capsule", radius: 0.1, half_height: 0.4 }, 1);
    geometry.computeBoundingBox();
    expect((geometry.boundingBox?.max.y ?? 0) * scale[1]).toBeCloseTo(0.4);
    expect((geometry.boundingBox?.max.x ?? 0) * scale[0]).toBeCloseTo(0.1);
  });
  test("a cone's apex points along +y", () => {
    const { geometry } = new Forms(12).of({ kind: "cone", radius: 1, half_height: 1 }, 1);
    const position = geometry.getAttribute("position");
    const top = Array.from({ length: position.count }, (_, i) => i).filter((i) => position.getY(i) > 0.99);
    for (const i of top) expect(Math.hypot(position.getX(i), position.getZ(i))).toBeLessThan(1e-6);
  });
});

test("trails begin anew where other worlds are shown", () => {
  const model = scene();
  const [trails, poses] = [new Trails(model), new Poses(model)];
  trails.choice = "all";
  const lengths = [0, 0, 1, 1].map((choices, time) => {
    const frame = readFrame(writeFrame({ worlds: 1, bodies: 1, poses: pose, time, choices }));
    poses.update(frame);
    trails.draw({ scene: model, frame, poses, measures: measure(model), picked: null });
    const [line] = trails.object.children as Line[];
    return line.geometry.drawRange.count;
  });
  expect(lengths).toEqual([1, 2, 1, 2]);
});

test("a range of many turns is drawn as a circle", () => {
  const model = scene();
  model.joints[0].dofs[0].limit = [-1e9, 1e9];
  const [axes, poses] = [new JointAxes(), new Poses(model)];
  const frame = readFrame(writeFrame({ worlds: 1, bodies: 1, poses: pose }));
  poses.update(frame);
  axes.draw({ scene: model, frame, poses, measures: measure(model), picked: null });
  // Its axis, 48 lines of the circle, and both ends.
  expect(axes.object.geometry.instanceCount).toBe(1 + 48 + 2);
});

test("forces are measured by whole trees, not by their limbs", () => {
  const body = { ...scene().bodies[0], dynamic: true };
  const joint = scene().joints[0];
  const told = {
    ...scene(),
    // A trunk with two legs, a foot below one, and something on a table.
    bodies: [10, 1, 1, 0.5, 2]
      .map((mass, row) => ({ ...body, mass, joint: row }))
      .concat({ ...body, dynamic: false, mass: 99, joint: -1 }),
    joints: [-1, 0, 0, 1, 5].map((parent, child) => ({ ...joint, parent, child })),
  };
  expect(ordinaryWeight(told)).toBeCloseTo(9.81 * 12.5);
  expect(ordinaryWeight({ ...told, bodies: [] })).toBe(9.81);
});

describe("gauges", () => {
  const at = (x: number, time: number, choices = 0) =>
    readFrame(writeFrame({ worlds: 1, bodies: 1, poses: [x, 0.5, 0, 0, 0, 0, 1], time, choices }));

  test("speed is the way between frames, by the time", () => {
    const gauge = new Gauge(scene(), "speed");
    gauge.update(at(0, 0));
    gauge.update(at(0.5, 0.25));
    expect(gauge.range).toEqual([0, 2]);
    expect(gauge.color(0, 0, new Color()).getHexString()).toBe("fde725");
  });
  test("from world to world nothing has a speed", () => {
    const gauge = new Gauge(scene(), "speed");
    gauge.update(at(0, 0));
    gauge.update(at(5, 0.25, 1));
    expect(gauge.range).toEqual([0, 0]);
  });
  test("force is the sum of a body's contacts", () => {
    const gauge = new Gauge(scene(), "force");
    const contact = [0, 0, 0, 0, 3, 4, 0, 0, 0, 2];
    const frame = writeFrame({ worlds: 1, bodies: 1, poses: pose, contacts: [...contact, ...contact] });
    gauge.update(readFrame(frame));
    expect(gauge.range[1]).toBeCloseTo(10);
  });
  test("the scale goes from dark to bright", () => {
    expect(viridis(-1, new Color()).getHexString()).toBe("440154");
    expect(viridis(2, new Color()).getHexString()).toBe("fde725");
  });
});
