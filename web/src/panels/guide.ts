import type { Scene } from "../protocol";
import type { Session } from "../session";
import { h } from "../ui/dom";
import { short } from "../ui/format";

/** What the scene is, and what to try. */
export class Guide {
  readonly element = h("div", { class: "guide" });
  private readonly runsOn = h("dd");
  private readonly timeStep = h("dd");

  constructor(session: Session) {
    session.on("scene", (scene) => this.show(scene));
    // It may be another than the scene came with.
    session.on("physics", (fields) => {
      const field = fields.find(({ name }) => name === "time_step");
      if (field) this.showTimeStep(field.value);
    });
    session.on("status", ({ card }) => {
      this.runsOn.textContent = card ?? `processor (${session.scene?.isa})`;
    });
  }

  private showTimeStep(seconds: number): void {
    this.timeStep.textContent = `${short(1000 * seconds)} ms`;
  }

  private show(scene: Scene): void {
    this.showTimeStep(scene.time_step);
    const facts: [string, string | HTMLElement][] = [
      ["Solver", scene.solver],
      ["Runs on", this.runsOn],
      ["Time step", this.timeStep],
      ["Replicas", String(scene.worlds)],
      ["Bodies", String(scene.bodies.length)],
    ];
    this.element.replaceChildren(
      h("h2", {}, scene.title),
      h("p", {}, scene.guide),
      h(
        "dl",
        { class: "facts" },
        ...facts.flatMap(([name, value]) => [
          h("dt", {}, name),
          typeof value === "string" ? h("dd", {}, value) : value,
        ]),
      ),
    );
  }
}
