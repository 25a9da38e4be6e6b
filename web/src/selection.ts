import { Emitter } from "./emitter";
import type { Session } from "./session";
import type { Picked } from "./view/overlays/overlay";

/** A body of a world. */
export interface Selected {
  world: number;
  body: number;
}

/** The body that is picked. Another scene has none. */
export class Selection extends Emitter<{ change: Selected | null }> {
  private selected: Selected | null = null;

  constructor(private readonly session: Session) {
    super();
    session.on("scene", () => {
      this.now = null;
    });
  }

  get now(): Selected | null {
    return this.selected;
  }

  set now(selected: Selected | null) {
    if (selected?.world === this.selected?.world && selected?.body === this.selected?.body) return;
    this.selected = selected;
    this.emit("change", selected);
  }

  /** The body among those drawn; null where its world is not shown. */
  get drawn(): Picked | null {
    const { selected } = this;
    const row = selected ? this.session.shown.indexOf(selected.world) : -1;
    return selected && row >= 0 ? { row, body: selected.body } : null;
  }

  /** Picks what is drawn somewhere; nothing where that is no body. */
  pick(drawn: Picked | null): void {
    const world = drawn ? this.session.shown[drawn.row] : undefined;
    this.now = drawn && drawn.body >= 0 && world !== undefined ? { world, body: drawn.body } : null;
  }

  /** Picks the next body, or the one before. */
  turn(by: 1 | -1): void {
    const count = this.session.scene?.bodies.length ?? 0;
    const world = this.selected?.world ?? this.session.shown[0];
    if (!count || world === undefined) return;
    const body = this.selected ? (this.selected.body + by + count) % count : by > 0 ? 0 : count - 1;
    this.now = { world, body };
  }
}
