import { Emitter } from "./emitter";
import { keep, recall } from "./store";

export type Theme = "light" | "dark";

const CHOICES = ["system", "light", "dark"] as const;

/** Light or dark: as the system says, unless chosen on the page. */
export class Themes extends Emitter<{ change: Theme }> {
  private readonly system = matchMedia("(prefers-color-scheme: dark)");
  private choice = recall<(typeof CHOICES)[number]>("theme", "system");

  constructor() {
    super();
    this.system.addEventListener("change", () => this.apply());
    this.apply();
  }

  /** What is chosen. */
  get chosen(): (typeof CHOICES)[number] {
    return this.choice;
  }

  get now(): Theme {
    if (this.choice !== "system") return this.choice;
    return this.system.matches ? "dark" : "light";
  }

  /** As the system says, light, dark, in turn. */
  turn(): void {
    this.choice = CHOICES[(CHOICES.indexOf(this.choice) + 1) % CHOICES.length];
    keep("theme", this.choice);
    this.apply();
  }

  private apply(): void {
    document.documentElement.dataset.theme = this.now;
    this.emit("change", this.now);
  }
}
