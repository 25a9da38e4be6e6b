import type { Frame } from "./frame";
import { Page } from "./page";
import type { Scene, Status } from "./protocol";
import { Session } from "./session";
import "./style.css";
import { connect } from "./transport/connect";
import { h } from "./ui/dom";
import { NoWebGL } from "./view/stage";

declare global {
  interface Window {
    /** What the page knows last, for tests and the curious. */
    readonly kinetarium: Readonly<{
      scene: Scene | null;
      status: Status | null;
      frame: Frame | null;
      shown: number[];
    }>;
  }
}

const session = new Session(connect);
try {
  new Page(session);
} catch (error) {
  if (!(error instanceof NoWebGL)) throw error;
  session.close();
  const text =
    "This page draws with WebGL 2, which this browser does not have or has turned off: turn on hardware acceleration in its settings, or take another browser.";
  document.body.replaceChildren(h("p", { class: "broken", role: "alert" }, text));
}
Object.defineProperty(window, "kinetarium", {
  get: () => ({ scene: session.scene, status: session.status, frame: session.frame, shown: session.shown }),
});
