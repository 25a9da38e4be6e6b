import { Capture } from "./capture";
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
import { listen } from "./shortcuts";
import { Themes } from "./theme";
import { h } from "./ui/dom";
import { showTooltips } from "./ui/tooltip";
import { View } from "./view/view";

const AWAY = "The engine is away; the page goes on when it is back.";

/** The page of a session: makes its parts, joins them, and draws. */
export class Page {
  readonly notice = new Notice();
  readonly themes = new Themes();
  readonly controls: Controls;
  readonly selection: Selection;
  readonly view: View;
  readonly share: Share;
  readonly navigation: Navigation;
  readonly pushing: Pushing;
  readonly skins: Skins;
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
    this.navigation = new Navigation(this.view, this.share, this.selection);
    this.pushing = new Pushing(session, this.selection, this.view);
    this.skins = new Skins(this.view, this.selection, this.notice);
    const grabbing = new Grabbing(session, this.controls, this.view);
    this.pointing = new Pointing(this.view, this.navigation, this.selection, grabbing, this.pushing);
    this.files = new Files(session, this.view, this.selection, this.skins, this.notice);
    this.capture = new Capture(session, this.view, this.notice);
    this.viewPanel = new ViewPanel(session, this.view, this.navigation);
    this.build = new Build(session, this.controls);
    this.timeline = new Timeline(session, this.controls);
    this.plots = new Plots(session);
    const shortcuts = keys(this);
    const toolbar = new Toolbar(this, () => this.shell);
    this.shell = new Shell({
      toolbar: toolbar.element,
      ...this.panels(),
      canvas,
      over: [this.viewPanel.inset, this.skins.legend, this.notice.element],
      plots: this.plots.element,
      timeline: this.timeline.element,
      help: helpDialog(shortcuts),
    });
    this.join();
    toolbar.shown(this.shell.shown);
    this.shell.on("shown", (shown) => toolbar.shown(shown));
    listen(shortcuts);
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
        Body: new BodyPanel(session, this.selection, this.pushing, this.navigation).element,
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
    session.on("shown", mark);
    session.on("scene", ({ title }) => {
      document.title = `${title} – Kinetarium`;
    });
    session.on("error", (reason) => notice.tell(reason));
    session.on("connected", (connected) => {
      if (connected) notice.clear(AWAY);
      // The engine's last words say more.
      else if (!notice.shown) notice.tell(AWAY);
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
    if (this.view.draw(Math.min((now - before) / 1000, 0.1))) {
      this.skins.readScale();
      this.session.drawn();
    }
    this.plots.draw();
  }
}
