import { Emitter } from "./emitter";

export type Theme = "light" | "dark";
export type ThemeChoice = Theme | "system";

/** Light or dark: as the system says, unless chosen on the page. */
export class Themes extends Emitter<{ change: Theme }> {
  private readonly system = matchMedia("(prefers-color-scheme: dark)");

  constructor(private picked: ThemeChoice) {
    super();
    this.system.addEventListener("change", () => this.apply());
    this.apply();
  }

  get now(): Theme {
    if (this.picked !== "system") return this.picked;
    return this.system.matches ? "dark" : "light";
  }

  get choice(): ThemeChoice {
    return this.picked;
  }

  set choice(choice: ThemeChoice) {
    this.picked = choice;
    this.apply();
  }

  private apply(): void {
    document.documentElement.dataset.theme = this.now;
    this.emit("change", this.now);
  }
}
