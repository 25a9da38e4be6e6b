import { Emitter } from "./emitter";
import { keep, recall } from "./store";
import { h, section } from "./ui/dom";

/** Narrower than this, a panel lies over the picture [px]. */
const NARROW = 1100;
/** Lower than this, plots are hidden at first [px]. */
const LOW = 600;

/** What the page is made of. */
export interface Parts {
  toolbar: HTMLElement;
  /** Sections of the panels, by their titles. */
  left: Record<string, HTMLElement>;
  right: Record<string, HTMLElement>;
  canvas: HTMLElement;
  /** What lies over the picture. */
  over: HTMLElement[];
  plots: HTMLElement;
  timeline: HTMLElement;
  help: HTMLDialogElement;
}

export type Side = "left" | "right";

/** What can be shown or hidden. */
export type Part = Side | "plots";

/** Arranges the page, and shows or hides its parts. */
export class Shell extends Emitter<{ shown: Record<Part, boolean> }> {
  private readonly sides: Record<Side, HTMLElement>;

  constructor(private readonly parts: Parts) {
    super();
    this.sides = {
      left: side("left", "Scene", parts.left),
      right: side("right", "Inspect", parts.right),
    };
    const kept = roomy() ? recall<Partial<Record<Part, boolean>>>("parts", {}) : {};
    const wide = innerWidth >= NARROW;
    this.sides.left.hidden = !(kept.left ?? wide);
    this.sides.right.hidden = !(kept.right ?? wide);
    parts.plots.hidden = !(kept.plots ?? roomy());
    const picture = h("main", { class: "picture" }, parts.canvas, ...parts.over);
    const center = h("div", { class: "center" }, picture, parts.plots);
    document.body.append(
      parts.toolbar,
      h("div", { class: "middle" }, this.sides.left, center, this.sides.right),
      parts.timeline,
      parts.help,
    );
  }

  /** Shows or hides a side; where there is room for one, the other goes. */
  toggleSide(which: Side): void {
    const { left, right } = this.sides;
    const [wanted, other] = which === "left" ? [left, right] : [right, left];
    wanted.hidden = !wanted.hidden;
    if (innerWidth < NARROW) other.hidden = true;
    this.tell();
  }

  togglePlots(): void {
    this.parts.plots.hidden = !this.parts.plots.hidden;
    this.tell();
  }

  /** Hides a side that lies over the picture. Returns whether there was one. */
  closeOverlay(): boolean {
    const { left, right } = this.sides;
    const open = [left, right].find((side) => !side.hidden);
    if (innerWidth >= NARROW || !open) return false;
    open.hidden = true;
    this.parts.canvas.focus();
    this.tell();
    return true;
  }

  private tell(): void {
    if (roomy()) keep("parts", this.shown);
    this.emit("shown", this.shown);
  }

  get shown(): Record<Part, boolean> {
    const { left, right } = this.sides;
    return { left: !left.hidden, right: !right.hidden, plots: !this.parts.plots.hidden };
  }

  help(): void {
    this.parts.help.showModal();
  }
}

/** Whether there is room for everything at once: then what is hidden was not wanted. */
function roomy(): boolean {
  return innerWidth >= NARROW && innerHeight >= LOW;
}

function side(which: Side, label: string, sections: Record<string, HTMLElement>): HTMLElement {
  const parts = Object.entries(sections).map(([title, content]) => section(title, true, content));
  return h("aside", { class: `side ${which}`, "aria-label": label }, ...parts);
}
