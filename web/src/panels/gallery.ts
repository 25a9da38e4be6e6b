import type { Session } from "../session";
import type { Share } from "../share";
import { h } from "../ui/dom";

/** What can be opened. */
export class Gallery {
  readonly element = h("ul", { class: "gallery", "aria-label": "Examples" });

  constructor(
    private readonly session: Session,
    private readonly share: Share,
  ) {
    session.on("examples", () => this.show());
    session.on("scene", () => this.mark());
  }

  private show(): void {
    const items = this.session.examples.map(({ name, title, about }) =>
      h(
        "li",
        {},
        h(
          "button",
          {
            type: "button",
            class: "example",
            "data-name": name,
            onclick: () => this.share.openExample(name),
          },
          h("strong", {}, title),
          h("span", {}, about),
        ),
      ),
    );
    this.element.replaceChildren(...items);
    this.element.hidden = items.length === 0;
    this.mark();
  }

  private mark(): void {
    for (const item of this.element.querySelectorAll<HTMLElement>(".example")) {
      const current = item.dataset.name === this.session.scene?.name;
      item.setAttribute("aria-current", String(current));
      // Not scrollIntoView, which would scroll the panel, too.
      if (current) this.element.scrollTop = item.offsetTop - this.element.clientHeight / 2;
    }
  }
}
