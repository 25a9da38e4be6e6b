import { type Files, ROBOT_FILES } from "../files";
import type { Session } from "../session";
import type { Share } from "../share";
import { button, h } from "../ui/dom";

/** What can be opened: examples, and robots of files. */
export class Gallery {
  readonly element: HTMLElement;
  /** Files that are listed. */
  private shown = new Set<string>();
  private readonly list = h("ul", { class: "gallery", "aria-label": "Examples" });

  constructor(
    private readonly session: Session,
    private readonly share: Share,
    files: Files,
  ) {
    const input = h("input", { type: "file", accept: ROBOT_FILES, hidden: true });
    input.addEventListener("change", () => {
      const [file] = input.files ?? [];
      if (file) files.open(file);
      input.value = "";
    });
    const help = "A robot in MJCF or URDF, without meshes of its own. It can also be dropped on the page.";
    const choose = button("Open a robot file…", help, () => input.click());
    this.element = h("div", {}, this.list, h("div", { class: "bar" }, choose, input));
    session.on("examples", () => this.show());
    session.on("scene", ({ name }) => {
      if (share.files.has(name) && !this.shown.has(name)) this.show();
      else this.mark();
    });
  }

  private show(): void {
    const { examples } = this.session;
    const files = [...this.share.files.values()];
    this.shown = new Set(files.map(({ name }) => name));
    this.list.replaceChildren(
      ...examples.map(({ name, title, about }) =>
        entry(name, title, about, () => this.share.openExample(name)),
      ),
      ...files.map((file) => entry(file.name, file.name, "Your file.", () => this.share.openFile(file))),
    );
    this.element.hidden = examples.length === 0;
    this.mark();
  }

  private mark(): void {
    for (const item of this.list.querySelectorAll<HTMLElement>(".example")) {
      const current = item.dataset.name === this.session.scene?.name;
      item.setAttribute("aria-current", String(current));
      // Not scrollIntoView, which would scroll the panel, too.
      if (current) this.list.scrollTop = item.offsetTop - this.list.clientHeight / 2;
    }
  }
}

function entry(name: string, title: string, about: string, open: () => void): HTMLElement {
  const attributes = { type: "button", class: "example", "data-name": name, onclick: open };
  return h("li", {}, h("button", attributes, h("strong", {}, title), h("span", {}, about)));
}
