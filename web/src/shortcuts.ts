import { keep, recall } from "./store";

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

/** Whether a key writes something: a letter, a digit or a sign. */
export function isCharacter(key: string): boolean {
  const last = key.replace(/^Shift\+/, "");
  return last.length === 1 && last !== " ";
}

/** Listens to the keys of the page, except where an element needs them itself. */
export class Shortcuts {
  /** Whether letters, digits and signs act anywhere; else only where the picture has the focus. */
  private everywhere = recall("keys", true);
  /** What the keyboard has brought the focus to; a key pressed after a click makes that :focus-visible, too. */
  private reached: EventTarget | null = null;

  constructor(
    readonly list: Shortcut[],
    private readonly picture: Element,
  ) {
    const acts = new Map(
      list.flatMap((shortcut) => shortcut.keys.map((key) => [key, shortcut.act] as const)),
    );
    addEventListener("focusin", ({ target }) => {
      this.reached = (target as Element).matches(":focus-visible") ? target : null;
    });
    addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
      const key = keyOf(event);
      const target = event.target as Element;
      if (needsItself(target, key, target === this.reached)) return;
      if (isCharacter(key) && !this.everywhere && target !== this.picture) return;
      const act = acts.get(key);
      if (!act) return;
      event.preventDefault();
      act(key, event);
    });
  }

  get anywhere(): boolean {
    return this.everywhere;
  }

  set anywhere(anywhere: boolean) {
    this.everywhere = anywhere;
    keep("keys", anywhere);
  }
}

function needsItself(element: Element, key: string, reached: boolean): boolean {
  if (document.querySelector("dialog[open]")) return true;
  // It closes what is open over the page, and nothing else.
  if (key === "Escape") return document.querySelector("[popover=auto]:popover-open") !== null;
  if (element.matches("input[type=checkbox], button, summary")) {
    // What a mouse has pressed is not pressed again.
    return (key === " " || key === "Enter") && reached;
  }
  if (element.matches("input[type=range]")) return key.includes("Arrow") || key === " ";
  return element.matches("input, select, textarea");
}
