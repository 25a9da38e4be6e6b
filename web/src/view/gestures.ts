/** Mouse, touch and wheel on the canvas, told as what they mean. */

/** Something held with the pointer until it is let go. */
export interface Hold {
  move(x: number, y: number): void;
  end(): void;
}

/** Pointer positions are in pixels of the canvas; moves in heights of the canvas. */
export interface Actions {
  orbit(right: number, down: number): void;
  pan(right: number, down: number): void;
  zoom(factor: number): void;
  click(x: number, y: number): void;
  /** Takes hold of what is there, if the tool at hand does; `held` says that the key for it is. */
  press(x: number, y: number, held: boolean): Hold | null;
}

interface Pointer {
  x: number;
  y: number;
}

/** Within so many pixels, a press is a click; a finger trembles more than a mouse. */
const [CLICK, TAP] = [4, 12];

/** Whether the page is shown within another one. */
const FRAMED = self !== top;

export class Gestures {
  private readonly pointers = new Map<number, Pointer>();
  private hold: Hold | null = null;
  private travelled = 0;

  constructor(
    private readonly canvas: HTMLElement,
    private readonly actions: Actions,
  ) {
    // The style sheet leaves a finger's way down to that page, too.
    canvas.classList.toggle("framed", FRAMED);
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.up(event));
    canvas.addEventListener("pointercancel", (event) => this.up(event, false));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
  }

  private down(event: PointerEvent): void {
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    if (this.pointers.size > 1) {
      this.letGo();
      // Two fingers mean the view, however short they touch.
      this.travelled = Number.POSITIVE_INFINITY;
      return;
    }
    this.travelled = 0;
    if (event.button === 0) {
      this.hold = this.actions.press(event.offsetX, event.offsetY, event.ctrlKey || event.metaKey);
    }
  }

  private move(event: PointerEvent): void {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    const [before, x, y] = [{ ...pointer }, event.offsetX, event.offsetY];
    const height = this.canvas.clientHeight;
    const [right, down] = [(x - before.x) / height, (y - before.y) / height];
    this.travelled += Math.abs(x - before.x) + Math.abs(y - before.y);
    const others = [...this.pointers].filter(([id]) => id !== event.pointerId).map(([, other]) => other);
    Object.assign(pointer, { x, y });
    if (this.hold) {
      this.hold.move(x, y);
    } else if (others.length) {
      // Each of two fingers moves the view by half; their distance zooms.
      this.actions.pan(right / 2, down / 2);
      const [was, is] = [distance(before, others[0]), distance(pointer, others[0])];
      if (was > 0 && is > 0) this.actions.zoom(was / is);
    } else if (event.buttons & 6 || event.shiftKey) {
      this.actions.pan(right, down);
    } else {
      this.actions.orbit(right, down);
    }
  }

  private up(event: PointerEvent, meant = true): void {
    if (!this.pointers.delete(event.pointerId)) return;
    const held = this.hold !== null;
    this.letGo();
    const still = this.travelled < (event.pointerType === "touch" ? TAP : CLICK);
    const clicked = meant && event.button === 0 && still && this.pointers.size === 0;
    if (clicked && !held) this.actions.click(event.offsetX, event.offsetY);
  }

  private wheel(event: WheelEvent): void {
    // Within another page the wheel scrolls that page, until this one is pressed.
    if (FRAMED && !event.ctrlKey && !this.canvas.matches(":focus")) return;
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    this.actions.zoom(Math.exp(0.0015 * lines * event.deltaY));
  }

  private letGo(): void {
    this.hold?.end();
    this.hold = null;
  }
}

function distance(a: Pointer, b: Pointer): number {
  return Math.hypot(a.x - b.x, a.y - b.y);
}
