import { Color } from "three";
import type { Notice } from "../notice";
import type { Selection } from "../selection";
import { h, Select } from "../ui/dom";
import { short } from "../ui/format";
import { SKIN_FILES, skinOfFile } from "../view/skins/files";
import { GAUGES, type Gauge, type GaugeName, SCALE } from "../view/skins/gauges";
import type { Skin } from "../view/skins/skin";
import type { View } from "../view/view";

type Choice = "plain" | "replica" | "color" | GaugeName | "file";
const CHOICES: [Choice, string][] = [
  ["plain", "Its own colours"],
  ["color", "One colour"],
  ["replica", "By replica"],
  ["speed", "By speed"],
  ["spin", "By spin"],
  ["force", "By contact force"],
  ["height", "By height"],
  ["file", "Picture or model…"],
];

/** The scale of one gauge. */
class Scale {
  private readonly ends = [h("span"), h("span")];
  readonly element = h(
    "div",
    { class: "scale" },
    h("div", { class: "ramp", style: `background:${SCALE}` }),
    ...this.ends,
  );

  constructor(private readonly name: GaugeName) {}

  show([low, high]: readonly number[]): void {
    const { label, unit } = GAUGES[this.name];
    this.ends[0].textContent = `${label} ${short(low, 2)}`;
    this.ends[1].textContent = `${short(high, 2)} ${unit}`;
  }
}

/** What the picked body wears, or all of them where none is picked. */
export class Skins {
  readonly element: HTMLElement;
  /** The scales of colours that follow a state, for a corner of the picture. */
  readonly legend = h("div", { class: "scales", hidden: true });
  private readonly scales = new Map<GaugeName, Scale>();
  private readonly kind: Select<Choice>;
  private readonly color = h("input", { type: "color", value: "#4c8dd6", "aria-label": "Colour" });
  private readonly file = h("input", { type: "file", accept: SKIN_FILES, hidden: true });
  private readonly size: Select<boolean>;
  private readonly who = h("span", { class: "muted" });

  constructor(
    private readonly view: View,
    private readonly selection: Selection,
    private readonly notice: Notice,
  ) {
    this.kind = new Select("Skin", "What it looks like. The physics stays.", CHOICES, (choice) =>
      this.choose(choice),
    );
    const sizes: [boolean, string][] = [
      [true, "Fitted to the body"],
      [false, "As in the file"],
    ];
    this.size = new Select("Size of the model", "How large a model is drawn.", sizes, (fitted) =>
      this.resize(fitted),
    );
    this.color.addEventListener("input", () =>
      this.dress({ kind: "color", color: new Color(this.color.value) }),
    );
    this.file.addEventListener("change", () => {
      const [file] = this.file.files ?? [];
      if (file) this.wear(file);
      this.file.value = "";
    });
    this.element = h(
      "div",
      { class: "skins" },
      h("div", { class: "bar" }, this.who),
      h("div", { class: "bar" }, this.kind.element, this.color, this.size.element),
      this.file,
      h("p", { class: "muted" }, "A GLB model or a picture can also be dropped on a body."),
    );
    selection.on("change", () => this.show());
    view.on("dressed", () => this.show());
    this.show();
  }

  /** Reads the scales of what is drawn. */
  readScales(): void {
    const gauges = this.view.current?.gauges ?? new Map<GaugeName, Gauge>();
    this.legend.hidden = gauges.size === 0;
    for (const [name, scale] of this.scales) {
      if (gauges.has(name)) continue;
      scale.element.remove();
      this.scales.delete(name);
    }
    for (const [name, { range }] of gauges) {
      const scale = this.scales.get(name) ?? new Scale(name);
      if (!this.scales.has(name)) this.legend.append(scale.element);
      this.scales.set(name, scale);
      scale.show(range);
    }
  }

  /** Dresses the picked body with a file. */
  async wear(file: File, body = this.selection.now?.body): Promise<void> {
    try {
      this.dress(await skinOfFile(file), body);
    } catch (error) {
      this.notice.tell((error as Error).message);
    }
  }

  private choose(choice: Choice): void {
    switch (choice) {
      case "file":
        this.file.click();
        break;
      case "color":
        this.dress({ kind: "color", color: new Color(this.color.value) });
        break;
      case "plain":
      case "replica":
        this.dress({ kind: choice });
        break;
      default:
        this.dress({ kind: "gauge", gauge: choice });
    }
  }

  private dress(skin: Skin, body = this.selection.now?.body): void {
    this.view.wear([{ bodies: body === undefined || body < 0 ? null : [body], skin }]);
  }

  private resize(fitted: boolean): void {
    const skin = this.skin();
    if (skin.kind === "model") this.dress({ ...skin, fitted });
  }

  private skin(): Skin {
    const body = this.selection.now?.body;
    return body === undefined ? this.view.wardrobe.common : this.view.wardrobe.of(body);
  }

  private show(): void {
    const skin = this.skin();
    const body = this.selection.now?.body;
    const name = body === undefined ? null : this.view.current?.scene.bodies[body]?.name;
    this.who.textContent = name === null ? "Of all bodies" : `Of ${name || "the picked body"}`;
    this.kind.value =
      skin.kind === "gauge"
        ? skin.gauge
        : skin.kind === "picture" || skin.kind === "model"
          ? "file"
          : skin.kind;
    this.color.hidden = skin.kind !== "color";
    this.size.element.hidden = skin.kind !== "model";
    if (skin.kind === "model") this.size.value = skin.fitted;
    if (skin.kind === "color") this.color.value = `#${skin.color.getHexString()}`;
  }
}
