import type { Controls } from "../controls";
import type { Frame } from "../frame";
import type { Command, Dof, Joint, Scene, Slider } from "../protocol";
import type { Session } from "../session";
import { Checkbox, h } from "../ui/dom";
import { fixed } from "../ui/format";
import { NumberControl } from "../ui/number_control";
import { ranged, shownIn } from "../ui/units";

/** A slider in the engine's unit. */
interface SliderControl {
  element: HTMLElement;
  value: number;
}

/** A degree of freedom that can be driven, and where it is in frames; −1 where frames do not tell it. */
interface Driven {
  joint: Joint;
  dof: Dof;
  coordinate: number;
}

/** Sliders of actuators, and of what drives degrees of freedom. They stay while the joints do. */
export class Drives {
  readonly element: HTMLElement;
  private readonly list = h("div", { class: "drives" });
  /** Stays when the list is made anew, and keeps the focus. */
  private readonly more: Checkbox;
  private readonly none = h("p", { class: "muted" }, "Nothing here can be driven.");
  private readouts: [output: HTMLElement, driven: Driven][] = [];
  /** Controls, and what of a scene they show. */
  private shown: [control: SliderControl, read: (scene: Scene) => number][] = [];
  private structure = "";
  private all = false;

  constructor(
    private readonly session: Session,
    private readonly controls: Controls,
  ) {
    this.more = new Checkbox("All joints", "Sliders for every degree of freedom.", (on) => {
      this.all = on;
      if (!session.scene) return;
      this.make(session.scene);
      this.set(session.scene);
    });
    this.element = h("div", {}, this.list, this.more.element, this.none);
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
    this.list.replaceChildren(
      ...scene.actuators.map((_, row) => this.actuator(scene, row)),
      ...wanted.map((each) => this.dof(each)),
    );
    this.list.hidden = scene.actuators.length + wanted.length === 0;
    this.more.on = this.all;
    this.more.element.hidden = driven.every(({ dof }) => dof.sliders);
    this.none.hidden = driven.length + scene.actuators.length > 0;
    // The next frame may be long in coming.
    if (this.session.frame) this.read(this.session.frame);
  }

  private actuator(scene: Scene, actuator: number): HTMLElement {
    const control = this.control(scene.actuators[actuator].slider, (value) =>
      this.controls.soon(`control ${actuator}`, { type: "control", actuator, value }),
    );
    this.shown.push([control, ({ actuators }) => actuators[actuator].value]);
    return h("div", { class: "drive" }, control.element);
  }

  private dof(driven: Driven): HTMLElement {
    const { joint, dof } = driven;
    const readout = h("span", { "data-help": "The coordinate now, in the first replica shown." });
    if (driven.coordinate >= 0) this.readouts.push([readout, driven]);
    const sliders = dof.drive.map((slider) => {
      const drive = slider.name;
      const control = this.control(slider, (value) => {
        const command: Command = { type: "joint", dof: dof.dof, [drive]: value };
        this.controls.soon(`${drive} ${dof.dof}`, command);
      });
      this.shown.push([control, (scene) => findDof(scene, dof.dof)?.[drive] ?? 0]);
      return control.element;
    });
    return h(
      "details",
      { class: "drive" },
      h("summary", {}, h("span", {}, dof.name || joint.name), readout),
      h("div", { class: "form" }, ...sliders),
    );
  }

  /** A slider that tells and takes values in the engine's unit. */
  private control(slider: Slider, input: (value: number) => void): SliderControl {
    const { unit, factor } = shownIn(slider.unit);
    const { label, logarithmic, strict } = slider;
    const [min, max] = [slider.min / factor, slider.max / factor];
    const help = `${slider.help} ${ranged([min, max], unit, strict)}`;
    const scale = { min, max, integer: false, logarithmic };
    const control = new NumberControl({ label, unit, help, scale }, strict, {
      input: (shown) => input(shown * factor),
    });
    return {
      element: control.element,
      set value(value: number) {
        control.value = value / factor;
      },
    };
  }

  private read({ coordinates }: Frame): void {
    for (const [output, { dof, coordinate }] of this.readouts) {
      const { unit, factor } = shownIn(dof.angular ? "rad" : "m");
      const value = coordinates[coordinate] / factor;
      output.textContent = dof.angular ? `${fixed([value], 1)}${unit}` : `${fixed([value], 3)} ${unit}`;
    }
  }
}

/** Free joints have no drives, nor have those that close loops. */
function drivenDofs(scene: Scene): Driven[] {
  return scene.joints.flatMap((joint) => {
    // A ball's four coordinates are none of its three angles.
    const told = joint.coordinates === joint.dofs.length;
    const all = joint.dofs.map((dof, row) => ({
      joint,
      dof,
      coordinate: told ? joint.coordinate + row : -1,
    }));
    return all.filter(({ dof }) => dof.drive.length > 0);
  });
}

function findDof(scene: Scene, dof: number): Dof | undefined {
  return scene.joints.flatMap(({ dofs }) => dofs).find((each) => each.dof === dof);
}

/** What of a scene's joints and actuators is not a value that sliders set. */
function structureOf(scene: Scene): string {
  const { name, joints, actuators } = scene;
  // Ranges of gains follow from their values.
  const dofs = joints.map((joint) =>
    joint.dofs.map(({ name, dof, limit, sliders, drive }) => [name, dof, limit, sliders, drive.length]),
  );
  return JSON.stringify([name, dofs, actuators.map((actuator) => actuator.slider)]);
}
