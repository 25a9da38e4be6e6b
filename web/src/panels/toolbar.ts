import type { Controls } from "../controls";
import type { Session } from "../session";
import { h, Select } from "../ui/dom";
import { type IconName, icon } from "../ui/icons";

/** What the pointer does on a body. */
export type Tool = "look" | "grab" | "push";

/** What the toolbar asks of the page. */
export interface PageActions {
  picture(): void;
  record(): void;
  theme(): void;
  help(): void;
  frame(): void;
  share(): void;
  plots(): void;
  replicas(first: number, count: number): void;
  side(which: "left" | "right"): void;
  tool(tool: Tool): void;
}

const STEPS = [1, 10, 100, 1000, 10000];
const SPEEDS: [number | null, string][] = [
  [0.01, "1/100 ×"],
  [0.1, "1/10 ×"],
  [0.25, "1/4 ×"],
  [0.5, "1/2 ×"],
  [1, "1 ×"],
  [2, "2 ×"],
  [10, "10 ×"],
  [100, "100 ×"],
  [null, "As fast as possible"],
];
const COUNTS = [1, 4, 9, 16, 25, 36, 64, 100, 144, 256];

/** Runs, stops, steps; which replicas; pictures; the page itself. */
export class Toolbar {
  readonly element: HTMLElement;
  private readonly run: HTMLButtonElement;
  private readonly speed: Select<number | null>;
  private readonly first: HTMLInputElement;
  private readonly of = h("span", { class: "muted" });
  private readonly count: Select<number>;
  private readonly tools = new Map<Tool, HTMLButtonElement>();
  private readonly record: HTMLButtonElement;

  constructor(
    private readonly session: Session,
    private readonly controls: Controls,
    private readonly page: PageActions,
  ) {
    this.run = this.button("run", "Run", "Runs or stops. (Space)", () => controls.toggle());
    this.run.classList.add("primary", "run");
    this.speed = new Select("Speed", "Simulated seconds a second.", SPEEDS, (factor) =>
      controls.speed(factor),
    );
    this.first = h("input", {
      type: "number",
      min: 0,
      value: 0,
      "aria-label": "Replica",
      "data-help": "The first replica shown. ([ and ])",
      onchange: () => this.show(this.first.valueAsNumber, this.session.shown.length),
    });
    this.count = new Select<number>(
      "Replicas shown",
      "How many replicas are shown side by side.",
      [],
      (count) => this.show(this.first.valueAsNumber, count),
    );
    this.record = this.button("record", "Record", "Records a film, as WebM. (Shift+S)", () => page.record());
    this.element = this.bar();
    session.on("scene", () => this.showReplicas());
    session.on("shown", () => this.showReplicas());
    session.on("status", ({ running, speed }) => {
      this.showRunning(running);
      this.showSpeed(speed);
    });
    this.tool = "look";
  }

  set tool(tool: Tool) {
    for (const [name, button] of this.tools) button.setAttribute("aria-pressed", String(name === tool));
    this.page.tool(tool);
  }

  set recording(recording: boolean) {
    this.record.setAttribute("aria-pressed", String(recording));
  }

  private bar(): HTMLElement {
    const { controls, page } = this;
    const steps = STEPS.map((steps) =>
      h(
        "button",
        {
          type: "button",
          "data-help": `Steps ${steps} times, and stops.`,
          onclick: () => controls.step(steps),
        },
        String(steps),
      ),
    );
    for (const tool of ["grab", "push"] as const) this.tools.set(tool, this.toolButton(tool));
    return h(
      "header",
      { class: "toolbar", "aria-label": "Simulation" },
      this.button("left", "Scene", "Shows or hides the scene's panel. (Shift+E)", () => page.side("left")),
      h("strong", { class: "brand" }, "Kinetarium"),
      group(
        this.run,
        this.button("restart", "Restart", "The initial state. (R)", () => controls.restart()),
      ),
      group(h("span", { class: "muted" }, "Step"), h("span", { class: "joined" }, ...steps)),
      group(this.speed.element),
      group(h("span", { class: "muted" }, "Replica"), this.first, this.of, this.count.element),
      group(h("span", { class: "joined" }, ...this.tools.values())),
      h("span", { class: "space" }),
      group(
        this.button("frame", "Frame", "Sees the whole scene, or the picked body. (F)", () => page.frame()),
        this.button("plots", "Plots", "Shows or hides plots. (O)", () => page.plots()),
        this.button("camera", "Save picture", "Saves a picture, as PNG. (S)", () => page.picture()),
        this.record,
        this.button("link", "Copy link", "Copies an address that shows the same.", () => page.share()),
        this.button("theme", "Theme", "Light, dark, or as the system says. (L)", () => page.theme()),
        this.button("help", "Help", "Keys and mouse. (?)", () => page.help()),
        this.button("right", "Inspect", "Shows or hides the panel of bodies. (Shift+I)", () =>
          page.side("right"),
        ),
      ),
    );
  }

  private toolButton(tool: "grab" | "push"): HTMLButtonElement {
    const help = {
      grab: "Drags bodies by a spring; also with Ctrl and the mouse. (G)",
      push: "Pushes the body that is clicked. (P)",
    };
    const button = this.button(tool, tool === "grab" ? "Grab" : "Push", help[tool], () => {
      this.tool = button.getAttribute("aria-pressed") === "true" ? "look" : tool;
    });
    return button;
  }

  /** Chooses a tool, or lays it away. */
  toggleTool(tool: "grab" | "push"): void {
    this.tools.get(tool)?.click();
  }

  private button(name: IconName, label: string, help: string, act: () => void): HTMLButtonElement {
    return h(
      "button",
      { type: "button", class: "with-icon", "aria-label": label, "data-help": help, onclick: act },
      icon(name),
    );
  }

  private show(first: number, count: number): void {
    if (Number.isInteger(first)) this.page.replicas(first, count);
    else this.showReplicas();
  }

  private showReplicas(): void {
    const { scene, shown } = this.session;
    const worlds = scene?.worlds ?? 0;
    const counts = COUNTS.filter((count) => count <= worlds);
    if (worlds <= 256 && !counts.includes(worlds)) counts.push(worlds);
    if (!counts.includes(shown.length)) counts.push(shown.length);
    counts.sort((a, b) => a - b);
    this.count.setOptions(counts.map((count) => [count, count === 1 ? "one" : `${count} side by side`]));
    this.count.value = shown.length;
    this.first.value = String(shown[0] ?? 0);
    this.first.max = String(Math.max(0, worlds - 1));
    this.of.textContent = `of ${worlds}`;
    this.first.disabled = this.count.element.disabled = worlds < 2;
  }

  private showRunning(running: boolean): void {
    const label = running ? "Stop" : "Run";
    if (this.run.getAttribute("aria-label") === label) return;
    this.run.setAttribute("aria-label", label);
    this.run.replaceChildren(icon(running ? "stop" : "run"));
  }

  private showSpeed(speed: number | null): void {
    if (!SPEEDS.some(([factor]) => factor === speed)) {
      this.speed.setOptions([...SPEEDS, [speed, `${speed} ×`]]);
    }
    this.speed.value = speed;
  }
}

function group(...children: HTMLElement[]): HTMLElement {
  return h("span", { class: "group" }, ...children);
}
