import { Emitter } from "./emitter";
import type { Session } from "./session";
import type { Share } from "./share";
import { h } from "./ui/dom";

const TEXTS = {
  loading: "The engine is loading…",
  away: "The engine is away; the page goes on when it is back.",
  here: "",
};

type State = keyof typeof TEXTS;

/** Whether the engine is there, and a line over the picture where it is not. */
export class Connection extends Emitter<{ here: boolean }> {
  /** Is always there, so that screen readers hear what comes to be in it. */
  readonly element = h("div", { role: "status" });
  private state: State = "loading";

  constructor(session: Session, share: Share) {
    super();
    this.show("loading");
    // A scene that gives way to that of the page's address is not shown to the panels' readers.
    const greet = () => {
      if (session.scene && !share.awaits) this.show("here");
    };
    session.on("scene", greet);
    session.on("connected", (connected) => {
      if (connected) greet();
      else this.show("away");
    });
    session.on("error", () => {
      // Why it does not load is told.
      if (!session.scene) this.element.replaceChildren();
      else if (this.state === "loading") greet();
    });
  }

  private show(state: State): void {
    this.state = state;
    // The panels have nothing to show before the first scene.
    document.body.dataset.engine = state;
    const line = h("p", { class: `connection ${state}` }, TEXTS[state]);
    this.element.replaceChildren(...(TEXTS[state] ? [line] : []));
    this.emit("here", state === "here");
  }
}
