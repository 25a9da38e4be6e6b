/** Samples kept; where there are more, every other one goes. */
const CAPACITY = 8192;

/** Quantities over time, in order of time. */
export class History {
  readonly times: number[] = [];
  private series = new Map<number, number[]>();
  /** Least time between samples [s], doubled whenever samples are thinned. */
  private spacing = 0;

  /** Keeps these quantities from now on, with what is known of their past. */
  choose(quantities: number[]): void {
    const unknown = () => this.times.map(() => Number.NaN);
    this.series = new Map(quantities.map((q) => [q, this.series.get(q) ?? unknown()]));
  }

  get quantities(): number[] {
    return [...this.series.keys()];
  }

  values(quantity: number): readonly number[] {
    return this.series.get(quantity) ?? [];
  }

  clear(): void {
    this.cut(Number.NEGATIVE_INFINITY);
    this.spacing = 0;
  }

  /** Adds a sample; those that are not earlier go. */
  push(time: number, values: ArrayLike<number>): void {
    const last = this.times.at(-1);
    if (last !== undefined && time > last && time - last < this.spacing) return;
    this.cut(time, false);
    this.times.push(time);
    let i = 0;
    for (const list of this.series.values()) list.push(values[i++]);
    if (this.times.length > CAPACITY) this.thin();
  }

  /** Forgets what is later than a time, and what is at it unless `inclusive`. */
  cut(time: number, inclusive = true): void {
    let length = this.times.length;
    while (length > 0 && (inclusive ? this.times[length - 1] > time : this.times[length - 1] >= time))
      length--;
    this.times.length = length;
    for (const list of this.series.values()) list.length = length;
  }

  /** The row of the last sample that is not later than a time; −1 where there is none. */
  at(time: number): number {
    let [low, high] = [0, this.times.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle] <= time) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }

  private thin(): void {
    const span = this.times[this.times.length - 1] - this.times[0];
    this.spacing = (2 * span) / CAPACITY;
    for (const list of [this.times, ...this.series.values()]) {
      let length = 0;
      for (let i = 0; i < list.length; i += 2) list[length++] = list[i];
      list.length = length;
    }
  }
}
