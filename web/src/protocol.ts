/**
 * The messages between an engine and the page: JSON objects with a field `type`. All units are SI, angles in
 * radians, quaternions x, y, z, w, colours sRGB from 0 to 1. Indices count from 0; −1 is the world.
 *
 * `protocol.rs` says the same in Rust, with the meaning of each field; a test of each side reads the messages
 * that `tests/messages.json` holds.
 */

import {
  array,
  type Checked,
  count,
  flag,
  integer,
  Malformed,
  nullable,
  number,
  object,
  oneOf,
  optional,
  pair,
  quadruple,
  record,
  tagged,
  text,
  triple,
} from "./schema";

/** Version of messages and frames. */
export const PROTOCOL = 1;

const values = record(number);
/** Values of a form by the names of its fields. A flag is 0 or 1, a choice the row of its name. */
export type Values = Checked<typeof values>;

/** What forms and sliders of all pages show. */
const settings = {
  physics: { values },
  joint: {
    dof: count,
    position: optional(number),
    stiffness: optional(number),
    velocity: optional(number),
    damping: optional(number),
  },
  control: { actuator: count, value: number },
};

/** From the page to the engine. */
export const command = tagged("type", {
  open: { example: text, build: optional(values), physics: optional(values) },
  file: { name: text, text },
  rebuild: { build: values },
  run: {},
  stop: {},
  step: { steps: count },
  restart: {},
  speed: { factor: nullable(number) },
  show: { worlds: array(count) },
  ...settings,
  grab: { world: count, body: count, point: triple, to: triple },
  release: {},
  push: { world: count, body: count, point: triple, impulse: triple },
  plot: { quantities: array(count) },
  scrub: { time: number },
});
export type Command = Checked<typeof command>;

const setting = tagged("type", settings);
/** A command that sets physics, a drive or an actuator. */
export type Setting = Checked<typeof setting>;

const field = object({
  name: text,
  label: text,
  unit: text,
  help: text,
  note: optional(text),
  kind: tagged("kind", {
    number: { min: number, max: number, logarithmic: flag },
    integer: { min: number, max: number },
    flag: {},
    choice: { names: array(text) },
  }),
  value: number,
});
/** A field of a form. */
export type Field = Checked<typeof field>;

const example = object({ name: text, title: text, about: text, guide: text, build: array(field) });
/** An example of the gallery. */
export type Example = Checked<typeof example>;

const placement = object({ position: triple, orientation: quadruple });
/** A position [m] and an orientation. */
export type Placement = Checked<typeof placement>;

const body = object({
  name: text,
  dynamic: flag,
  mass: number,
  inertial: placement,
  inertia: triple,
  joint: integer,
  color: quadruple,
});
export type Body = Checked<typeof body>;

const geometry = tagged("kind", {
  plane: { half: nullable(pair) },
  sphere: { radius: number },
  capsule: { radius: number, half_height: number },
  cylinder: { radius: number, half_height: number },
  cone: { radius: number, half_height: number },
  box: { half: triple },
  ellipsoid: { half: triple },
  mesh: { positions: array(number), triangles: array(count), flat: flag },
});
/** Forms of shapes, in their own frames; capsules, cylinders and cones stand along y. */
export type Geometry = Checked<typeof geometry>;

const shape = object({
  name: text,
  body: integer,
  placement,
  geometry,
  collides: flag,
  sensor: flag,
  color: nullable(quadruple),
});
export type Shape = Checked<typeof shape>;

const slider = <const N extends string>(...names: N[]) =>
  object({
    name: oneOf(...names),
    label: text,
    unit: text,
    help: text,
    min: number,
    max: number,
    logarithmic: flag,
    strict: flag,
  });
const drive = slider("position", "stiffness", "velocity", "damping");
/** What a slider sets, and how far it goes. */
export type Slider = Checked<typeof drive> | Checked<typeof control>;

const dof = object({
  name: text,
  dof: count,
  angular: flag,
  axis: triple,
  point: triple,
  limit: nullable(pair),
  position: number,
  stiffness: number,
  velocity: number,
  damping: number,
  sliders: flag,
  drive: array(drive),
});
/** A degree of freedom. */
export type Dof = Checked<typeof dof>;

const joint = object({
  name: text,
  kind: text,
  parent: integer,
  child: integer,
  parent_frame: placement,
  child_frame: placement,
  dofs: array(dof),
  coordinate: integer,
  coordinates: count,
});
export type Joint = Checked<typeof joint>;

const control = slider("value");
const actuator = object({ name: text, value: number, slider: control });

const camera = object({
  name: text,
  body: integer,
  mode: oneOf("fixed", "track"),
  placement,
  field_of_view: number,
});
/** A camera that looks along its −z, with +y up; one that tracks goes along with its body and does not turn. */
export type Camera = Checked<typeof camera>;

const lamp = object({
  name: text,
  body: integer,
  mode: oneOf("fixed", "track"),
  placement,
  beam: tagged("kind", { parallel: {}, point: {}, spot: { cutoff: number, exponent: number } }),
  color: triple,
  attenuation: triple,
  shadows: flag,
});
/** A light that shines along its −z. */
export type Lamp = Checked<typeof lamp>;

const quantity = object({ label: text, unit: text, group: text });
/** A number that changes with time, of the first world shown. */
export type Quantity = Checked<typeof quantity>;

const scene = {
  id: count,
  name: text,
  title: text,
  guide: text,
  up: oneOf("y", "z"),
  time_step: number,
  worlds: count,
  solver: text,
  isa: text,
  build: array(field),
  physics: array(field),
  bodies: array(body),
  shapes: array(shape),
  joints: array(joint),
  actuators: array(actuator),
  cameras: array(camera),
  lamps: array(lamp),
  sun: integer,
  quantities: array(quantity),
  unlisted: nullable(text),
  plots: array(count),
  shown: array(count),
  spacing: number,
  bounds: (value: unknown) => {
    const corners = array(triple)(value);
    if (corners.length !== 2) throw new Malformed("not two corners");
    return corners as [Checked<typeof triple>, Checked<typeof triple>];
  },
};

const status = {
  running: flag,
  card: nullable(text),
  time: number,
  steps: count,
  speed: nullable(number),
  pace: number,
  rate: number,
  diverged: array(count),
  shown: array(count),
  plots: array(count),
  recorded: pair,
};

const skin = tagged("kind", {
  plain: {},
  color: { color: quadruple },
  replica: {},
  gauge: { gauge: oneOf("speed", "spin", "force", "height") },
  file: { file: text, fitted: flag },
});
const outfit = object({ bodies: nullable(array(count)), skin });
/** What some bodies wear; all of them, where none are named. */
export type Outfit = Checked<typeof outfit>;

/** From the engine to the page, as text. */
export const message = tagged("type", {
  welcome: { protocol: count, examples: array(example) },
  scene,
  status,
  changed: { commands: array(setting) },
  skin_file: { id: text, name: text, format: oneOf("png", "jpeg", "webp", "glb"), data: text },
  dress: { scene: count, outfits: array(outfit), forget: array(text) },
  error: { message: text, refused: nullable(text) },
});
export type Message = Checked<typeof message>;
/** All of a model that the page shows. */
export type Scene = Extract<Message, { type: "scene" }>;
/** How it goes. */
export type Status = Extract<Message, { type: "status" }>;
/** A picture or a model that bodies may wear. */
export type SkinFile = Extract<Message, { type: "skin_file" }>;
/** Who wears what from now on, as a program says. */
export type Dress = Extract<Message, { type: "dress" }>;

/** Reads a message. Throws {@link Malformed} where it is none, or where an index in it points nowhere. */
export function readMessage(json: string): Message {
  let value: unknown;
  try {
    value = JSON.parse(json);
  } catch {
    throw new Malformed("not JSON");
  }
  const read = message(value);
  if (read.type === "welcome" && read.protocol !== PROTOCOL) {
    throw new Malformed(
      `the engine speaks protocol ${read.protocol}, this page ${PROTOCOL}; update the older`,
    );
  }
  if (read.type === "scene") checkIndices(read);
  return read;
}

function checkIndices(scene: Scene): void {
  const bodies = scene.bodies.length;
  const within = (what: string, index: number, end: number, least = 0) => {
    if (index < least || index >= end) throw new Malformed(`points at ${index} of ${end}`).inside(what);
  };
  scene.bodies.forEach((b, i) => {
    within(`bodies[${i}].joint`, b.joint, scene.joints.length, -1);
  });
  scene.shapes.forEach((s, i) => {
    within(`shapes[${i}].body`, s.body, bodies, -1);
    if (s.geometry.kind !== "mesh") return;
    const corners = s.geometry.positions.length / 3;
    for (const corner of s.geometry.triangles) within(`shapes[${i}].geometry.triangles`, corner, corners);
  });
  scene.joints.forEach((j, i) => {
    within(`joints[${i}].parent`, j.parent, bodies, -1);
    within(`joints[${i}].child`, j.child, bodies, -1);
  });
  scene.cameras.forEach((c, i) => {
    within(`cameras[${i}].body`, c.body, bodies, -1);
  });
  for (const row of scene.plots) within("plots", row, scene.quantities.length);
  for (const world of scene.shown) within("shown", world, scene.worlds);
}
