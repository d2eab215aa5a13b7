// The live readings of a device or controller. Only rows in view are watched.
import type {Context} from '../app/context';
import {formatNumber, word} from '../app/format';
import {ticker} from '../app/ticker';
import {Watch} from '../app/watcher';
import {clear, h, setText} from './dom';
import {icon} from './icons';
import {draggableValue} from './values';

export interface Listed {
  address: string;
  unit: string;
  help: string;
  value: number | null;
  count: number;
}

/** A parameter of a stage of noise, which has a slider of its own. */
const isStage = (address: string): boolean => /\.stages\[\d+\]\.\w+\.\w+$/.test(address);

const rate_hz = 5;
const page_rows = 40;
const watched_max = 40;  // the server allows 200 for each client

export class Readings {
  private readonly body = h('div', {class: 'readings'});
  readonly element = h('section', {class: 'block'}, h('h3', {}, 'Readings'), this.body);
  private readonly cells = new Map<string, HTMLElement>();
  private readonly inView = new Set<string>();
  private watch: Watch | null = null;
  private watched = '';
  private values: ArrayLike<number> = [];
  private readonly observer = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      const address = (entry.target as HTMLElement).dataset.address ?? '';
      if (entry.isIntersecting) this.inView.add(address);
      else this.inView.delete(address);
    }
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.rewatch(), 150);
  });
  private timer: ReturnType<typeof setTimeout> | undefined;
  private closed = false;

  constructor(private readonly context: Context, private readonly path: string, private readonly parameters: ReadonlySet<string>, private readonly topics: string[],
    private readonly listed: Promise<Listed[] | null> = context.steer.list<Listed[]>(word(path))) {
    void this.load();
  }

  private async load(): Promise<void> {
    const listed = await this.listed;
    if (this.closed) return;
    const entries = (Array.isArray(listed) ? listed : []).filter((e) => typeof e?.address === 'string' && !this.parameters.has(e.address) && !isStage(e.address));
    clear(this.body);
    if (entries.length === 0) this.body.append(h('div', {class: 'none faint'}, 'No readings'));
    this.more(entries, 0);
  }

  private more(entries: Listed[], from: number): void {
    for (const entry of entries.slice(from, from + page_rows)) this.body.append(this.row(entry));
    const rest = entries.length - from - page_rows;
    if (rest <= 0) return;
    const button = h('button', {class: 'plain small'}, `${rest} more`);
    button.addEventListener('click', () => {
      button.remove();
      this.more(entries, from + page_rows);
    });
    this.body.append(button);
  }

  private row(entry: Listed): HTMLElement {
    const short = entry.address.startsWith(this.path) ? entry.address.slice(this.path.length).replace(/^[./]/, '') : entry.address;
    const list = entry.count > 0;
    const cell = h('span', {class: 'v number'}, list ? `${entry.count} values` : formatNumber(entry.value ?? Number.NaN));
    const row = h('div', {class: 'reading', title: `${entry.address}${entry.unit ? ` [${entry.unit}]` : ''}\n${entry.help ?? ''}`, 'data-address': entry.address},
        h('span', {class: 'ellipsis name'}, short), cell, h('span', {class: 'unit'}, entry.unit ?? ''));
    if (list) {
      const topic = this.topics.find((t) => entry.address.startsWith(t.slice(1))) ?? this.topics[0];
      if (topic) row.append(h('button', {class: 'plain small icon-only', title: 'Show as a picture', 'aria-label': `Show ${short} as a picture`, on: {click: () => this.context.showMatrix(topic)}}, icon('layers', 13)));
      else row.append(h('span'));
    } else {
      row.append(h('button', {class: 'plain small icon-only', title: 'Plot', 'aria-label': `Plot ${short}`, testid: `plot-${entry.address}`, on: {click: () => this.context.plot(entry.address, entry.unit ?? '')}}, icon('plot', 13)));
      draggableValue(row, entry.address, entry.unit ?? '');
      this.cells.set(entry.address, cell);
      this.observer.observe(row);
    }
    return row;
  }

  private rewatch(): void {
    if (this.closed) return;
    const addresses = [...this.inView].slice(0, watched_max);
    const key = addresses.join('\n');
    if (key === this.watched) return;
    this.watched = key;
    this.watch?.close();
    this.watch = addresses.length === 0 ? null : new Watch(this.context.client, addresses, rate_hz, (_time, values) => {
      this.values = values;
      ticker.request(() => {
        if (key !== this.watched) return;
        addresses.forEach((address, i) => {
          const cell = this.cells.get(address);
          if (cell) setText(cell, formatNumber(this.values[i] ?? Number.NaN));
        });
      });
    });
  }

  close(): void {
    this.closed = true;
    clearTimeout(this.timer);
    this.observer.disconnect();
    this.watch?.close();
  }
}
