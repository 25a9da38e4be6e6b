import { Capture } from "./capture";
import { Connection } from "./connection";
import { Controls } from "./controls";
import { Files } from "./files";
import { Grabbing } from "./grabbing";
import { keys } from "./keys";
import { Navigation } from "./navigation";
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
import { Toolbar } from "./panels/toolbar";
import { ViewPanel } from "./panels/view_panel";
import { Pointing } from "./pointing";
import { Pushing } from "./pushing";
import { Selection } from "./selection";
import type { Session } from "./session";
import { Share } from "./share";
import { Shell } from "./shell";
import { Shortcuts } from "./shortcuts";
import { Themes } from "./theme";
import { h } from "./ui/dom";
import { showTooltips } from "./ui/tooltip";
import { Dresser } from "./view/skins/dresser";
import { View } from "./view/view";

const LOST = "The browser has taken the graphics card away; the picture comes back with it.";

/** The page of a session: makes its parts, joins them, and draws. */
export class Page {
  readonly notice = new Notice();
  readonly connection: Connection;
  readonly themes = new Themes();
  readonly controls: Controls;
  readonly selection: Selection;
  readonly view: View;
  readonly share: Share;
  readonly navigation: Navigation;
  readonly pushing: Pushing;
  readonly skins: Skins;
  readonly grabbing: Grabbing;
  readonly pointing: Pointing;
  readonly files: Files;
  readonly capture: Capture;
  readonly viewPanel: ViewPanel;
  readonly build: Build;
  readonly timeline: Timeline;
  readonly plots: Plots;
  readonly shell: Shell;

  constructor(readonly session: Session) {
    const label = "The scene. Arrow keys turn the view.";
    const canvas = h("canvas", { class: "stage", tabindex: 0, role: "application", "aria-label": label });
    this.controls = new Controls(session);
    this.selection = new Selection(session);
    // Who hears of a scene after the view may move the camera in it.
    this.view = new View(canvas, session);
    this.share = new Share(session, this.controls, this.view, this.notice);
    this.connection = new Connection(session, this.share);
    this.navigation = new Navigation(this.view, this.share, this.selection);
    this.pushing = new Pushing(session, this.selection, this.view);
    this.skins = new Skins(this.view, this.selection, this.notice);
    new Dresser(session, (worn) => this.view.wear(worn));
    this.grabbing = new Grabbing(session, this.controls, this.view, this.notice);
    this.pointing = new Pointing(this.view, this.navigation, this.selection, this.grabbing, this.pushing);
    this.files = new Files(this.share, this.view, this.selection, this.skins, this.notice);
    this.capture = new Capture(session, this.view, this.notice);
    this.viewPanel = new ViewPanel(session, this.view, this.navigation);
    this.build = new Build(session, this.controls);
    this.timeline = new Timeline(session, this.controls);
    this.plots = new Plots(session, this.notice);
    const shortcuts = new Shortcuts(keys(this), canvas);
    const toolbar = new Toolbar(this, () => this.shell);
    this.shell = new Shell({
      toolbar: toolbar.element,
      ...this.panels(),
      canvas,
      over: [this.viewPanel.inset, this.skins.legend, this.connection.element, this.notice.element],
      plots: this.plots.element,
      timeline: this.timeline.element,
      help: helpDialog(shortcuts),
    });
    this.join();
    toolbar.shown(this.shell.shown);
    this.shell.on("shown", (shown) => toolbar.shown(shown));
    showTooltips();
    requestAnimationFrame((now) => this.draw(now, now));
  }

  private panels() {
    const { session, controls, share } = this;
    return {
      left: {
        Examples: new Gallery(session, share, this.files).element,
        Guide: new Guide(session).element,
        Build: this.build.element,
        Physics: new Physics(session, share).element,
      },
      right: {
        Body: new BodyPanel(session, this.selection, this.pushing, this.navigation, this.view).element,
        "Joints and actuators": new Drives(session, controls).element,
        View: this.viewPanel.element,
        Skin: this.skins.element,
      },
    };
  }

  /** What one part hears of another. */
  private join(): void {
    const { session, selection, view, notice, themes, plots } = this;
    const mark = () => {
      view.pick = selection.drawn;
    };
    selection.on("change", mark);
    selection.on("change", (selected) => {
      const body = selected && session.scene?.bodies[selected.body];
      notice.say(body ? `Picked: ${body.name || `body ${selected.body}`}` : "");
    });
    session.on("shown", mark);
    session.on("scene", ({ title }) => {
      document.title = `${title} – Kinetarium`;
    });
    session.on("error", (reason) => notice.tell(reason));
    const { canvas } = view.stage;
    canvas.addEventListener("webglcontextlost", () => notice.tell(LOST));
    canvas.addEventListener("webglcontextrestored", () => {
      view.invalidate();
      notice.clear(LOST);
    });
    const dress = () => {
      view.theme = themes.now;
      plots.invalidate();
    };
    themes.on("change", dress);
    dress();
    this.shell.on("shown", () => plots.invalidate());
  }

  /** Draws what changed, again and again. */
  private draw(now: number, before: number): void {
    requestAnimationFrame((next) => this.draw(next, now));
    if (this.capture.filming) this.view.invalidate();
    if (this.view.draw(Math.min((now - before) / 1000, 0.1))) {
      this.skins.readScales();
      this.session.drawn();
    }
    this.plots.draw();
  }
}
