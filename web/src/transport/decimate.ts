import { withSamples } from "../frame";

/**
 * Passes frames on one at a time, as fast as they are drawn. One that comes while another is being drawn
 * waits, and is dropped for a newer one: a slow page sees fewer frames, none late, and always the last.
 * What was sampled for plots it sees all.
 */
export class Decimator {
  private free = true;
  private waiting: ArrayBuffer | null = null;

  constructor(private readonly pass: (frame: ArrayBuffer) => void) {}

  offer(frame: ArrayBuffer): void {
    if (this.free) {
      this.free = false;
      this.pass(frame);
    } else {
      this.waiting = this.waiting ? withSamples(this.waiting, frame) : frame;
    }
  }

  /** The frame passed on was drawn. */
  drawn(): void {
    const frame = this.waiting;
    this.waiting = null;
    this.free = frame === null;
    if (frame) this.pass(frame);
  }
}
