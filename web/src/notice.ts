import { h } from "./ui/dom";

/** A line at the foot of the picture that says what went wrong, calmly. */
export class Notice {
  readonly element: HTMLElement;
  private readonly text = h("span");

  constructor() {
    const close = h("button", { type: "button", "aria-label": "Dismiss", onclick: () => this.clear() }, "×");
    this.element = h("div", { class: "notice", role: "status", hidden: true }, this.text, close);
  }

  get shown(): boolean {
    return !this.element.hidden;
  }

  tell(text: string): void {
    this.text.textContent = text;
    this.element.hidden = false;
  }

  /** Takes the line away; if a text is given, only where it says that. */
  clear(text = this.text.textContent): void {
    if (text === this.text.textContent) this.element.hidden = true;
  }
}
