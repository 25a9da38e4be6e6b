/** A key, what it does, and how it is called in the help. */
export interface Shortcut {
  /** As `KeyboardEvent.key`; letters match whatever the case, `Shift+` tells them apart. */
  keys: string[];
  help: string;
  act: (key: string, event: KeyboardEvent) => void;
}

/** How keys are written for people. */
const NAMES: Record<string, string> = {
  " ": "Space",
  Escape: "Esc",
  ArrowLeft: "←",
  ArrowRight: "→",
  ArrowUp: "↑",
  ArrowDown: "↓",
};

export function keyName(key: string): string {
  return key.replace(/[^+]+$/, (last) => NAMES[last] ?? (last.length === 1 ? last.toUpperCase() : last));
}

/** The name of the key of an event, as {@link Shortcut.keys} has it. */
export function keyOf(event: Pick<KeyboardEvent, "key" | "code" | "shiftKey">): string {
  // A shifted digit is another sign on most keyboards.
  if (event.shiftKey && /^Digit\d$/.test(event.code)) return `Shift+${event.code.slice(5)}`;
  // The plus sign without the shift that most keyboards want for it.
  if (event.key === "=") return "+";
  const letter = event.key.length === 1 && event.key.toLowerCase() !== event.key.toUpperCase();
  const name = letter ? event.key.toLowerCase() : event.key;
  return event.shiftKey && (letter || event.key.startsWith("Arrow")) ? `Shift+${name}` : name;
}

/** Listens to the keys of the page, except where an element needs them itself. */
export function listen(shortcuts: Shortcut[]): void {
  const acts = new Map(
    shortcuts.flatMap((shortcut) => shortcut.keys.map((key) => [key, shortcut.act] as const)),
  );
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const key = keyOf(event);
    if (needsItself(event.target as Element, key)) return;
    const act = acts.get(key);
    if (!act) return;
    event.preventDefault();
    act(key, event);
  });
}

function needsItself(element: Element, key: string): boolean {
  if (document.querySelector("dialog[open]")) return true;
  if (key === "Escape") return false;
  if (element.matches("input[type=checkbox], button, summary")) return key === " " || key === "Enter";
  if (element.matches("input[type=range]")) return key.includes("Arrow") || key === " ";
  return element.matches("input, select, textarea");
}
