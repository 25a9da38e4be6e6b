import type { Field } from "../protocol";
import { Checkbox, h, Select } from "./dom";
import { NumberControl } from "./number_control";
import { ranged } from "./units";

interface Row {
  element: HTMLElement;
  set(value: number): void;
}

/** A form of an engine's fields. Its rows stay while the fields do, so that what is held is not lost. */
export class FieldForm {
  readonly element = h("div", { class: "form" });
  private rows = new Map<string, Row>();
  private kinds = "";

  /** `changed` is told of each value that the user sets. */
  constructor(private readonly changed: (name: string, value: number) => void) {}

  show(fields: Field[]): void {
    const kinds = JSON.stringify(fields.map(({ value: _, ...kind }) => kind));
    if (kinds !== this.kinds) {
      this.kinds = kinds;
      this.rows = new Map(fields.map((field) => [field.name, noted(field, this.row(field))]));
      this.element.replaceChildren(...[...this.rows.values()].map((row) => row.element));
    }
    for (const { name, value } of fields) this.rows.get(name)?.set(value);
  }

  private row(field: Field): Row {
    const { name, label, help, unit, kind } = field;
    const change = (value: number) => this.changed(name, value);
    switch (kind.kind) {
      case "flag": {
        const box = new Checkbox(label, help, (on) => change(on ? 1 : 0));
        return {
          element: box.element,
          set: (value) => {
            box.on = value !== 0;
          },
        };
      }
      case "choice": {
        const options = kind.names.map((text, row): [number, string] => [row, text]);
        const select = new Select(label, help, options, change);
        return {
          element: h("label", { class: "choice", "data-help": help }, h("span", {}, label), select.element),
          set: (value) => {
            select.value = value;
          },
        };
      }
      default: {
        const integer = kind.kind === "integer";
        const scale = { min: kind.min, max: kind.max, integer, logarithmic: !integer && kind.logarithmic };
        const spec = { label, unit, help: `${help} ${ranged([kind.min, kind.max], unit, true)}`, scale };
        const control = new NumberControl(spec, true, { change });
        return {
          element: control.element,
          set: (value) => {
            control.value = value;
          },
        };
      }
    }
  }
}

/** A row with the field's note below it, if it has one. */
function noted({ note }: Field, row: Row): Row {
  if (note === undefined) return row;
  const element = h("div", {}, row.element, h("p", { class: "note" }, note));
  return { element, set: (value) => row.set(value) };
}
