import { keyName, type Shortcuts } from "../shortcuts";
import { Checkbox, h } from "../ui/dom";

const POINTER: [string, string][] = [
  ["Drag", "Turns the view; one finger does, too."],
  ["Shift+drag", "Moves the view; so do the right button and two fingers."],
  ["Wheel, pinch", "Comes closer, or goes away; within another page with Ctrl, or after a click."],
  ["Click", "Picks a body."],
  ["Ctrl+drag", "Drags a body by a spring; a finger does with the tool Grab."],
  ["Drop a file", "Opens a robot (MJCF, URDF); dresses a body in a picture or a GLB model."],
];

/** Keys and mouse, in a dialog. */
export function helpDialog(shortcuts: Shortcuts): HTMLDialogElement {
  const anywhere = new Checkbox("Letters, digits and signs act anywhere on the page", "", (on) => {
    shortcuts.anywhere = on;
  });
  anywhere.on = shortcuts.anywhere;
  const keys = shortcuts.list.map(({ keys, help }): [string, string] => [describe(keys), help]);
  const table = (title: string, rows: [string, string][]) =>
    h(
      "section",
      {},
      h("h3", {}, title),
      h(
        "dl",
        { class: "keys" },
        ...rows.flatMap(([key, help]) => [h("dt", {}, h("kbd", {}, key)), h("dd", {}, help)]),
      ),
    );
  const dialog = h(
    "dialog",
    { class: "help", "aria-label": "Help" },
    h(
      "form",
      { method: "dialog" },
      h("header", {}, h("h2", {}, "Keys and mouse"), h("button", { "aria-label": "Close" }, "×")),
      h("div", { class: "columns" }, table("Keys", keys), table("Mouse and touch", POINTER)),
      anywhere.element,
      h("p", { class: "muted" }, "Otherwise they do so only while the picture has the focus."),
    ),
  );
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
  return dialog;
}

/** `Shift+1 … 9` for many keys, `J  K` for a few. */
function describe(keys: string[]): string {
  const [, shift] = /^(Shift\+)?/.exec(keys[0]) ?? [];
  const names = keys.map((key) => keyName(shift ? key.slice(shift.length) : key));
  return (shift ?? "") + (names.length > 4 ? `${names[0]} … ${names[names.length - 1]}` : names.join("  "));
}
