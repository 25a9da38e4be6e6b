/** Something others can listen to. `Events` maps the names of events to what they carry. */
export class Emitter<Events> {
  private readonly listeners: { [K in keyof Events]?: ((value: Events[K]) => void)[] } = {};

  on<K extends keyof Events>(event: K, listener: (value: Events[K]) => void): void {
    let list = this.listeners[event];
    if (!list) this.listeners[event] = list = [];
    list.push(listener);
  }

  emit<K extends keyof Events>(event: K, value: Events[K]): void {
    for (const listener of this.listeners[event] ?? []) listener(value);
  }
}
