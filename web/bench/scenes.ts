/** Scenes made up for measuring the page without an engine: what is drawn is real, what moves it is not. */

import type { Body, Dof, Geometry, Joint, Scene, Shape } from "../src/protocol";
import type { Quadruple, Triple } from "../src/schema";
import { type Contents, writeFrame } from "../tests/frames";

/** A scene, and its frame at a time. */
export interface Synthetic {
  scene: Scene;
  frame(time: number, number: number): ArrayBuffer;
}

const HERE: Quadruple = [0, 0, 0, 1];
const COLORS: Quadruple[] = [
  [0.3, 0.55, 0.82, 1],
  [0.89, 0.55, 0.29, 1],
  [0.36, 0.67, 0.5, 1],
  [0.8, 0.42, 0.48, 1],
];

function emptyScene(name: string, id: number): Scene {
  return {
    type: "scene",
    id,
    name,
    title: name,
    guide: "Made up to measure the page.",
    up: "y",
    time_step: 0.002,
    worlds: 1,
    solver: "none",
    isa: "none",
    build: [],
    physics: [],
    bodies: [],
    shapes: [shape(-1, { kind: "plane", half: null }, [0, 0, 0])],
    joints: [],
    actuators: [],
    cameras: [],
    lamps: [],
    sun: -1,
    quantities: [
      { label: "Sine", unit: "m", group: "body" },
      { label: "Cosine", unit: "m", group: "body" },
    ],
    unlisted: null,
    plots: [0, 1],
    shown: [0],
    spacing: 2,
    bounds: [
      [-1, 0, -1],
      [1, 2, 1],
    ],
  };
}

function shape(body: number, geometry: Geometry, position: Triple): Shape {
  const placement = { position, orientation: HERE };
  return { name: "", body, placement, geometry, collides: true, sensor: false, color: null };
}

function body(name: string, color: Quadruple, joint = -1): Body {
  const inertial = { position: [0, 0, 0] as Triple, orientation: HERE };
  return { name, dynamic: true, mass: 1, inertial, inertia: [0.1, 0.1, 0.1], joint, color };
}

function write(scene: Scene, time: number, number: number, contents: Contents): ArrayBuffer {
  const still = { scene: scene.id, worlds: scene.shown.length, bodies: scene.bodies.length };
  const quantities = [Math.sin(time), Math.cos(time)];
  return writeFrame({ ...still, number, time, steps: 500 * time, running: true, quantities, ...contents });
}

/** Where parts of a figure are, from the ground up [m], and what they are. */
const FIGURE: [name: string, at: Triple, geometry: Geometry][] = [
  ["torso", [0, 1.3, 0], { kind: "capsule", radius: 0.13, half_height: 0.24 }],
  ["head", [0, 1.66, 0], { kind: "sphere", radius: 0.11 }],
  ["waist", [0, 1.02, 0], { kind: "ellipsoid", half: [0.14, 0.1, 0.11] }],
];
for (const side of [-1, 1]) {
  FIGURE.push(
    ["thigh", [0.1 * side, 0.76, 0], { kind: "capsule", radius: 0.065, half_height: 0.21 }],
    ["shin", [0.1 * side, 0.36, 0], { kind: "capsule", radius: 0.05, half_height: 0.2 }],
    ["foot", [0.1 * side, 0.08, 0.06], { kind: "box", half: [0.05, 0.04, 0.12] }],
    ["upper arm", [0.24 * side, 1.36, 0], { kind: "capsule", radius: 0.045, half_height: 0.16 }],
    ["forearm", [0.3 * side, 1.08, 0], { kind: "capsule", radius: 0.04, half_height: 0.15 }],
    ["hand", [0.33 * side, 0.9, 0], { kind: "sphere", radius: 0.045 }],
  );
}

const SLIDERS: Dof["drive"] = (["position", "stiffness", "velocity", "damping"] as const).map((name) => ({
  name,
  label: name,
  unit: "",
  help: "",
  min: 0,
  max: 100,
  logarithmic: false,
  strict: false,
}));

/** Figures of fifteen bodies that sway, in so many worlds. */
export function humanoids(worlds: number): Synthetic {
  const scene = emptyScene("humanoids", 1);
  scene.worlds = worlds;
  scene.shown = Array.from({ length: worlds }, (_, world) => world);
  scene.spacing = 1.6;
  scene.bounds = [
    [-0.5, 0, -0.3],
    [0.5, 1.8, 0.3],
  ];
  scene.bodies = FIGURE.map(([name], row) => body(name, COLORS[row % COLORS.length], row));
  scene.shapes.push(...FIGURE.map(([, , geometry], row) => shape(row, geometry, [0, 0, 0])));
  scene.joints = FIGURE.map(([name], row): Joint => {
    const frame = { position: [0, 0, 0] as Triple, orientation: HERE };
    const drive = { position: 0, stiffness: 100, velocity: 0, damping: 5, sliders: row < 5, drive: SLIDERS };
    return {
      name,
      kind: "revolute",
      parent: -1,
      child: row,
      parent_frame: { position: FIGURE[row][1], orientation: HERE },
      child_frame: frame,
      dofs: [
        { name, dof: row, angular: true, axis: [0, 0, 1], point: [0, 0, 0], limit: [-0.6, 1.2], ...drive },
      ],
      coordinate: row,
      coordinates: 1,
    };
  });
  scene.cameras = [
    {
      name: "eye",
      body: 1,
      mode: "fixed",
      placement: { position: [0, 0, 0.2], orientation: [0, 1, 0, 0] },
      field_of_view: 1,
    },
  ];
  return {
    scene,
    frame(time, number) {
      const poses: number[] = [];
      const contacts: number[] = [];
      for (let world = 0; world < worlds; world++) {
        const lean = 0.25 * Math.sin(1.7 * time + world);
        const turn = [0, 0, Math.sin(lean / 2), Math.cos(lean / 2)];
        for (const [, [x, y, z]] of FIGURE) {
          poses.push(
            x * Math.cos(lean) - y * Math.sin(lean),
            x * Math.sin(lean) + y * Math.cos(lean),
            z,
            ...turn,
          );
        }
        for (const x of [-0.1, 0.1]) contacts.push(world, x, 0, 0.1, 20 * lean, 90, 0, -0.001, 0, 6);
      }
      return write(scene, time, number, { poses, contacts, coordinates: FIGURE.map(() => Math.sin(time)) });
    },
  };
}

/** So many particles that slosh in a box. */
export function particles(count: number): Synthetic {
  const scene = emptyScene("particles", 2);
  scene.bodies = [body("box", [0.7, 0.72, 0.75, 0.2])];
  scene.shapes.push(shape(0, { kind: "box", half: [1, 0.6, 0.6] }, [0, 0, 0]));
  scene.bounds = [
    [-1, 0, -0.6],
    [1, 1.2, 0.6],
  ];
  const rest = Float32Array.from({ length: 3 * count }, (_, i) => {
    const share = (0.5 + i * [0.8191725, 0.6710436, 0.5497005][i % 3]) % 1;
    return [1.96, 0.7, 1.16][i % 3] * (share - 0.5) + [0, 0.37, 0][i % 3];
  });
  return {
    scene,
    frame(time, number) {
      const moved = new Float32Array(rest);
      for (let i = 0; i < moved.length; i += 3) {
        moved[i + 1] *= 1 + 0.35 * Math.sin(2 * time + 2.5 * moved[i]);
      }
      return write(scene, time, number, { poses: [0, 0.6, 0, ...HERE], particles: moved });
    },
  };
}

/** One of every form of shape. */
export function zoo(): Synthetic {
  const scene = emptyScene("zoo", 3);
  const forms: Geometry[] = [
    { kind: "sphere", radius: 0.3 },
    { kind: "capsule", radius: 0.15, half_height: 0.35 },
    { kind: "cylinder", radius: 0.2, half_height: 0.3 },
    { kind: "cone", radius: 0.25, half_height: 0.3 },
    { kind: "box", half: [0.3, 0.2, 0.25] },
    { kind: "ellipsoid", half: [0.15, 0.3, 0.2] },
    {
      kind: "mesh",
      positions: [1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1].map((x) => 0.3 * x),
      triangles: [0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5],
      flat: true,
    },
    { kind: "plane", half: [0.3, 0.3] },
  ];
  scene.bodies = forms.map(({ kind }, row) => body(kind, COLORS[row % COLORS.length]));
  scene.shapes.push(...forms.map((geometry, row) => shape(row, geometry, [0, 0, 0])));
  scene.bounds = [
    [-1.6, 0, -0.8],
    [1.6, 0.8, 0.8],
  ];
  return {
    scene,
    frame(time, number) {
      const poses = forms.flatMap((_, row) => {
        const [half, x, z] = [0.3 * time, (row % 4) - 1.5, row < 4 ? -0.5 : 0.5];
        return [x, 0.45, z, 0, Math.sin(half), 0, Math.cos(half)];
      });
      const contacts = forms.flatMap((_, row) => [
        0,
        (row % 4) - 1.5,
        0,
        row < 4 ? -0.5 : 0.5,
        0,
        10,
        0,
        0,
        0,
        row + 1,
      ]);
      return write(scene, time, number, { poses, contacts });
    },
  };
}
