import { Emitter } from "./emitter";

/** A body of a world. */
export interface Selected {
  world: number;
  body: number;
}

/** The body that is picked. */
export class Selection extends Emitter<{ change: Selected | null }> {
  private selected: Selected | null = null;

  get now(): Selected | null {
    return this.selected;
  }

  set now(selected: Selected | null) {
    if (selected?.world === this.selected?.world && selected?.body === this.selected?.body) return;
    this.selected = selected;
    this.emit("change", selected);
  }
}
