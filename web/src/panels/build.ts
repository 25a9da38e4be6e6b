import type { Controls } from "../controls";
import type { Values } from "../protocol";
import type { Session } from "../session";
import { h } from "../ui/dom";
import { FieldForm } from "../ui/field_form";
import { icon } from "../ui/icons";

/** Build parameters of the example, taken up when it is rebuilt. */
export class Build {
  readonly element: HTMLElement;
  private readonly form = new FieldForm((name, value) => this.stage(name, value));
  private readonly apply: HTMLButtonElement;
  private staged: Values = {};

  constructor(
    private readonly session: Session,
    private readonly controls: Controls,
  ) {
    this.apply = h("button", { type: "button", onclick: () => this.rebuild() }, icon("rebuild"), "Rebuild");
    this.apply.dataset.help = "Builds the scene with these values, and starts anew. (B)";
    this.element = h("div", {}, this.form.element, this.apply);
    session.on("scene", ({ build }) => {
      this.staged = {};
      this.form.show(build);
      this.element.hidden = build.length === 0;
      this.apply.classList.remove("primary");
    });
  }

  rebuild(): void {
    if (this.session.scene?.build.length) this.controls.rebuild(this.staged);
  }

  private stage(name: string, value: number): void {
    this.staged[name] = value;
    this.apply.classList.add("primary");
  }
}
