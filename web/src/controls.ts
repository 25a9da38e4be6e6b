import type { Command, Values } from "./protocol";
import type { Session } from "./session";

/** What one can do to the simulation, whichever button, key or slider asks for it. */
export class Controls {
  private readonly waiting = new Map<string, Command>();

  constructor(private readonly session: Session) {}

  run(): void {
    this.session.send({ type: "run" });
  }

  stop(): void {
    this.session.send({ type: "stop" });
  }

  toggle(): void {
    if (this.session.running) this.stop();
    else this.run();
  }

  step(steps: number): void {
    this.session.send({ type: "step", steps });
  }

  restart(): void {
    this.session.send({ type: "restart" });
  }

  open(example: string, build: Values = {}, physics: Values = {}): void {
    this.session.send({ type: "open", example, build, physics });
  }

  rebuild(build: Values): void {
    this.session.send({ type: "rebuild", build });
  }

  physics(values: Values): void {
    this.session.send({ type: "physics", values });
  }

  speed(factor: number | null): void {
    this.session.send({ type: "speed", factor });
  }

  /** Shows so many worlds from `first`, as far as there are. */
  show(first: number, count: number): void {
    const worlds = this.session.scene?.worlds ?? 0;
    const shown = Math.min(count, worlds);
    const start = Math.max(0, Math.min(first, worlds - shown));
    this.session.send({ type: "show", worlds: Array.from({ length: shown }, (_, i) => start + i) });
  }

  /** Goes on to the replicas after those shown, or back. */
  leaf(by: 1 | -1): void {
    const { shown } = this.session;
    if (shown.length) this.show(shown[0] + by * shown.length, shown.length);
  }

  scrub(time: number): void {
    this.soon("scrub", { type: "scrub", time });
  }

  /** Sends what follows a pointer: the last command of a kind before the next picture. */
  soon(kind: string, command: Command): void {
    if (this.waiting.size === 0) requestAnimationFrame(() => this.flush());
    this.waiting.set(kind, command);
  }

  /** Sends at once what waits. */
  flush(): void {
    for (const command of this.waiting.values()) this.session.send(command);
    this.waiting.clear();
  }
}
