import { Recorder, savePicture } from "./capture";
import { Controls } from "./controls";
import { Grabbing } from "./grabbing";
import { Notice } from "./notice";
import { BodyPanel } from "./panels/body";
import { Build } from "./panels/build";
import { Drives } from "./panels/drives";
import { Gallery } from "./panels/gallery";
import { Guide } from "./panels/guide";
import { helpDialog } from "./panels/help";
import { Physics } from "./panels/physics";
import { Plots } from "./panels/plots";
import { Skins } from "./panels/skins";
import { Timeline } from "./panels/timeline";
import { type Tool, Toolbar } from "./panels/toolbar";
import { ViewPanel } from "./panels/view_panel";
import { Pushing } from "./pushing";
import { Selection } from "./selection";
import { Session } from "./session";
import { Share } from "./share";
import { listen, type Shortcut } from "./shortcuts";
import { keep, recall } from "./store";
import { type ThemeChoice, Themes } from "./theme";
import type { Receiver, Transport } from "./transport/transport";
import { h, section } from "./ui/dom";
import { showTooltips } from "./ui/tooltip";
import type { Mount } from "./view/camera_rig";
import { Gestures, type Hold } from "./view/gestures";
import type { Picked } from "./view/overlays/overlay";
import { View } from "./view/view";

/** Turns of the view by a drag over the canvas's height, and by a key [rad]. */
const [DRAG_TURN, KEY_TURN] = [Math.PI, Math.PI / 24];
const THEMES: ThemeChoice[] = ["system", "light", "dark"];
const AWAY = "The engine is away; the page goes on when it is back.";
/** Narrower than this, a panel lies over the picture [px]. */
const NARROW = 900;

/** The page: makes its parts and joins them. */
export class App {
  readonly session: Session;
  readonly view: View;
  private readonly controls: Controls;
  private readonly share: Share;
  private readonly selection = new Selection();
  private readonly notice = new Notice();
  private readonly themes = new Themes(recall<ThemeChoice>("theme", "system"));
  private readonly grabbing: Grabbing;
  private readonly pushing: Pushing;
  private readonly recorder: Recorder;
  private readonly plots: Plots;
  private readonly skins: Skins;
  private readonly viewPanel: ViewPanel;
  private readonly build: Build;
  private readonly timeline: Timeline;
  private readonly toolbar: Toolbar;
  private readonly help: HTMLDialogElement;
  private readonly picture = h("main", { class: "picture" });
  private tool: Tool = "look";

  constructor(connect: (receiver: Receiver) => Transport) {
    const canvas = h("canvas", {
      class: "stage",
      tabindex: 0,
      "aria-label": "The scene. Arrow keys turn the view.",
    });
    this.picture.append(canvas);
    this.session = new Session(connect);
    this.view = new View(canvas);
    this.controls = new Controls(this.session);
    // The view takes a scene first, and then what the address tells of it.
    this.session.on("scene", (scene) => this.view.setScene(scene));
    this.session.on("frame", (frame) => this.view.setFrame(frame));
    this.share = new Share(this.session, this.controls, this.view);
    this.grabbing = new Grabbing(this.session, this.controls, this.view);
    this.pushing = new Pushing(this.session, this.selection, this.view);
    this.recorder = new Recorder(canvas);
    this.plots = new Plots(this.session);
    this.skins = new Skins(this.view, this.selection, this.notice);
    this.viewPanel = new ViewPanel(this.session, this.view);
    this.build = new Build(this.session, this.controls);
    this.timeline = new Timeline(this.session, this.controls);
    this.toolbar = new Toolbar(this.session, this.controls, this.pageActions());
    const shortcuts = this.shortcuts();
    this.help = helpDialog(shortcuts);
    this.compose();
    this.listen(canvas);
    listen(shortcuts);
    showTooltips();
    requestAnimationFrame((now) => this.draw(now, now));
  }

  private compose(): void {
    const { session, controls, share } = this;
    const left = h(
      "aside",
      { class: "side left", "aria-label": "Scene" },
      section("Examples", true, new Gallery(session, share).element),
      section("Guide", true, new Guide(session).element),
      section("Build", true, this.build.element),
      section("Physics", true, new Physics(session, share).element),
    );
    const body = new BodyPanel(session, this.selection, this.pushing, (mount) => this.mount(mount));
    const right = h(
      "aside",
      { class: "side right", "aria-label": "Inspect" },
      section("Body", true, body.element),
      section("Joints and actuators", true, new Drives(session, controls).element),
      section("View", true, this.viewPanel.element),
      section("Skin", true, this.skins.element),
    );
    left.hidden = right.hidden = innerWidth < NARROW;
    this.plots.element.hidden = innerHeight < 600 || innerWidth < NARROW;
    this.picture.append(this.viewPanel.inset, this.skins.legend, this.notice.element);
    document.body.append(
      this.toolbar.element,
      h(
        "div",
        { class: "middle" },
        left,
        h("div", { class: "center" }, this.picture, this.plots.element),
        right,
      ),
      this.timeline.element,
      this.help,
    );
  }

  private listen(canvas: HTMLCanvasElement): void {
    const { session, view, selection, themes } = this;
    session.on("error", (reason) => this.notice.tell(reason));
    session.on("connected", (connected) => {
      if (connected) this.notice.clear(AWAY);
      else this.notice.tell(AWAY);
    });
    session.on("scene", () => {
      selection.now = null;
      document.title = `${session.scene?.title} – Kinetarium`;
    });
    session.on("shown", () => this.mark());
    selection.on("change", () => this.mark());
    themes.on("change", (theme) => this.setTheme(theme));
    this.setTheme(themes.now);
    new Gestures(canvas, {
      orbit: (right, down) => this.moved(() => view.rig.orbit(-DRAG_TURN * right, DRAG_TURN * down)),
      pan: (right, down) => this.moved(() => view.rig.pan(-right, down)),
      zoom: (factor) => this.moved(() => view.rig.zoom(factor)),
      click: (x, y) => this.click(x, y),
      press: (x, y, held) => this.press(x, y, held),
    });
    this.picture.addEventListener("dragover", (event) => event.preventDefault());
    this.picture.addEventListener("drop", (event) => this.drop(event));
  }

  private draw(now: number, before: number): void {
    requestAnimationFrame((next) => this.draw(next, now));
    const drawn = this.view.draw(Math.min((now - before) / 1000, 0.1));
    if (drawn) {
      this.skins.readScale();
      this.session.drawn();
    }
    this.plots.draw();
  }

  private moved(move: () => void): void {
    move();
    this.view.invalidate();
    this.share.moved();
  }

  private mount(mount: Mount): void {
    const picked = this.picked();
    if (mount !== "free" && !picked) return;
    this.moved(() => this.view.mount(mount, picked ?? undefined));
  }

  private picked(): Picked | null {
    const selected = this.selection.now;
    const row = selected ? this.session.shown.indexOf(selected.world) : -1;
    return selected && row >= 0 ? { row, body: selected.body } : null;
  }

  private mark(): void {
    this.view.pick = this.picked();
  }

  private click(x: number, y: number): void {
    const hit = this.view.hit(x, y);
    const world = hit && this.session.shown[hit.row];
    this.selection.now =
      hit && hit.body >= 0 && world !== undefined && world !== null ? { world, body: hit.body } : null;
    if (hit && this.tool === "push") this.pushing.push(hit, this.view.direction(x, y));
  }

  private press(x: number, y: number, held: boolean): Hold | null {
    if (!held && this.tool !== "grab") return null;
    const hit = this.view.hit(x, y);
    return hit && this.grabbing.take(hit);
  }

  private drop(event: DragEvent): void {
    event.preventDefault();
    const [file] = event.dataTransfer?.files ?? [];
    const canvas = this.view.stage.canvas.getBoundingClientRect();
    const hit = this.view.hit(event.clientX - canvas.left, event.clientY - canvas.top);
    if (file) this.skins.wear(file, hit?.body ?? this.selection.now?.body);
  }

  /** Picks the next body, or the one before. */
  private pickNext(by: 1 | -1): void {
    const count = this.session.scene?.bodies.length ?? 0;
    const world = this.selection.now?.world ?? this.session.shown[0];
    if (!count || world === undefined) return;
    const body = this.selection.now ? (this.selection.now.body + by + count) % count : by > 0 ? 0 : count - 1;
    this.selection.now = { world, body };
  }

  private setTheme(theme: "light" | "dark"): void {
    this.view.theme = theme;
    this.plots.invalidate();
  }

  private turnTheme(): void {
    this.themes.choice = THEMES[(THEMES.indexOf(this.themes.choice) + 1) % THEMES.length];
    keep("theme", this.themes.choice);
  }

  private get name(): string {
    const time = this.session.frame?.time ?? 0;
    return `${this.session.scene?.name ?? "kinetarium"}-${time.toFixed(3)}s`;
  }

  private async guarded(act: () => void | Promise<void>): Promise<void> {
    try {
      await act();
    } catch (error) {
      this.notice.tell((error as Error).message);
    }
  }

  private savePicture(): void {
    // The canvas is empty after the browser has shown it, so it is drawn in the same turn.
    this.view.render();
    this.guarded(() => savePicture(this.view.stage.canvas, this.name));
  }

  private toggleRecord(): void {
    this.guarded(async () => {
      if (this.recorder.recording) await this.recorder.stop(this.name);
      else this.recorder.start();
    }).then(() => {
      this.toolbar.recording = this.recorder.recording;
    });
  }

  private toggleSide(which: "left" | "right"): void {
    for (const side of document.querySelectorAll<HTMLElement>(".side")) {
      if (side.classList.contains(which)) side.hidden = !side.hidden;
      else if (innerWidth < NARROW) side.hidden = true;
    }
  }

  private pageActions() {
    return {
      picture: () => this.savePicture(),
      record: () => this.toggleRecord(),
      theme: () => this.turnTheme(),
      help: () => this.help.showModal(),
      frame: () => this.moved(() => this.view.frameScene()),
      share: () => this.guarded(() => navigator.clipboard.writeText(location.href)),
      replicas: (first: number, count: number) => {
        if (count !== this.session.shown.length) this.view.frameNext();
        this.controls.show(first, count);
      },
      plots: () => this.togglePlots(),
      side: (which: "left" | "right") => this.toggleSide(which),
      tool: (tool: Tool) => {
        this.tool = tool;
        this.picture.dataset.tool = tool;
      },
    };
  }

  private togglePlots(): void {
    this.plots.element.hidden = !this.plots.element.hidden;
    this.plots.invalidate();
  }

  private turn(key: string): void {
    const [right, up] = direction(key);
    this.moved(() => this.view.rig.orbit(KEY_TURN * right, KEY_TURN * up));
  }

  private pan(key: string): void {
    const [right, up] = direction(key);
    this.moved(() => this.view.rig.pan(0.05 * right, 0.05 * up));
  }

  private shortcuts(): Shortcut[] {
    const { controls, viewPanel, timeline } = this;
    const arrows = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"];
    const digits = Array.from({ length: 9 }, (_, i) => String(i + 1));
    const place = (key: string) => Number(key.at(-1)) - 1;
    return [
      { keys: [" "], help: "Runs or stops", act: () => controls.toggle() },
      { keys: ["n"], help: "Steps once", act: () => controls.step(1) },
      { keys: ["Shift+n"], help: "Steps 100 times", act: () => controls.step(100) },
      { keys: ["r"], help: "Restarts", act: () => controls.restart() },
      { keys: ["b"], help: "Rebuilds", act: () => this.build.rebuild() },
      {
        keys: [",", "."],
        help: "Goes back or on by a hundredth of what is recorded",
        act: (key) => timeline.leap(key === "," ? -1 : 1),
      },
      {
        keys: ["[", "]"],
        help: "The replicas before, or after",
        act: (key) => controls.leaf(key === "[" ? -1 : 1),
      },
      { keys: arrows, help: "Turn the view", act: (key) => this.turn(key) },
      { keys: arrows.map((key) => `Shift+${key}`), help: "Move the view", act: (key) => this.pan(key) },
      {
        keys: ["+", "-"],
        help: "Comes closer, or goes away",
        act: (key) => this.moved(() => this.view.rig.zoom(key === "-" ? 1.15 : 1 / 1.15)),
      },
      {
        keys: ["f"],
        help: "Frames the scene, or the picked body",
        act: () => this.moved(() => this.view.frameScene()),
      },
      {
        keys: ["j", "k"],
        help: "Picks the next body, or the one before",
        act: (key) => this.pickNext(key === "j" ? 1 : -1),
      },
      { keys: ["c"], help: "Follows the picked body", act: () => this.mount("follow") },
      { keys: ["v"], help: "Sees with the picked body's eyes", act: () => this.mount("ride") },
      { keys: ["x"], help: "Lets the camera go", act: () => this.moved(() => this.view.mount("free")) },
      { keys: ["u"], help: "Pushes the picked body along the view", act: () => this.pushing.pushPicked() },
      {
        keys: ["g"],
        help: "The pointer grabs bodies, or turns the view again",
        act: () => this.toolbar.toggleTool("grab"),
      },
      {
        keys: ["p"],
        help: "The pointer pushes bodies, or turns the view again",
        act: () => this.toolbar.toggleTool("push"),
      },
      { keys: ["t"], help: "Trails of none, the picked, all bodies", act: () => viewPanel.turnTrails() },
      {
        keys: digits,
        help: "Goes to a kept viewpoint",
        act: (key) => this.moved(() => viewPanel.recall(place(key))),
      },
      {
        keys: digits.map((key) => `Shift+${key}`),
        help: "Keeps the viewpoint",
        act: (key) => viewPanel.save(place(key)),
      },
      { keys: ["o"], help: "Shows or hides plots", act: () => this.togglePlots() },
      { keys: ["s"], help: "Saves a picture", act: () => this.savePicture() },
      { keys: ["Shift+s"], help: "Begins or ends a film", act: () => this.toggleRecord() },
      { keys: ["Shift+e"], help: "Shows or hides the scene's panel", act: () => this.toggleSide("left") },
      { keys: ["Shift+i"], help: "Shows or hides the panel of bodies", act: () => this.toggleSide("right") },
      { keys: ["l"], help: "Light, dark, or as the system says", act: () => this.turnTheme() },
      { keys: ["?"], help: "This help", act: () => this.help.showModal() },
      { keys: ["Escape"], help: "Picks nothing; lets tools go", act: () => this.escape() },
    ];
  }

  private escape(): void {
    this.selection.now = null;
    this.notice.clear();
    this.toolbar.tool = "look";
  }
}

/** Right and up of an arrow key. */
function direction(key: string): [number, number] {
  return [
    key.endsWith("Right") ? 1 : key.endsWith("Left") ? -1 : 0,
    key.endsWith("Up") ? 1 : key.endsWith("Down") ? -1 : 0,
  ];
}
