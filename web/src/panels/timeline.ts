import type { Controls } from "../controls";
import type { Session } from "../session";
import { h } from "../ui/dom";
import { large, short } from "../ui/format";

/** Time within which the frame of a time that was asked for comes [ms]; until then the slider stays at it. */
const COMES = 500;

/** The recorded past to scrub through, and how it goes. */
export class Timeline {
  readonly element: HTMLElement;
  private readonly slider: HTMLInputElement;
  private readonly time = h("span", { class: "time", "data-help": "Simulated time since the start." });
  private readonly steps = h("span", { class: "steps", "data-help": "Time steps since the start." });
  private readonly pace = h("span", {
    class: "pace",
    "data-help": "Simulated seconds a second, and steps of all replicas a second of computing.",
  });
  private readonly diverged = h("output", { class: "diverged" });
  private held = false;
  private coming: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly session: Session,
    private readonly controls: Controls,
  ) {
    this.slider = h("input", {
      type: "range",
      min: 0,
      max: 0,
      value: 0,
      step: "any",
      "aria-label": "Time",
      "data-help": "Goes back to what was recorded. (comma and full stop: a hundredth of it)",
      onpointerdown: () => {
        this.held = true;
      },
      oninput: () => this.scrub(),
      onchange: () => {
        this.held = false;
      },
      onlostpointercapture: () => {
        this.held = false;
      },
      onpointerup: () => {
        this.held = false;
      },
    });
    this.element = h(
      "div",
      { class: "timeline" },
      this.time,
      this.steps,
      this.slider,
      this.diverged,
      this.pace,
    );
    session.on("status", () => this.show());
    session.on("frame", () => this.show());
  }

  /** Goes back or on by hundredths of what is recorded. */
  leap(hundredths: number): void {
    const { status } = this.session;
    if (!status) return;
    const [first, last] = status.recorded;
    // The slider knows what was asked for last.
    const time = this.slider.valueAsNumber + (hundredths / 100) * (last - first);
    this.slider.valueAsNumber = Math.min(Math.max(time, first), last);
    this.scrub();
  }

  /** Goes to where the slider is. */
  private scrub(): void {
    clearTimeout(this.coming);
    this.coming = setTimeout(() => {
      this.coming = undefined;
      this.show();
    }, COMES);
    this.controls.scrub(this.slider.valueAsNumber);
  }

  private show(): void {
    const { status, frame } = this.session;
    const time = frame?.time ?? status?.time ?? 0;
    this.time.textContent = this.slider.ariaValueText = `${time.toFixed(3)} s`;
    this.steps.textContent = `${frame?.steps ?? status?.steps ?? 0} steps`;
    if (!status) return;
    const [first, last] = status.recorded;
    this.slider.min = String(first);
    this.slider.max = String(Math.max(last, time));
    if (!this.held && this.coming === undefined) this.slider.value = String(time);
    const going = status.running || status.pace > 0;
    this.pace.textContent = going ? `${short(status.pace, 2)}× · ${large(status.rate)} steps/s` : "";
    this.diverged.textContent = status.diverged.length ? `${status.diverged.length} diverged` : "";
    this.diverged.dataset.help = `Replicas that left the finite numbers and stand still: ${status.diverged.join(", ")}`;
  }
}
