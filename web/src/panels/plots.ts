import type { Notice } from "../notice";
import { Chart, LINES } from "../plots/chart";
import { History } from "../plots/history";
import type { Quantity } from "../protocol";
import { type Session, same } from "../session";
import { Checkbox, h, Select } from "../ui/dom";
import { shownIn } from "../ui/units";

/** At most so many quantities are plotted. */
const MOST = 16;
/** Most that are listed at once; a search finds the others. */
const LISTED = 600;
/** Time within which the engine takes up what was chosen [ms]; until then it tells of what was before. */
const TAKEN_UP = 1000;
const WINDOWS: [number, string][] = [
  [2, "2 s"],
  [10, "10 s"],
  [60, "60 s"],
  [Number.POSITIVE_INFINITY, "All"],
];

/** Quantities over time, those of one unit in one chart. */
export class Plots {
  readonly element: HTMLElement;
  private readonly charts = h("div", { class: "charts" });
  private readonly chooser = h("div", { class: "chooser", popover: "auto" });
  private readonly history = new History();
  private drawn: Chart[] = [];
  /** Of each quantity that is plotted: what one of its unit shown is in the engine's. */
  private factors: number[] = [];
  private window = 10;
  private stale = true;
  /** The boxes of the chooser, by quantities: of those that are listed. */
  private readonly boxes = new Map<number, Checkbox>();
  /** What was chosen here and the engine has not yet told of, and when. */
  private asked: { quantities: number[]; at: number } | null = null;

  constructor(
    private readonly session: Session,
    private readonly notice: Notice,
  ) {
    const choose = h("button", { type: "button", "data-help": "Which quantities are plotted." }, "Choose…");
    choose.popoverTargetElement = this.chooser;
    const span = new Select("Time shown", "How much of the past is shown.", WINDOWS, (window) => {
      this.window = window;
      this.stale = true;
    });
    span.value = this.window;
    const bar = h("div", { class: "bar" }, choose, span.element);
    this.element = h("section", { class: "plots", "aria-label": "Plots" }, bar, this.charts, this.chooser);
    session.on("scene", ({ plots, quantities }) => {
      this.history.clear();
      this.asked = null;
      this.list(quantities);
      this.arrange(plots.slice(0, MOST));
    });
    session.on("frame", () => this.sample());
    session.on("status", ({ running, time, recorded, plots }) => {
      this.hear(plots);
      // Not every step is recorded; the present one is told in any case.
      if (!running) this.history.cut(Math.max(recorded[1], time) + 1e-9);
      this.stale = true;
    });
    session.on("shown", () => this.history.clear());
    new ResizeObserver(() => {
      this.stale = true;
    }).observe(this.charts);
  }

  /** Draws what changed. */
  draw(): void {
    if (!this.stale || this.element.hidden) return;
    this.stale = false;
    const now = this.session.frame?.time ?? 0;
    const last = Math.max(this.history.times.at(-1) ?? 0, now);
    // A scrubbed time stays in view.
    const to = Number.isFinite(this.window) ? Math.min(last, now + 0.1 * this.window) : last;
    const from = Math.max(this.history.times[0] ?? 0, to - this.window);
    for (const chart of this.drawn) chart.draw(from, to, now);
  }

  invalidate(): void {
    this.stale = true;
  }

  /** Takes the samples of a frame, unless it is of a past that is being looked at. */
  private sample(): void {
    const { frame } = this.session;
    if (!frame) return;
    this.stale = true;
    const last = this.history.times.at(-1) ?? Number.NEGATIVE_INFINITY;
    if (frame.quantities.length !== this.history.quantities.length) return;
    if (frame.time <= last && !frame.running) return;
    const { past, quantities, time } = frame;
    for (let row = 0; row < past.length; row += 1 + quantities.length) {
      this.push(time - past[row], past.subarray(row + 1, row + 1 + quantities.length));
    }
    this.push(time, quantities);
  }

  /** Keeps values as they are shown, in degrees where they are angles. */
  private push(time: number, values: Float32Array): void {
    this.history.push(
      time,
      values.map((value, i) => value / this.factors[i]),
    );
  }

  /** Takes up what is plotted: another page may have chosen it. */
  private hear(plots: number[]): void {
    const { asked } = this;
    if (asked && !same(plots, asked.quantities) && performance.now() - asked.at < TAKEN_UP) return;
    this.asked = null;
    if (this.session.scene && !same(plots, this.history.quantities)) this.arrange(plots);
  }

  private choose(quantity: number, on: boolean): void {
    const now = this.history.quantities;
    const quantities = on ? [...now, quantity] : now.filter((other) => other !== quantity);
    if (quantities.length > MOST) {
      const box = this.boxes.get(quantity);
      if (box) box.on = false;
      this.notice.tell(`At most ${MOST} quantities are plotted: take one away first.`);
      return;
    }
    this.asked = { quantities, at: performance.now() };
    this.session.send({ type: "plot", quantities });
    this.arrange(quantities);
  }

  private arrange(chosen: number[]): void {
    const all = this.session.scene?.quantities ?? [];
    for (const [quantity, box] of this.boxes) box.on = chosen.includes(quantity);
    this.history.choose(chosen);
    this.factors = chosen.map((quantity) => shownIn(all[quantity].unit).factor);
    const units = Map.groupBy(chosen, (quantity) => shownIn(all[quantity].unit).unit);
    this.drawn = [...units].map(([unit, quantities]) => {
      const lines = quantities.map((quantity) => ({
        quantity,
        label: all[quantity].label,
        color: LINES[chosen.indexOf(quantity) % LINES.length],
      }));
      return new Chart(unit, lines, this.history, () => {
        this.stale = true;
      });
    });
    const nothing = h(
      "p",
      { class: "muted" },
      "Nothing is plotted. Choose quantities to see them over time.",
    );
    this.charts.replaceChildren(
      ...(this.drawn.length ? this.drawn.map((chart) => chart.element) : [nothing]),
    );
    this.stale = true;
  }

  private list(quantities: Quantity[]): void {
    const find = h("input", {
      type: "search",
      placeholder: "Find a quantity",
      "aria-label": "Find a quantity",
    });
    const listed = h("div");
    const show = () => listed.replaceChildren(...this.found(quantities, find.value.toLowerCase()));
    find.addEventListener("input", show);
    show();
    this.chooser.replaceChildren(find, listed);
  }

  /** The boxes of what is found, by groups, and what is not among them. */
  private found(quantities: Quantity[], wanted: string): HTMLElement[] {
    const rows = [...quantities.keys()].filter((row) => quantities[row].label.toLowerCase().includes(wanted));
    const groups = Map.groupBy(rows.slice(0, LISTED), (row) => quantities[row].group);
    this.boxes.clear();
    const sections = [...groups].map(([group, rows]) => {
      const items = rows.map((row) => this.box(row, quantities[row]).element);
      return h("fieldset", {}, h("legend", {}, group), ...items);
    });
    const more = rows.length - LISTED;
    const left = more > 0 ? [`${more} more are found by a part of their names.`] : [];
    const { unlisted } = this.session.scene ?? {};
    const notes = [...left, ...(unlisted ? [unlisted] : [])];
    return [...notes.map((note) => h("p", { class: "muted" }, note)), ...sections];
  }

  private box(row: number, quantity: Quantity): Checkbox {
    const { unit } = shownIn(quantity.unit);
    const label = unit ? `${quantity.label} [${unit}]` : quantity.label;
    const box = new Checkbox(label, "", (on) => this.choose(row, on));
    box.on = this.history.quantities.includes(row);
    this.boxes.set(row, box);
    return box;
  }
}
