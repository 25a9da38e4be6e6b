import { Emitter } from "./emitter";
import type { Grabbing } from "./grabbing";
import type { Navigation } from "./navigation";
import type { Pushing } from "./pushing";
import type { Selection } from "./selection";
import { Gestures, type Hold } from "./view/gestures";
import type { View } from "./view/view";

/** What the pointer does on a body, besides picking it. */
export type Tool = "look" | "grab" | "push";

/** The pointer on the picture: it looks about, picks, grabs and pushes. */
export class Pointing extends Emitter<{ tool: Tool }> {
  private chosen: Tool = "look";

  constructor(
    private readonly view: View,
    navigation: Navigation,
    private readonly selection: Selection,
    private readonly grabbing: Grabbing,
    private readonly pushing: Pushing,
  ) {
    super();
    const { canvas } = view.stage;
    new Gestures(canvas, {
      orbit: (right, down) => navigation.orbit(right, down),
      pan: (right, down) => navigation.pan(right, down),
      zoom: (factor) => navigation.zoom(factor),
      click: (x, y) => this.click(x, y),
      press: (x, y, held) => this.press(x, y, held),
    });
  }

  set tool(tool: Tool) {
    this.chosen = tool;
    this.view.stage.canvas.dataset.tool = tool;
    this.emit("tool", tool);
  }

  /** Takes a tool, or lays it away. */
  toggle(tool: Tool): void {
    this.tool = this.chosen === tool ? "look" : tool;
  }

  private click(x: number, y: number): void {
    const hit = this.view.hit(x, y);
    this.selection.pick(hit);
    if (hit && this.chosen === "push") this.pushing.push(hit, this.view.direction(x, y));
  }

  private press(x: number, y: number, held: boolean): Hold | null {
    if (!held && this.chosen !== "grab") return null;
    const hit = this.view.hit(x, y);
    return hit && this.grabbing.take(hit);
  }
}
