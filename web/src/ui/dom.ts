type Child = Node | string | null | undefined;
type Attributes = Record<string, string | number | boolean | undefined | ((event: never) => void)>;

/**
 * Makes an element. Attributes whose names begin with `on` are listeners; `false` and undefined leave an
 * attribute out, `true` writes it without a value.
 */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name.slice(2), value as EventListener);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== undefined) element.setAttribute(name, String(value));
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

let identities = 0;
/** A name for an element that no other has. */
export function identity(): string {
  identities += 1;
  return `k${identities}`;
}

/** A section of a side panel that folds. */
export function section(title: string, open: boolean, ...children: Child[]): HTMLDetailsElement {
  return h(
    "details",
    { open, class: "section" },
    h("summary", {}, title),
    h("div", { class: "content" }, ...children),
  );
}

export function button(label: string, help: string, act: () => void, icon?: Node): HTMLButtonElement {
  return h(
    "button",
    { type: "button", "data-help": help, onclick: act, "aria-label": icon && label },
    icon ?? label,
  );
}

/** A choice of several values. */
export class Select<T> {
  readonly element: HTMLSelectElement;
  private options: [value: T, label: string][] = [];

  constructor(label: string, help: string, options: [T, string][], change: (value: T) => void) {
    this.element = h("select", {
      "aria-label": label,
      "data-help": help,
      onchange: () => change(this.options[this.element.selectedIndex][0]),
    });
    this.setOptions(options);
  }

  setOptions(options: [T, string][]): void {
    if (JSON.stringify(options) === JSON.stringify(this.options)) return;
    this.options = options;
    this.element.replaceChildren(...options.map(([, label]) => h("option", {}, label)));
  }

  set value(value: T) {
    this.element.selectedIndex = this.options.findIndex(([other]) => other === value);
  }
}

/** A box to tick, with its label. */
export class Checkbox {
  readonly element: HTMLElement;
  private readonly input: HTMLInputElement;

  constructor(label: string, help: string, change: (on: boolean) => void) {
    this.input = h("input", { type: "checkbox", onchange: () => change(this.input.checked) });
    this.element = h("label", { class: "check", "data-help": help }, this.input, h("span", {}, label));
  }

  set on(on: boolean) {
    this.input.checked = on;
  }
}
