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

/** Time between two readings of the state [s]. */
const READ = 0.1;

/** The picked body: what it is, how it moves, what can be done with it. */
export class BodyPanel {
  readonly element = h("div", { class: "body-panel" });
  private readonly state = new Map<string, HTMLElement>();
  private before: { time: number; position: Vector3 } | null = null;
  private velocity = new Vector3();
  private readAt = 0;

  constructor(
    private readonly session: Session,
    private readonly selection: Selection,
    private readonly pushing: Pushing,
    private readonly navigation: Navigation,
  ) {
    selection.on("change", () => this.show());
    session.on("scene", () => this.show());
    session.on("shown", () => this.show());
    session.on("frame", (frame) => this.read(frame));
    this.show();
  }

  private show(): void {
    const selected = this.selection.now;
    const scene = this.session.scene;
    const body = selected && scene?.bodies[selected.body];
    this.state.clear();
    this.before = null;
    this.velocity.set(0, 0, 0);
    this.readAt = 0;
    if (!selected || !scene || !body) {
      this.element.replaceChildren(
        h("p", { class: "muted" }, "Click a body to see what it is. J and K go from one to the next."),
      );
      return;
    }
    this.element.replaceChildren(
      h(
        "h3",
        {},
        this.chooser(scene, selected.body),
        h("span", { class: "muted" }, `replica ${selected.world}`),
      ),
      h("dl", { class: "facts" }, ...this.facts(scene, body), ...this.readouts()),
      h(
        "div",
        { class: "bar" },
        button("Follow", "The camera keeps it in the middle. (C)", () => this.navigation.mount("follow")),
        button("First person", "Sees with its eyes. (V)", () => this.navigation.mount("ride")),
        button("Let go", "The camera stands still again. (X)", () => this.navigation.mount("free")),
      ),
      ...(body.dynamic ? [this.pusher()] : []),
    );
    if (this.session.frame) this.read(this.session.frame);
  }

  private chooser(scene: Scene, selected: number): HTMLElement {
    const options = scene.bodies.map((body, row): [number, string] => [row, body.name || `body ${row}`]);
    const select = new Select("Body", "The body that is picked.", options, (body) => {
      this.selection.now = { world: this.selection.now?.world ?? 0, body };
    });
    select.value = selected;
    return select.element;
  }

  private facts(scene: Scene, body: Body): HTMLElement[] {
    const joint = scene.joints[body.joint];
    const facts: [string, string][] = [
      ["Mass", body.dynamic ? `${short(body.mass)} kg` : "does not move"],
      ["Inertia", `${list(body.inertia)} kg·m²`],
      // Rounded, since files leave what is no more than rounding.
      ["Centre", `${list(body.inertial.position.map((x) => Number(x.toFixed(6))))} m`],
    ];
    if (joint) facts.push(["Joint", `${joint.name} (${joint.kind})`]);
    return facts.flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]);
  }

  private readouts(): HTMLElement[] {
    return ["Position", "Orientation", "Velocity"].flatMap((name) => {
      const value = h("dd", { class: "state" });
      this.state.set(name, value);
      return [h("dt", {}, name), value];
    });
  }

  private pusher(): HTMLElement {
    const scale = { min: 0, max: 10 * this.pushing.usual, integer: false, logarithmic: true };
    const help = "The impulse of a push: along the view, on the body picked. (U)";
    const control = new NumberControl({ label: "Push", unit: "N·s", help, scale }, false, {
      input: (value) => {
        this.pushing.impulse = value;
      },
    });
    control.value = this.pushing.impulse;
    return h(
      "div",
      { class: "form" },
      control.element,
      button("Push", help, () => this.pushing.pushPicked()),
    );
  }

  private read(frame: Frame): void {
    const selected = this.selection.now;
    if (!selected || this.state.size === 0) return;
    if (performance.now() / 1000 - this.readAt < READ && frame.running) return;
    this.readAt = performance.now() / 1000;
    const row = this.session.shown.indexOf(selected.world);
    if (row < 0) {
      for (const name of this.state.keys()) this.write(name, "not shown");
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

  private write(name: string, text: string): void {
    const element = this.state.get(name);
    if (element) element.textContent = text;
  }
}
