import { App } from "./app";
import type { Frame } from "./frame";
import type { Scene, Status } from "./protocol";
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

const { session } = new App(connect);
Object.defineProperty(window, "kinetarium", {
  get: () => ({ scene: session.scene, status: session.status, frame: session.frame, shown: session.shown }),
});
