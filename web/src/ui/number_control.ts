import { h, identity } from "./dom";
import { fromShare, type Scale, toShare, written } from "./scale";

/** What a {@link NumberControl} is of. */
export interface NumberSpec {
  label: string;
  unit: string;
  help: string;
  scale: Scale;
}

/** Places of the slider. */
const PLACES = 1000;

/** A number as a slider and as digits, which may go beyond the slider unless it is `strict`. */
export class NumberControl {
  readonly element: HTMLElement;
  private readonly slider: HTMLInputElement;
  private readonly digits: HTMLInputElement;
  private current = 0;

  /** `input` is told while the slider moves, `change` when it comes to rest or digits are entered. */
  constructor(
    private readonly spec: NumberSpec,
    strict: boolean,
    private readonly told: { input?: (value: number) => void; change?: (value: number) => void },
  ) {
    const { scale, label, unit, help } = spec;
    const name = identity();
    this.slider = h("input", {
      type: "range",
      min: 0,
      max: scale.integer && !scale.logarithmic ? Math.min(scale.max - scale.min, PLACES) : PLACES,
      "aria-label": label,
      oninput: () => this.slide("input"),
      onchange: () => this.slide("change"),
    });
    this.digits = h("input", {
      type: "number",
      id: name,
      step: "any",
      min: strict ? scale.min : undefined,
      max: strict ? scale.max : undefined,
      onchange: () => this.enter(),
      // What was not taken does not stay.
      onblur: () => this.write(),
    });
    this.element = h(
      "div",
      { class: "number", "data-help": help },
      h("label", { for: name }, label),
      this.digits,
      h("span", { class: "unit" }, unit),
      this.slider,
    );
  }

  set value(value: number) {
    this.current = value;
    this.slider.value = String(Math.round(toShare(this.spec.scale, value) * Number(this.slider.max)));
    this.write();
  }

  private write(): void {
    const digits = written(this.spec.scale, this.current);
    this.digits.value = digits;
    // The slider's own value is a place.
    this.slider.ariaValueText = `${digits} ${this.spec.unit}`.trim();
  }

  private slide(kind: "input" | "change"): void {
    this.current = fromShare(this.spec.scale, Number(this.slider.value) / Number(this.slider.max));
    this.write();
    this.told[kind]?.(this.current);
  }

  private enter(): void {
    const entered = this.digits.valueAsNumber;
    if (!this.digits.checkValidity() || !Number.isFinite(entered)) {
      this.digits.reportValidity();
      return;
    }
    const value = this.spec.scale.integer ? Math.round(entered) : entered;
    this.value = value;
    this.told.input?.(value);
    this.told.change?.(value);
  }
}
