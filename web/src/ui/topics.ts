// Topics with their rates. Only topics in view are subscribed to, and only while the pane is seen.
import type {Context, Panel} from '../app/context';
import {formatBytes, formatRate} from '../app/format';
import type {Channel, Message} from '../net/client';
import {ticker} from '../app/ticker';
import {h, setText} from './dom';
import {Echo} from './echo';
import {icon} from './icons';
import {VirtualList} from './virtual_list';

/** Messages and bytes of the last seconds. */
export class Meter {
  private readonly counts: number[] = [];
  private readonly sizes: number[] = [];
  private second = -1;

  constructor(private readonly window_s = 4) {}

  add(now_s: number, bytes: number): void {
    this.advance(now_s);
    this.counts[this.second % this.window_s] = (this.counts[this.second % this.window_s] ?? 0) + 1;
    this.sizes[this.second % this.window_s] = (this.sizes[this.second % this.window_s] ?? 0) + bytes;
    this.started ??= now_s;
  }

  private started: number | null = null;

  private advance(now_s: number): void {
    const second = Math.floor(now_s);
    if (second - this.second > this.window_s) this.second = second - this.window_s;
    while (this.second < second) {
      this.second += 1;
      this.counts[this.second % this.window_s] = 0;
      this.sizes[this.second % this.window_s] = 0;
    }
  }

  /** Per second, over the time that was measured. */
  rates(now_s: number): {hz: number; bytes: number} {
    if (this.started === null) return {hz: 0, bytes: 0};
    this.advance(now_s);
    const spanned = Math.min(now_s - this.started, this.window_s - 1 + (now_s - Math.floor(now_s)));
    if (spanned < 0.5) return {hz: 0, bytes: 0};
    const sum = (list: number[]): number => list.reduce((a, b) => a + b, 0);
    return {hz: sum(this.counts) / spanned, bytes: sum(this.sizes) / spanned};
  }
}

const row_px = 26;
const echo_period_ms = 200;

export class TopicsPanel implements Panel {
  private readonly search = h('input', {type: 'search', placeholder: 'Filter', 'aria-label': 'Filter the topics'});
  private readonly count = h('span', {class: 'faint'});
  private readonly list: VirtualList<Channel>;
  private readonly echo = new Echo();
  private readonly echoTitle = h('div', {class: 'echo-title mono ellipsis'});
  readonly element: HTMLElement;
  private visible = false;
  private readonly meters = new Map<string, Meter>();
  private readonly subscribed = new Map<string, () => void>();
  private selected: string | null = null;
  private stopEcho: (() => void) | null = null;
  private latest: Message | null = null;
  private echoed_ms = 0;
  private timer: ReturnType<typeof setInterval> | undefined;
  private shown: Channel[] = [];

  constructor(private readonly context: Context) {
    this.list = new VirtualList<Channel>(row_px, (c) => this.row(c));
    this.list.refreshRow = (row, c) => this.refreshRow(row, c);
    this.list.onRange = () => this.subscribe();
    this.element = h('div', {class: 'pane split', testid: 'topics'},
        h('div', {class: 'split-main'}, h('div', {class: 'pane-head'}, h('div', {class: 'search grow'}, icon('search', 14), this.search), this.count),
          h('div', {class: 'topic-row topic-head faint'}, h('span', {}, 'Topic'), h('span', {}, 'Type'), h('span', {class: 'to-right'}, 'Rate'), h('span', {class: 'to-right'}, 'Bandwidth')), this.list.element),
        h('div', {class: 'split-side'}, this.echoTitle, this.echo.element));
    this.echo.say('Choose a topic to see its latest message');
    this.search.addEventListener('input', this.refresh);
    context.client.onChannels.on(() => {
      if (this.visible) ticker.request(this.refresh);
    });
  }

  private row(c: Channel): HTMLElement {
    const row = h('div', {class: 'topic-row', title: `${c.topic}\n${c.schemaName}, ${c.encoding}`, 'data-topic': c.topic, on: {click: () => this.select(c.topic)}},
        h('span', {class: 'mono ellipsis'}, c.topic), h('span', {class: 'dim ellipsis'}, c.schemaName), h('span', {class: 'number to-right'}), h('span', {class: 'number to-right dim'}));
    this.refreshRow(row, c);
    return row;
  }

  private refreshRow(row: HTMLElement, c: Channel): void {
    const {hz, bytes} = this.meters.get(c.topic)?.rates(performance.now() / 1000) ?? {hz: 0, bytes: 0};
    row.classList.toggle('selected', c.topic === this.selected);
    setText(row.children[2] as Element, formatRate(hz));
    setText(row.children[3] as Element, bytes > 0 ? `${formatBytes(bytes)}/s` : '–');
  }

  private readonly refresh = (): void => {
    const text = this.search.value.trim().toLowerCase();
    this.shown = [...this.context.client.channels.values()].filter((c) => !c.topic.startsWith('/sandlot/watch/') && (text === '' || `${c.topic} ${c.schemaName}`.toLowerCase().includes(text))).sort((a, b) => (a.topic < b.topic ? -1 : 1));
    this.count.textContent = `${this.shown.length} topics`;
    this.list.set(this.shown);
  };

  private subscribe(): void {
    const wanted = new Set(this.visible ? this.shown.slice(...this.list.range).map((c) => c.topic) : []);
    for (const [topic, stop] of this.subscribed) {
      if (wanted.has(topic)) continue;
      stop();
      this.subscribed.delete(topic);
      this.meters.delete(topic);
    }
    for (const topic of wanted) {
      if (this.subscribed.has(topic)) continue;
      const meter = new Meter();
      this.meters.set(topic, meter);
      this.subscribed.set(topic, this.context.client.subscribe(topic, (message) => meter.add(performance.now() / 1000, message.bytes.byteLength)));
    }
  }

  private select(topic: string): void {
    this.selected = topic;
    this.stopEcho?.();
    this.latest = null;
    this.echoTitle.textContent = topic;
    this.echo.say('Waiting for a message');
    this.listen();
    this.list.draw();
  }

  private listen(): void {
    this.stopEcho?.();
    this.stopEcho = null;
    if (this.selected === null || !this.visible) return;
    this.stopEcho = this.context.client.subscribe(this.selected, (message) => {
      this.latest = message;
      const now_ms = performance.now();
      if (now_ms - this.echoed_ms < echo_period_ms) return;
      this.echoed_ms = now_ms;
      ticker.request(this.showEcho);
    });
  }

  private readonly showEcho = (): void => {
    if (!this.latest) return;
    const value = this.latest.value();
    if (value === undefined) this.echo.say(`${formatBytes(this.latest.bytes.byteLength)} of ${this.latest.channel.encoding}, which this page does not show`);
    else this.echo.show(value);
  };

  setVisible(visible: boolean): void {
    if (visible === this.visible) return;
    this.visible = visible;
    clearInterval(this.timer);
    if (visible) {
      this.timer = setInterval(() => ticker.request(this.list.draw), 1000);
      this.refresh();
    }
    this.subscribe();
    this.listen();
  }
}
