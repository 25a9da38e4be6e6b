import { h } from "./ui/dom";

/** A line at the foot of the picture that says what went wrong, calmly; and one that only screen readers read. */
export class Notice {
  /** Is always there, so that screen readers hear what comes to be in it. */
  readonly element: HTMLElement;
  private readonly line: HTMLElement;
  private readonly text = h("span");
  private readonly spoken = h("span", { class: "spoken" });

  constructor() {
    const close = h("button", { type: "button", "aria-label": "Dismiss", onclick: () => this.clear() }, "×");
    this.line = h("div", { class: "notice", hidden: true }, this.text, close);
    this.element = h("div", { role: "status" }, this.line, this.spoken);
  }

  tell(text: string): void {
    this.text.textContent = text;
    this.line.hidden = false;
  }

  /** Says what the picture shows. */
  say(text: string): void {
    this.spoken.textContent = text;
  }

  /** Takes the line away; if a text is given, only where it says that. */
  clear(text = this.text.textContent): void {
    if (text === this.text.textContent) this.line.hidden = true;
  }
}
