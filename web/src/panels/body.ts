import { Vector3 } from "three";
import { type Frame, POSE } from "../frame";
import type { Navigation } from "../navigation";
import type { Body, Scene } from "../protocol";
import type { Pushing } from "../pushing";
import type { Selection } from "../selection";
import type { Session } from "../session";
import { button, h, Select } from "../ui/dom";
import { fixed, list, short } from "../ui/format";
import { NumberControl } from "../ui/number_control";
import type { Scale } from "../ui/scale";
import type { Mount } from "../view/camera_rig";
import type { View } from "../view/view";

/** Time between two readings of the state [s]. */
const READ = 0.1;

/** What is told of a body. */
const FACTS = ["Mass", "Inertia", "Centre", "Joint", "Position", "Orientation", "Velocity"] as const;
type Fact = (typeof FACTS)[number];
const NOTHING = "–";

/** The picked body: what it is, how it moves, what can be done with it. */
export class BodyPanel {
  /** Stays as it is, and keeps its height and the focus, whichever body is picked. */
  readonly element: HTMLElement;
  private readonly chooser: Select<number>;
  private readonly replica = h("span", { class: "muted" });
  private readonly facts = new Map(FACTS.map((name) => [name, h("dd", {}, NOTHING)]));
  private readonly mounts: Map<Mount, HTMLButtonElement>;
  private readonly impulse: NumberControl;
  private readonly push: HTMLButtonElement;
  private before: { time: number; position: Vector3 } | null = null;
  private velocity = new Vector3();
  private readAt = 0;

  constructor(
    private readonly session: Session,
    private readonly selection: Selection,
    private readonly pushing: Pushing,
    private readonly navigation: Navigation,
    view: View,
  ) {
    const click = "The body that is picked: click one in the picture, or choose it here. (J and K)";
    this.chooser = new Select("Body", click, [], (body) => {
      const world = selection.now?.world ?? session.shown[0] ?? 0;
      selection.now = body < 0 ? null : { world, body };
    });
    const mount = (mount: Mount, label: string, help: string): [Mount, HTMLButtonElement] => [
      mount,
      button(label, help, () => navigation.mount(mount)),
    ];
    this.mounts = new Map([
      mount("follow", "Follow", "The camera keeps it in the middle. (C)"),
      mount("ride", "First person", "Sees with its eyes. (V)"),
      mount("free", "Let go", "The camera stands still again. (X)"),
    ]);
    const help = "The impulse of a push: along the view, on the body picked. (U)";
    this.impulse = new NumberControl({ label: "Push", unit: "N·s", help, scale: impulses(1) }, false, {
      input: (value) => {
        pushing.impulse = value;
      },
    });
    this.push = button("Push", help, () => pushing.pushPicked());
    this.element = h(
      "div",
      { class: "body-panel" },
      h("h3", {}, this.chooser.element, this.replica),
      h("dl", { class: "facts" }, ...[...this.facts].flatMap(([name, fact]) => [h("dt", {}, name), fact])),
      h("div", { class: "bar" }, ...this.mounts.values()),
      h("div", { class: "form" }, this.impulse.element, this.push),
    );
    selection.on("change", () => this.show());
    session.on("scene", (scene) => {
      this.list(scene);
      this.show();
    });
    session.on("shown", () => this.show());
    session.on("frame", (frame) => this.read(frame));
    view.on("carried", () => this.showMounts());
    this.show();
  }

  private list({ bodies }: Scene): void {
    const options = bodies.map((body, row): [number, string] => [row, body.name || `body ${row}`]);
    this.chooser.setOptions([[-1, "None: click one"], ...options]);
  }

  private show(): void {
    const selected = this.selection.now;
    const scene = this.session.scene;
    const body = selected && scene?.bodies[selected.body];
    this.before = null;
    this.velocity.set(0, 0, 0);
    this.readAt = 0;
    this.chooser.value = body ? selected.body : -1;
    this.replica.textContent = selected ? `replica ${selected.world}` : "";
    for (const name of FACTS) this.write(name, NOTHING);
    if (scene && body) this.showBody(scene, body);
    const { usual, impulse } = this.pushing;
    this.impulse.scale = impulses(usual);
    this.impulse.value = impulse;
    this.impulse.disabled = this.push.disabled = !body?.dynamic;
    this.showMounts();
    if (this.session.frame) this.read(this.session.frame);
  }

  private showBody(scene: Scene, body: Body): void {
    const joint = scene.joints[body.joint];
    this.write("Mass", body.dynamic ? `${short(body.mass)} kg` : "does not move");
    this.write("Inertia", `${list(body.inertia)} kg·m²`);
    // Rounded, since files leave what is no more than rounding.
    this.write("Centre", `${list(body.inertial.position.map((x) => Number(x.toFixed(6))))} m`);
    if (joint) this.write("Joint", `${joint.name} (${joint.kind})`);
  }

  /** Says how the picked body carries the camera. */
  private showMounts(): void {
    const { mounted } = this.navigation;
    for (const [mount, button] of this.mounts) {
      button.disabled = !this.selection.now;
      if (mount !== "free") button.setAttribute("aria-pressed", String(mount === mounted));
    }
  }

  private read(frame: Frame): void {
    const selected = this.selection.now;
    if (!selected) return;
    if (performance.now() / 1000 - this.readAt < READ && frame.running) return;
    this.readAt = performance.now() / 1000;
    const row = this.session.shown.indexOf(selected.world);
    if (row < 0) {
      for (const name of ["Position", "Orientation", "Velocity"] as const) this.write(name, "not shown");
      return;
    }
    const at = POSE * (row * frame.bodies + selected.body);
    if (at >= frame.poses.length) return;
    const position = new Vector3().fromArray(frame.poses, at);
    if (this.before && frame.time < this.before.time) this.velocity.set(0, 0, 0);
    if (this.before && frame.time > this.before.time) {
      this.velocity = position
        .clone()
        .sub(this.before.position)
        .divideScalar(frame.time - this.before.time);
    }
    this.before = { time: frame.time, position };
    this.write("Position", `${fixed(position, 3)} m`);
    this.write("Orientation", fixed(frame.poses.subarray(at + 3, at + POSE), 3));
    this.write("Velocity", `${fixed(this.velocity, 3)} m/s`);
  }

  private write(name: Fact, text: string): void {
    const fact = this.facts.get(name);
    if (fact) fact.textContent = text;
  }
}

/** A slider of impulses to ten times the usual one [N·s]. */
function impulses(usual: number): Scale {
  return { min: 0, max: 10 * usual, integer: false, logarithmic: true };
}
