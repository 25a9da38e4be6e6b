import type { Frame } from "./frame";
import { Page } from "./page";
import type { Scene, Status } from "./protocol";
import { Session } from "./session";
import "./style.css";
import { connect } from "./transport/connect";

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
new Page(session);
Object.defineProperty(window, "kinetarium", {
  get: () => ({ scene: session.scene, status: session.status, frame: session.frame, shown: session.shown }),
});
