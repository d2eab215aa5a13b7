// The numbers behind a plot: a ring of fixed size for each value. Adding never allocates once the ring has grown to its size.

export const capacity_points = 100_000;

export class Series {
  private times: Float64Array;
  private values: Float64Array;
  private first = 0;
  length = 0;

  constructor(private readonly capacity = capacity_points) {
    const start = Math.min(1024, capacity);
    this.times = new Float64Array(start);
    this.values = new Float64Array(start);
  }

  push(time_s: number, value: number): void {
    if (this.length === this.times.length && this.length < this.capacity) this.grow();
    const size = this.times.length;
    if (this.length < size) {
      const at = (this.first + this.length) % size;
      this.times[at] = time_s;
      this.values[at] = value;
      this.length += 1;
    } else {
      this.times[this.first] = time_s;
      this.values[this.first] = value;
      this.first = (this.first + 1) % size;
    }
  }

  /** Another value for the newest time; NaN leaves it. */
  replaceLast(value: number): void {
    if (this.length > 0 && !Number.isNaN(value)) this.values[(this.first + this.length - 1) % this.times.length] = value;
  }

  private grow(): void {
    const size = Math.min(this.capacity, this.times.length * 2);
    const times = new Float64Array(size);
    const values = new Float64Array(size);
    times.set(this.times);  // full rings below capacity have never turned: they begin at 0
    values.set(this.values);
    this.times = times;
    this.values = values;
  }

  time(i: number): number {
    return this.times[(this.first + i) % this.times.length] as number;
  }

  value(i: number): number {
    return this.values[(this.first + i) % this.values.length] as number;
  }

  lastTime(): number {
    return this.length === 0 ? Number.NaN : this.time(this.length - 1);
  }

  lastValue(): number {
    return this.length === 0 ? Number.NaN : this.value(this.length - 1);
  }

  /** The first index whose time is not before `time_s`. */
  lowerBound(time_s: number): number {
    let low = 0;
    let high = this.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time(middle) < time_s) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  clear(): void {
    this.first = 0;
    this.length = 0;
  }
}

/**
 * Values of one plot at common times. All values of a plot come in one message, so they share their times; a value that joined later has
 * gaps (NaN) before.
 */
export class PlotData {
  readonly series: Series[] = [];
  readonly times: Series;

  constructor(private readonly capacity = capacity_points) {
    this.times = new Series(capacity);
  }

  addSeries(): void {
    const fresh = new Series(this.capacity);
    for (let i = 0; i < this.times.length; i++) fresh.push(this.times.time(i), Number.NaN);
    this.series.push(fresh);
  }

  removeSeries(at: number): void {
    this.series.splice(at, 1);
    if (this.series.length === 0) this.times.clear();
  }

  /** Time that runs backwards is another past: what was kept is dropped. */
  push(time_s: number, values: ArrayLike<number>): void {
    const last = this.times.lastTime();
    if (time_s < last) this.clear();
    else if (time_s === last) {
      // Told again, of a run that stands still: a value that has just been added has its first number now.
      this.series.forEach((s, i) => s.replaceLast(values[i] ?? Number.NaN));
      return;
    }
    this.times.push(time_s, time_s);
    this.series.forEach((s, i) => s.push(time_s, values[i] ?? Number.NaN));
  }

  /** A break in the line, for a time in which nobody listened. */
  gap(): void {
    const last = this.times.lastTime();
    if (Number.isNaN(last)) return;
    const none = this.series.map(() => Number.NaN);
    this.push(last + 1e-9, none);
  }

  clear(): void {
    this.times.clear();
    for (const s of this.series) s.clear();
  }

  /**
   * Columns for the plot from `from_s` to `to_s`: all points where there are few, else the least and the greatest of each of `columns`
   * slices, so that no peak is lost. Gaps are null.
   */
  columns(from_s: number, to_s: number, columns: number): (number | null)[][] {
    const begin = Math.max(0, this.times.lowerBound(from_s) - 1);
    const end = Math.min(this.times.length, this.times.lowerBound(to_s) + 1);
    const count = end - begin;
    const out: (number | null)[][] = [[], ...this.series.map(() => [] as (number | null)[])];
    const put = (i: number, column: number, value: number): void => void out[column]?.push(Number.isFinite(value) ? value : null);
    if (count <= columns * 4) {
      for (let i = begin; i < end; i++) {
        out[0]?.push(this.times.time(i));
        this.series.forEach((s, k) => put(i, k + 1, s.value(i)));
      }
      return out;
    }
    for (let c = 0; c < columns; c++) {
      const low = begin + Math.floor((count * c) / columns);
      const high = begin + Math.floor((count * (c + 1)) / columns);
      if (high <= low) continue;
      out[0]?.push(this.times.time(low), this.times.time(Math.max(low, high - 1)) + (high - low === 1 ? 1e-12 : 0));
      this.series.forEach((s, k) => {
        let least = Infinity;
        let most = -Infinity;
        let leastAt = low;
        let mostAt = low;
        for (let i = low; i < high; i++) {
          const v = s.value(i);
          if (v < least) least = v, leastAt = i;
          if (v > most) most = v, mostAt = i;
        }
        if (least > most) {
          put(low, k + 1, Number.NaN);
          put(low, k + 1, Number.NaN);
        } else {
          put(low, k + 1, leastAt <= mostAt ? least : most);
          put(low, k + 1, leastAt <= mostAt ? most : least);
        }
      });
    }
    return out;
  }
}
