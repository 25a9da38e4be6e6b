import { h } from "../ui/dom";
import { short } from "../ui/format";
import type { History } from "./history";
import { padded, ticks } from "./ticks";

/** Colours of lines, told apart by those who do not see red and green apart, too (Okabe and Ito, 2008). */
export const LINES = ["#0072b2", "#d55e00", "#009e73", "#c470a0", "#b67d00", "#3a94cb", "#8a6fd1", "#7f7f7f"];
/** Room for the numbers of the axes [px]. */
const [LEFT, BOTTOM, TOP, RIGHT] = [52, 18, 6, 8];

/** A line of a chart. */
export interface Line {
  quantity: number;
  label: string;
  color: string;
}

/** Quantities of one unit over time. */
export class Chart {
  readonly element: HTMLElement;
  private readonly canvas: HTMLCanvasElement;
  private readonly values: HTMLElement[];
  private pointed: number | null = null;

  constructor(
    unit: string,
    private readonly lines: Line[],
    private readonly history: History,
    private readonly redraw: () => void,
  ) {
    const name = `${lines.map(({ label }) => label).join(", ")}${unit && ` [${unit}]`} over time`;
    this.canvas = h("canvas", { class: "chart", role: "img", "aria-label": name });
    this.values = lines.map(() => h("span", { class: "value" }));
    const legend = lines.map(({ label, color }, i) =>
      h(
        "span",
        { class: "legend" },
        h("i", { style: `background:${color}` }),
        label,
        this.values[i],
        h("span", { class: "unit" }, unit),
      ),
    );
    this.element = h("figure", { class: "plot" }, h("figcaption", {}, ...legend), this.canvas);
    this.canvas.addEventListener("pointermove", (event) => {
      this.pointed = event.offsetX;
      this.redraw();
    });
    this.canvas.addEventListener("pointerleave", () => {
      this.pointed = null;
      this.redraw();
    });
  }

  /** Draws from `from` to `to` [s], with a mark at `now`. */
  draw(from: number, to: number, now: number): void {
    const context = this.context();
    if (!context) return;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const first = Math.max(this.history.at(from), 0);
    const last = this.history.at(to);
    const [low, high] = padded(...this.extent(first, last));
    const end = to > from ? to : from + 1;
    const x = (time: number) => LEFT + ((time - from) / (end - from)) * (width - LEFT - RIGHT);
    const y = (value: number) => TOP + ((high - value) / (high - low)) * (height - TOP - BOTTOM);
    this.drawAxes(context, { x, y }, [from, end], [low, high]);

    context.save();
    context.beginPath();
    context.rect(LEFT, 0, width - LEFT - RIGHT, height);
    context.clip();
    for (const line of this.lines) this.drawLine(context, line, first, last, x, y);
    const marked =
      this.pointed === null ? now : from + ((this.pointed - LEFT) / (width - LEFT - RIGHT)) * (end - from);
    context.strokeStyle = this.style("--muted");
    context.lineWidth = 1;
    stroke(context, [x(marked), TOP], [x(marked), height - BOTTOM]);
    context.restore();
    const row = this.history.at(marked + 1e-9);
    this.lines.forEach(({ quantity }, i) => {
      this.values[i].textContent = row < 0 ? "–" : short(this.history.values(quantity)[row]);
    });
  }

  private extent(first: number, last: number): [number, number] {
    let [low, high] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
    for (const { quantity } of this.lines) {
      const values = this.history.values(quantity);
      for (let i = first; i <= last; i++) {
        if (!Number.isFinite(values[i])) continue;
        low = Math.min(low, values[i]);
        high = Math.max(high, values[i]);
      }
    }
    return [low, high];
  }

  private drawAxes(
    context: CanvasRenderingContext2D,
    { x, y }: { x: (time: number) => number; y: (value: number) => number },
    [from, to]: [number, number],
    [low, high]: [number, number],
  ): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    context.clearRect(0, 0, width, height);
    context.font = `11px ${getComputedStyle(document.body).fontFamily}`;
    context.fillStyle = this.style("--muted");
    context.strokeStyle = this.style("--line");
    context.lineWidth = 1;
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const value of ticks(low, high, Math.max(2, height / 34))) {
      stroke(context, [LEFT, y(value)], [width - RIGHT, y(value)]);
      context.fillText(short(value), LEFT - 6, y(value));
    }
    context.textAlign = "center";
    context.textBaseline = "alphabetic";
    for (const time of ticks(from, to, Math.max(2, width / 80))) {
      const right = x(time) > width - 24;
      context.textAlign = right ? "right" : "center";
      context.fillText(`${short(time)} s`, right ? width - 2 : x(time), height - 4);
    }
  }

  /** A line through the samples, broken where there is none. */
  private drawLine(
    context: CanvasRenderingContext2D,
    { quantity, color }: Line,
    first: number,
    last: number,
    x: (time: number) => number,
    y: (value: number) => number,
  ): void {
    const values = this.history.values(quantity);
    context.strokeStyle = color;
    context.lineWidth = 1.5;
    context.lineJoin = "round";
    context.beginPath();
    let pen = false;
    for (let i = first; i <= last; i++) {
      if (!Number.isFinite(values[i])) pen = false;
      else if (pen) context.lineTo(x(this.history.times[i]), y(values[i]));
      else {
        context.moveTo(x(this.history.times[i]), y(values[i]));
        pen = true;
      }
    }
    context.stroke();
  }

  private context(): CanvasRenderingContext2D | null {
    const { canvas } = this;
    const ratio = devicePixelRatio;
    const [w, h] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (!w || !h) return null;
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    const context = canvas.getContext("2d");
    context?.setTransform(ratio, 0, 0, ratio, 0, 0);
    return context;
  }

  private style(name: string): string {
    return getComputedStyle(this.canvas).getPropertyValue(name);
  }
}

function stroke(context: CanvasRenderingContext2D, from: [number, number], to: [number, number]): void {
  context.beginPath();
  context.moveTo(Math.round(from[0]) + 0.5, Math.round(from[1]) + 0.5);
  context.lineTo(Math.round(to[0]) + 0.5, Math.round(to[1]) + 0.5);
  context.stroke();
}
