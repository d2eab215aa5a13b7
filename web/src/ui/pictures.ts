// What cameras see, side by side. Which ones is remembered in this browser.
//
// Pictures come as JPEG: the server offers every Image topic small and a few times a second as TOPIC/compressed. A picture that comes while
// the last one is still being decoded waits, and only the newest does.
import type {Context, Panel} from '../app/context';
import {formatTime} from '../app/format';
import {remember, remembered} from '../app/settings';
import {secondsOf} from '../net/decoders';
import {h, setText} from './dom';
import {icon} from './icons';
import {saveBlob} from './save';

const windows_max = 12;
const suffix = '/compressed';

/** As people call it. */
const nameOf = (topic: string): string => (topic.endsWith(suffix) ? topic.slice(0, -suffix.length) : topic).replace(/^\//, '');

class PictureWindow {
  private readonly topic = h('select', {'aria-label': 'Camera', testid: 'picture-topic'});
  private readonly canvas = h('canvas', {class: 'picture-canvas', width: 4, height: 3, hidden: true, testid: 'picture'});
  private readonly hint = h('div', {class: 'empty'});
  private readonly readout = h('span', {class: 'mono dim readout'});
  readonly element: HTMLElement;
  private stop: (() => void) | null = null;
  private visible = false;
  private busy = false;
  private next: {data: Uint8Array; format: string; time_s: number} | null = null;

  constructor(private readonly context: Context, public chosen: string, private readonly changed: () => void, closed: (one: PictureWindow) => void) {
    this.topic.addEventListener('change', () => this.choose(this.topic.value));
    this.element = h('section', {class: 'picture', 'aria-label': 'Camera picture'},
      h('div', {class: 'pane-head'}, this.topic, this.readout, h('span', {class: 'grow'}),
        h('button', {class: 'plain small', title: 'Save the picture', on: {click: () => this.save()}}, 'PNG'),
        h('button', {class: 'plain small icon-only', title: 'Close', 'aria-label': 'Close this picture', testid: 'close-picture', on: {click: () => closed(this)}}, icon('close', 14))),
      h('div', {class: 'picture-area'}, this.canvas, this.hint));
    this.list();
  }

  choose(topic: string): void {
    this.chosen = topic;
    this.canvas.hidden = true;
    setText(this.readout, '');
    this.changed();
    this.list();
    this.listen();
  }

  list(): void {
    const topics = topicsOf(this.context);
    if (this.chosen !== '' && !topics.includes(this.chosen)) topics.unshift(this.chosen);
    this.topic.replaceChildren(h('option', {value: ''}, topics.length === 0 ? 'No cameras' : 'Choose a camera'), ...topics.map((t) => h('option', {value: t}, nameOf(t))));
    this.topic.value = this.chosen;
    setText(this.hint, topics.length === 0 ? 'Nothing in this world sends pictures' : this.chosen === '' ? 'Choose a camera above' : 'No picture yet: its device may be at another level');
    this.hint.hidden = !this.canvas.hidden;
  }

  private listen(): void {
    this.stop?.();
    this.stop = null;
    if (!this.visible || this.chosen === '') return;
    this.stop = this.context.client.subscribe(this.chosen, (message) => {
      const value = message.value() as {header?: {stamp?: unknown}; format?: string; data?: Uint8Array} | undefined;
      if (!value?.data || value.data.length === 0) return;
      this.next = {data: value.data, format: value.format ?? 'jpeg', time_s: secondsOf(value.header?.stamp ?? {})};
      if (!this.busy) void this.decode();
    });
  }

  private async decode(): Promise<void> {
    this.busy = true;
    while (this.next) {
      const {data, format, time_s} = this.next;
      this.next = null;
      try {
        const bitmap = await createImageBitmap(new Blob([data.slice()], {type: format.includes('png') ? 'image/png' : 'image/jpeg'}));
        if (this.canvas.width !== bitmap.width) this.canvas.width = bitmap.width;
        if (this.canvas.height !== bitmap.height) this.canvas.height = bitmap.height;
        this.canvas.getContext('2d')?.drawImage(bitmap, 0, 0);
        this.canvas.hidden = this.chosen === '';
        this.hint.hidden = !this.canvas.hidden;
        setText(this.readout, formatTime(time_s));
        bitmap.close();
      } catch {
        setText(this.readout, 'damaged');
      }
    }
    this.busy = false;
  }

  setVisible(visible: boolean): void {
    if (visible === this.visible) return;
    this.visible = visible;
    if (visible) this.list();
    this.listen();
  }

  private save(): void {
    if (this.canvas.hidden) return;
    this.canvas.toBlob((blob) => {
      if (blob) saveBlob(blob, `${nameOf(this.chosen).replace(/\W+/g, '-')}.png`);
    });
  }

  end(): void {
    this.stop?.();
    this.element.remove();
  }
}

/** The cameras there are, those of the selected robot first. */
function topicsOf(context: Context): string[] {
  const robot = context.store.selected()?.instance?.name;
  const rank = (topic: string): number => (robot !== undefined && topic.startsWith(`/${robot}/`) ? 0 : 1);
  return [...context.client.channels.values()].filter((c) => c.encoding === 'cdr' && c.schemaName.endsWith('/CompressedImage')).map((c) => c.topic)
    .sort((a, b) => rank(a) - rank(b) || a.localeCompare(b, 'en', {numeric: true})).slice(0, 2000);
}

export class PicturesPanel implements Panel {
  private readonly windows: PictureWindow[] = [];
  private readonly addButton = h('button', {class: 'plain add-plot', title: 'Another picture', 'aria-label': 'Another picture', testid: 'add-picture', on: {click: () => this.add()}}, icon('plus'), h('span', {}, 'Picture'));
  readonly element = h('div', {class: 'pane plots pictures', 'aria-label': 'Camera pictures'}, this.addButton);
  private visible = false;

  constructor(private readonly context: Context) {
    for (const topic of remembered<string[]>('pictures', []).slice(0, windows_max)) if (typeof topic === 'string') this.open(topic);
    const list = (): void => {
      if (this.visible) for (const one of this.windows) one.list();
    };
    context.client.onChannels.on(list);
    context.store.onSelection.on(list);
  }

  /** The first camera that is not shown yet. */
  private add(): void {
    const shown = new Set(this.windows.map((w) => w.chosen));
    this.show(topicsOf(this.context).find((t) => !shown.has(t)) ?? '');
  }

  show(topic: string): void {
    if (topic !== '' && this.windows.some((w) => w.chosen === topic)) return;
    const free = this.windows.find((w) => w.chosen === '');
    if (topic !== '' && free) {
      free.choose(topic);
      return;
    }
    if (this.windows.length >= windows_max) {
      this.context.toast(`No more than ${windows_max} pictures at once`, 'warning');
      return;
    }
    this.open(topic);
    this.save();
  }

  private open(topic: string): void {
    const made = new PictureWindow(this.context, topic, () => this.save(), (closed) => {
      closed.end();
      this.windows.splice(this.windows.indexOf(closed), 1);
      this.save();
    });
    this.windows.push(made);
    this.element.insertBefore(made.element, this.addButton);
    made.setVisible(this.visible);
  }

  private save(): void {
    remember('pictures', this.windows.map((w) => w.chosen));
  }

  setVisible(visible: boolean): void {
    this.visible = visible;
    if (visible && this.windows.length === 0) this.open(topicsOf(this.context)[0] ?? '');
    for (const one of this.windows) one.setVisible(visible);
  }
}
