import type { Page } from "../page";
import type { Tool } from "../pointing";
import type { Part } from "../shell";
import type { Themes } from "../theme";
import { h, Select } from "../ui/dom";
import { type IconName, icon } from "../ui/icons";
import { Replicas } from "./replicas";

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
  [null, "fastest"],
];

/** Runs, stops, steps; which replicas; pictures; the page itself. */
export class Toolbar {
  readonly element: HTMLElement;
  private readonly run: HTMLButtonElement;
  private readonly speed: Select<number | null>;
  private readonly tools: Map<Tool, HTMLButtonElement>;
  /** Of what can be shown or hidden. */
  private readonly parts: Record<Part, HTMLButtonElement>;
  private readonly record: HTMLButtonElement;
  private readonly theme: HTMLButtonElement;

  constructor(page: Omit<Page, "shell">, shell: () => Page["shell"]) {
    const { session, controls, capture, pointing, themes } = page;
    this.run = iconButton("run", "Run", "Runs or stops. (Space)", () => controls.toggle());
    this.run.classList.add("primary", "run");
    const help = "Simulated seconds a second; the fastest is what the machine can.";
    this.speed = new Select("Speed", help, SPEEDS, (factor) => controls.speed(factor));
    this.speed.value = 1;
    const grab = "Drags bodies by a spring; also with Ctrl and the mouse. (G)";
    const push = "Pushes the body that is clicked. (P)";
    this.tools = new Map([
      ["grab", iconButton("grab", "Grab", grab, () => pointing.toggle("grab"))],
      ["push", iconButton("push", "Push", push, () => pointing.toggle("push"))],
    ]);
    const film = "Records a film, as WebM. (Shift+S)";
    this.record = iconButton("record", "Record", film, () => capture.toggleFilm());
    this.theme = iconButton("theme", "Theme", "", () => themes.turn());
    for (const button of [...this.tools.values(), this.record]) button.setAttribute("aria-pressed", "false");
    this.parts = {
      left: iconButton("left", "Scene", "Shows or hides the scene's panel. (Shift+E)", () =>
        shell().toggleSide("left"),
      ),
      right: iconButton("right", "Inspect", "Shows or hides the panel of bodies. (Shift+I)", () =>
        shell().toggleSide("right"),
      ),
      plots: iconButton("plots", "Plots", "Shows or hides plots. (O)", () => shell().togglePlots()),
    };
    this.element = h(
      "header",
      { class: "toolbar", "aria-label": "Simulation" },
      this.parts.left,
      h("h1", { class: "brand" }, "Kinetarium"),
      this.engineControls(page),
      h("span", { class: "space" }),
      this.pageButtons(page, shell),
    );
    session.on("running", (running) => this.showRunning(running));
    session.on("status", ({ speed }) => this.showSpeed(speed));
    pointing.on("tool", (tool) => {
      for (const [name, button] of this.tools) button.setAttribute("aria-pressed", String(name === tool));
    });
    themes.on("change", () => this.showTheme(themes.chosen));
    this.showTheme(themes.chosen);
    capture.on("recording", (recording) => this.record.setAttribute("aria-pressed", String(recording)));
  }

  /** What is of no use while the engine is away. */
  private engineControls({ session, controls, view, build, connection }: Omit<Page, "shell">): HTMLElement {
    const rebuild = iconButton("rebuild", "Rebuild", "Builds the scene with the panel's values. (B)", () =>
      build.rebuild(),
    );
    const element = h(
      "fieldset",
      { class: "contents engine", "aria-label": "Engine", disabled: true },
      group(
        this.run,
        iconButton("restart", "Restart", "The initial state. (R)", () => controls.restart()),
        rebuild,
      ),
      stepButtons((steps) => controls.step(steps)),
      group(this.speed.element),
      new Replicas(session, controls, view).element,
      group(h("span", { class: "joined" }, ...this.tools.values())),
    );
    session.on("scene", ({ build }) => {
      rebuild.disabled = build.length === 0;
    });
    connection.on("here", (here) => {
      element.disabled = !here;
    });
    return element;
  }

  private showTheme(chosen: Themes["chosen"]): void {
    const now = chosen === "system" ? "as the system says" : chosen;
    this.theme.setAttribute("aria-label", `Theme: ${now}`);
    this.theme.dataset.help = `Now ${now}. Light, dark, or as the system says. (L)`;
  }

  /** Says what can be seen. */
  shown(shown: Record<Part, boolean>): void {
    for (const [part, button] of Object.entries(this.parts)) {
      button.setAttribute("aria-expanded", String(shown[part as Part]));
    }
  }

  private pageButtons(page: Omit<Page, "shell">, shell: () => Page["shell"]): HTMLElement {
    const { navigation, capture, share } = page;
    return group(
      iconButton("frame", "Frame", "Sees the whole scene, or the picked body. (F)", () => navigation.frame()),
      this.parts.plots,
      iconButton("camera", "Save picture", "Saves a picture, as PNG. (S)", () => capture.savePicture()),
      this.record,
      iconButton("link", "Copy link", "Copies an address that shows the same.", () => share.copy()),
      this.theme,
      iconButton("help", "Help", "Keys and mouse. (?)", () => shell().help()),
      this.parts.right,
    );
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

function stepButtons(step: (steps: number) => void): HTMLElement {
  const buttons = STEPS.map((steps) => {
    const help = `Steps ${steps} times, and stops.`;
    return h("button", { type: "button", "data-help": help, onclick: () => step(steps) }, String(steps));
  });
  const joined = h("span", { class: "joined", role: "group", "aria-label": "Step" }, ...buttons);
  return group(h("span", { class: "muted" }, "Step"), joined);
}

function iconButton(name: IconName, label: string, help: string, act: () => void): HTMLButtonElement {
  return h(
    "button",
    { type: "button", class: "with-icon", "aria-label": label, "data-help": help, onclick: act },
    icon(name),
  );
}

function group(...children: HTMLElement[]): HTMLElement {
  return h("span", { class: "group" }, ...children);
}
