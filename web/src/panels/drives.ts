import type { Controls } from "../controls";
import type { Frame } from "../frame";
import type { Command, Dof, Joint, Scene } from "../protocol";
import type { Session } from "../session";
import { Checkbox, h } from "../ui/dom";
import { fixed } from "../ui/format";
import { NumberControl } from "../ui/number_control";

const DEGREE = Math.PI / 180;
type Drive = "position" | "stiffness" | "velocity" | "damping";

/** A degree of freedom that can be driven, and where it is in frames; −1 where frames do not tell it. */
interface Driven {
  joint: Joint;
  dof: Dof;
  coordinate: number;
}

/** Sliders of actuators, and of what drives degrees of freedom. They stay while the joints do. */
export class Drives {
  readonly element = h("div", { class: "drives" });
  private readouts: [output: HTMLElement, driven: Driven][] = [];
  /** Controls, and what of a scene they show. */
  private shown: [control: NumberControl, read: (scene: Scene) => number][] = [];
  private structure = "";
  private all = false;

  constructor(
    private readonly session: Session,
    private readonly controls: Controls,
  ) {
    session.on("scene", (scene) => this.show(scene));
    session.on("changed", () => this.set(session.scene));
    session.on("frame", (frame) => this.read(frame));
  }

  private show(scene: Scene): void {
    const structure = structureOf(scene);
    if (structure !== this.structure) {
      this.structure = structure;
      this.all = false;
      this.make(scene);
    }
    this.set(scene);
  }

  /** Sliders say what the scene does. */
  private set(scene: Scene | null): void {
    if (!scene) return;
    for (const [control, read] of this.shown) control.value = read(scene);
  }

  private make(scene: Scene): void {
    this.readouts = [];
    this.shown = [];
    const driven = drivenDofs(scene);
    const wanted = driven.filter(({ dof }) => this.all || dof.sliders);
    const more = new Checkbox("All joints", "Sliders for every degree of freedom.", (on) => {
      this.all = on;
      this.make(scene);
      this.show(scene);
    });
    more.on = this.all;
    const some = driven.some(({ dof }) => !dof.sliders);
    const none = driven.length + scene.actuators.length === 0;
    this.element.replaceChildren(
      ...scene.actuators.map((_, row) => this.actuator(scene, row)),
      ...wanted.map((each) => this.dof(each, hasGains(scene))),
      ...(some ? [more.element] : []),
      ...(none ? [h("p", { class: "muted" }, "Nothing here can be driven.")] : []),
    );
    // The next frame may be long in coming.
    if (this.session.frame) this.read(this.session.frame);
  }

  private actuator(scene: Scene, actuator: number): HTMLElement {
    const { name, range } = scene.actuators[actuator];
    const scale = { min: range[0], max: range[1], integer: false, logarithmic: false };
    const spec = { label: name, unit: "", help: `Control of the actuator ${name}.`, scale };
    const control = new NumberControl(spec, true, {
      input: (value) => this.controls.soon(`control ${actuator}`, { type: "control", actuator, value }),
    });
    this.shown.push([control, ({ actuators }) => actuators[actuator].value]);
    return h("div", { class: "drive" }, control.element);
  }

  private dof(driven: Driven, gains: boolean): HTMLElement {
    const { joint, dof } = driven;
    const readout = h("span", { "data-help": "The coordinate now, in the first replica shown." });
    if (driven.coordinate >= 0) this.readouts.push([readout, driven]);
    const [unit, force, per] = dof.angular ? ["°", "N·m", "rad"] : ["m", "N", "m"];
    const range = dof.limit ?? (dof.angular ? [-Math.PI, Math.PI] : [-1, 1]);
    const fastest = dof.angular ? 10 : 2;
    const [strong, damped] = [Math.max(100, 10 * dof.stiffness), Math.max(10, 10 * dof.damping)];
    const slider = (drive: Drive, label: string, unit: string, help: string, range: number[]) =>
      this.slider(dof, drive, label, unit, help, range);
    const target = slider("position", "Target", unit, "Where the drive takes the joint.", range);
    const speed = slider("velocity", "Speed", `${unit}/s`, "How fast the drive moves the joint.", [
      -fastest,
      fastest,
    ]);
    const stiffness = () =>
      slider("stiffness", "Stiffness", `${force}/${per}`, "How hard the drive holds the target.", [
        0,
        strong,
      ]);
    const damping = () =>
      slider("damping", "Damping", `${force}·s/${per}`, "How hard the drive holds the speed.", [0, damped]);
    const sliders = gains ? [target, stiffness(), speed, damping()] : [target, speed];
    return h(
      "details",
      { class: "drive" },
      h("summary", {}, h("span", {}, dof.name || joint.name), readout),
      h("div", { class: "form" }, ...sliders),
    );
  }

  private slider(
    dof: Dof,
    drive: Drive,
    label: string,
    unit: string,
    help: string,
    range: number[],
  ): HTMLElement {
    const turns = dof.angular && (drive === "position" || drive === "velocity");
    const factor = turns ? DEGREE : 1;
    const logarithmic = drive === "stiffness" || drive === "damping";
    const scale = { min: range[0] / factor, max: range[1] / factor, integer: false, logarithmic };
    const control = new NumberControl({ label, unit, help, scale }, false, {
      input: (shown) => {
        const command: Command = { type: "joint", dof: dof.dof, [drive]: shown * factor };
        this.controls.soon(`${drive} ${dof.dof}`, command);
      },
    });
    this.shown.push([control, (scene) => (findDof(scene, dof.dof)?.[drive] ?? 0) / factor]);
    return control.element;
  }

  private read({ coordinates }: Frame): void {
    for (const [output, { dof, coordinate }] of this.readouts) {
      const value = coordinates[coordinate];
      output.textContent = dof.angular ? `${fixed([value / DEGREE], 1)}°` : `${fixed([value], 3)} m`;
    }
  }
}

/** Free joints have no drives, nor have those that close loops. */
function drivenDofs(scene: Scene): Driven[] {
  return scene.joints.flatMap((joint) => {
    if (joint.kind === "free" || joint.coordinate < 0) return [];
    // A ball's four coordinates are none of its three angles.
    const told = joint.coordinates === joint.dofs.length;
    return joint.dofs.map((dof, row) => ({ joint, dof, coordinate: told ? joint.coordinate + row : -1 }));
  });
}

function findDof(scene: Scene, dof: number): Dof | undefined {
  return scene.joints.flatMap(({ dofs }) => dofs).find((each) => each.dof === dof);
}

/** Whether stiffness and damping can be set: they are not where a program owns the simulation. */
function hasGains({ physics }: Scene): boolean {
  return physics.length > 0;
}

/** What of a scene's joints and actuators is not a value that sliders set. */
function structureOf(scene: Scene): string {
  const { name, joints, actuators } = scene;
  const dofs = joints.map((joint) => joint.dofs.map((dof) => [dof.name, dof.dof, dof.limit, dof.sliders]));
  return JSON.stringify([
    name,
    hasGains(scene),
    dofs,
    actuators.map((actuator) => [actuator.name, actuator.range]),
  ]);
}
