import type { Controls } from "../controls";
import type { Frame } from "../frame";
import type { Actuator, Command, Dof, Joint, Scene } from "../protocol";
import type { Session } from "../session";
import { Checkbox, h } from "../ui/dom";
import { short } from "../ui/format";
import { NumberControl } from "../ui/number_control";

const DEGREE = Math.PI / 180;
type Drive = "position" | "stiffness" | "velocity" | "damping";

/** Sliders of actuators, and of what drives degrees of freedom. */
export class Drives {
  readonly element = h("div", { class: "drives" });
  /** What shows the coordinate of a dof, and how it is read from a frame. */
  private readouts: [output: HTMLOutputElement, coordinate: number, dof: Dof][] = [];
  private all = false;

  constructor(
    private readonly session: Session,
    private readonly controls: Controls,
  ) {
    session.on("scene", (scene) => {
      this.all = false;
      this.show(scene);
    });
    session.on("frame", (frame) => this.read(frame));
  }

  private show(scene: Scene): void {
    this.readouts = [];
    // Free joints have no drives, nor have those that close loops.
    const driven = scene.joints.filter(({ kind, coordinate }) => kind !== "free" && coordinate >= 0);
    const dofs = driven.flatMap((joint) => joint.dofs.map((dof, row) => ({ joint, dof, row })));
    const wanted = dofs.filter(({ dof }) => this.all || dof.sliders);
    const more = new Checkbox("All joints", "Sliders for every degree of freedom.", (on) => {
      this.all = on;
      this.show(scene);
    });
    more.on = this.all;
    this.element.replaceChildren(
      ...scene.actuators.map((actuator, row) => this.actuator(actuator, row)),
      ...wanted.map(({ joint, dof, row }) => this.dof(joint, dof, row)),
      ...(dofs.length > dofs.filter(({ dof }) => dof.sliders).length ? [more.element] : []),
      ...(dofs.length + scene.actuators.length
        ? []
        : [h("p", { class: "muted" }, "Nothing here is jointed.")]),
    );
    if (this.session.frame) this.read(this.session.frame);
  }

  private actuator({ name, range, value }: Actuator, actuator: number): HTMLElement {
    const scale = { min: range[0], max: range[1], integer: false, logarithmic: false };
    const spec = { label: name, unit: "", help: `Control of the actuator ${name}.`, scale };
    const control = new NumberControl(spec, false, {
      input: (value) => this.controls.soon(`control ${actuator}`, { type: "control", actuator, value }),
    });
    control.value = value;
    return h("div", { class: "drive" }, control.element);
  }

  private dof(joint: Joint, dof: Dof, row: number): HTMLElement {
    const unit = dof.angular ? "°" : "m";
    const force = dof.angular ? "N·m" : "N";
    const per = dof.angular ? "rad" : "m";
    const [low, high] = dof.limit ?? (dof.angular ? [-Math.PI, Math.PI] : [-1, 1]);
    const readout = h("output", { "data-help": "The coordinate now, in the first replica shown." });
    if (joint.coordinate >= 0 && joint.coordinates === joint.dofs.length) {
      this.readouts.push([readout, joint.coordinate + row, dof]);
    }
    const [strong, damped] = [Math.max(100, 10 * dof.stiffness), Math.max(10, 10 * dof.damping)];
    return h(
      "details",
      { class: "drive", "data-dof": dof.dof },
      h("summary", {}, h("span", {}, dof.name || joint.name), readout),
      h(
        "div",
        { class: "form" },
        this.slider(dof, "position", "Target", unit, "Where the drive takes the joint.", [low, high]),
        this.slider(
          dof,
          "stiffness",
          "Stiffness",
          `${force}/${per}`,
          "How hard the drive holds the target.",
          [0, strong],
        ),
        this.slider(
          dof,
          "velocity",
          "Speed",
          `${unit}/s`,
          "How fast the drive moves the joint.",
          dof.angular ? [-10, 10] : [-2, 2],
        ),
        this.slider(dof, "damping", "Damping", `${force}·s/${per}`, "How hard the drive holds the speed.", [
          0,
          damped,
        ]),
      ),
    );
  }

  private slider(
    dof: Dof,
    drive: Drive,
    label: string,
    unit: string,
    help: string,
    [low, high]: number[],
  ): HTMLElement {
    const turns = dof.angular && (drive === "position" || drive === "velocity");
    const factor = turns ? DEGREE : 1;
    const logarithmic = drive === "stiffness" || drive === "damping";
    const scale = { min: low / factor, max: high / factor, integer: false, logarithmic };
    const control = new NumberControl({ label, unit, help, scale }, false, {
      input: (shown) => {
        const value = shown * factor;
        dof[drive] = value;
        const command: Command = { type: "joint", dof: dof.dof, [drive]: value };
        this.controls.soon(`${drive} ${dof.dof}`, command);
      },
    });
    control.value = dof[drive] / factor;
    return control.element;
  }

  private read({ coordinates }: Frame): void {
    for (const [output, row, dof] of this.readouts) {
      const value = coordinates[row];
      output.textContent = dof.angular ? `${(value / DEGREE).toFixed(1)}°` : `${short(value, 3)} m`;
    }
  }
}
