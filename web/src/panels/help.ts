import { keyName, type Shortcut } from "../shortcuts";
import { h } from "../ui/dom";

const POINTER: [string, string][] = [
  ["Drag", "Turns the view; one finger does, too."],
  ["Shift+drag", "Moves the view; so do the right button and two fingers."],
  ["Wheel, pinch", "Comes closer, or goes away."],
  ["Click", "Picks a body."],
  ["Ctrl+drag", "Drags a body by a spring; a finger does with the tool Grab."],
  ["Drop a file", "Opens a robot (MJCF, URDF); dresses a body in a picture or a GLB model."],
];

/** Keys and mouse, in a dialog. */
export function helpDialog(shortcuts: Shortcut[]): HTMLDialogElement {
  const keys = shortcuts.map(({ keys, help }): [string, string] => [describe(keys), help]);
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
