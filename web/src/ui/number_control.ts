import { h, identity } from "./dom";
import { fromShare, places, type Scale, toShare, written } from "./scale";

/** What a {@link NumberControl} is of. */
export interface NumberSpec {
  label: string;
  unit: string;
  help: string;
  scale: Scale;
}

/** A number as a slider and as digits, which may go beyond the slider unless it is `strict`. */
export class NumberControl {
  readonly element: HTMLElement;
  private readonly slider: HTMLInputElement;
  private readonly digits: HTMLInputElement;
  private current = 0;
  /** Digits that are being typed do not change meanwhile, nor does a slider that is dragged. */
  private typing = false;
  private dragging = false;

  /** `input` is told while the slider moves, `change` when it comes to rest or digits are entered. */
  constructor(
    private readonly spec: NumberSpec,
    private readonly strict: boolean,
    private readonly told: { input?: (value: number) => void; change?: (value: number) => void },
  ) {
    const { label, unit, help } = spec;
    const name = identity();
    this.slider = this.makeSlider();
    this.digits = h("input", {
      type: "number",
      id: name,
      step: "any",
      onchange: () => this.enter(),
      onfocus: () => {
        this.typing = true;
      },
      oninput: () => {
        this.typing = true;
      },
      // What was not taken does not stay.
      onblur: () => {
        this.typing = false;
        this.write();
      },
    });
    this.element = h(
      "div",
      { class: "number", "data-help": help },
      h("label", { for: name }, label),
      this.digits,
      h("span", { class: "unit" }, unit),
      this.slider,
    );
    this.scale = spec.scale;
  }

  /** How far the slider goes. */
  set scale(scale: Scale) {
    this.spec.scale = scale;
    this.slider.max = String(places(scale));
    if (this.strict) [this.digits.min, this.digits.max] = [String(scale.min), String(scale.max)];
    this.write();
  }

  set value(value: number) {
    if (this.dragging) return;
    this.current = value;
    this.write();
  }

  set disabled(disabled: boolean) {
    this.slider.disabled = this.digits.disabled = disabled;
  }

  private makeSlider(): HTMLInputElement {
    const letGo = () => {
      this.dragging = false;
    };
    return h("input", {
      type: "range",
      min: 0,
      "aria-label": this.spec.label,
      oninput: () => this.slide("input"),
      onchange: () => this.slide("change"),
      onpointerdown: () => {
        this.dragging = true;
      },
      onpointerup: letGo,
      onpointercancel: letGo,
      onlostpointercapture: letGo,
    });
  }

  private write(): void {
    const { scale, unit } = this.spec;
    const digits = written(scale, this.current);
    if (!this.typing) this.digits.value = digits;
    this.slider.value = String(Math.round(toShare(scale, this.current) * Number(this.slider.max)));
    // The slider's own value is a place.
    this.slider.ariaValueText = `${digits} ${unit}`.trim();
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
    this.typing = false;
    this.value = this.spec.scale.integer ? Math.round(entered) : entered;
    this.told.input?.(this.current);
    this.told.change?.(this.current);
  }
}
