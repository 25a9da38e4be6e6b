import type { Controls } from "../controls";
import type { Session } from "../session";
import { h, Select } from "../ui/dom";
import type { View } from "../view/view";

const COUNTS = [1, 4, 9, 16, 25, 36, 64, 100, 144, 256];

/** Which replicas are shown: one, or several side by side. */
export class Replicas {
  readonly element: HTMLElement;
  private readonly first: HTMLInputElement;
  private readonly of = h("span", { class: "muted of" });
  private readonly count: Select<number>;

  constructor(
    private readonly session: Session,
    private readonly controls: Controls,
    private readonly view: View,
  ) {
    this.first = h("input", {
      type: "number",
      min: 0,
      value: 0,
      "aria-label": "Replica",
      "data-help": "The first replica shown. ([ and ])",
      onchange: () => this.choose(this.first.valueAsNumber, session.shown.length),
    });
    const help = "How many replicas are shown side by side.";
    this.count = new Select<number>("Replicas shown", help, [], (count) =>
      this.choose(this.first.valueAsNumber, count),
    );
    const label = h("span", { class: "muted" }, "Replica");
    this.element = h("span", { class: "group replicas" }, label, this.first, this.of, this.count.element);
    session.on("shown", () => this.show());
  }

  private choose(first: number, count: number): void {
    if (!Number.isInteger(first)) {
      this.show();
      return;
    }
    if (count !== this.session.shown.length) this.view.frameNext();
    this.controls.show(first, count);
  }

  private show(): void {
    const { scene, shown } = this.session;
    const worlds = scene?.worlds ?? 0;
    const counts = COUNTS.filter((count) => count <= worlds);
    if (worlds <= 256 && !counts.includes(worlds)) counts.push(worlds);
    if (!counts.includes(shown.length)) counts.push(shown.length);
    counts.sort((a, b) => a - b);
    this.count.setOptions(counts.map((count) => [count, `${count} shown`]));
    this.count.value = shown.length;
    this.first.value = String(shown[0] ?? 0);
    this.first.max = String(Math.max(0, worlds - 1));
    this.of.textContent = `of ${worlds}`;
    this.first.disabled = this.count.element.disabled = worlds < 2;
  }
}
