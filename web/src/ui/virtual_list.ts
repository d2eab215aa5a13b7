// A long list of rows of one height; only those in view have elements. Follows its tail while it is scrolled to it.
import {ticker} from '../app/ticker';
import {h} from './dom';

export class VirtualList<T> {
  private readonly space = h('div', {class: 'virtual-space'});
  readonly element = h('div', {class: 'virtual-list', tabindex: '0'}, this.space);
  private items: readonly T[] = [];
  /** Rows in view by their items: a row that is pressed must still be there when it is let go. */
  private rows = new Map<T, HTMLElement>();
  refreshRow: (row: HTMLElement, item: T) => void = () => undefined;
  /** First and one past the last row in view. */
  range: [number, number] = [0, 0];
  follow = false;
  onRange: () => void = () => undefined;

  constructor(private readonly row_px: number, private readonly makeRow: (item: T, index: number) => HTMLElement) {
    this.element.addEventListener('scroll', () => {
      if (this.followed) this.follow = this.element.scrollTop + this.element.clientHeight >= this.space.clientHeight - this.row_px;
      ticker.request(this.draw);
    }, {passive: true});
    new ResizeObserver(() => ticker.request(this.draw)).observe(this.element);
  }

  private followed = false;

  /** Makes the list one that grows at its end. */
  followTail(): void {
    this.followed = true;
    this.follow = true;
  }

  set(items: readonly T[]): void {
    this.items = items;
    ticker.request(this.draw);
  }

  readonly draw = (): void => {
    if (this.element.clientHeight === 0) return;
    this.space.style.height = `${this.items.length * this.row_px}px`;
    if (this.follow) this.element.scrollTop = this.items.length * this.row_px;
    const first = Math.max(0, Math.floor(this.element.scrollTop / this.row_px) - 3);
    const last = Math.min(this.items.length, Math.ceil((this.element.scrollTop + this.element.clientHeight) / this.row_px) + 3);
    this.range = [first, last];
    const rows = new Map<T, HTMLElement>();
    for (let i = first; i < last; i++) {
      const item = this.items[i] as T;
      const known = this.rows.get(item);
      const row = known ?? this.makeRow(item, i);
      if (known) this.refreshRow(row, item);
      const top = `${i * this.row_px}px`;
      if (row.style.top !== top) row.style.top = top;
      rows.set(item, row);
    }
    for (const [item, row] of this.rows) if (!rows.has(item)) row.remove();
    for (const row of rows.values()) if (row.parentElement === null) this.space.append(row);
    this.rows = rows;
    this.onRange();
  };
}
