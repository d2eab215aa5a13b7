// The line of time: what has been and can be gone back to, snapshots that are kept, and, where the end is known, what is to come.
// Click or drag to jump. What a referee decided has marks with a hint; a click near one jumps to its very time.
import type {Context} from '../app/context';
import {formatTime} from '../app/format';
import type {Game} from '../app/game';
import {markNear, TimeMark} from '../app/match';
import {ticker} from '../app/ticker';
import {h, setTitle} from './dom';

/** Times that the line spans. A live run without an end grows to the right: the newest time is the end. */
export function spanOf(status: {begin_s: number; kept_from_s?: number; end_s: number | null; time_s: number; history_s: number[]; replay: boolean}): [number, number] {
  const first = Math.min(status.begin_s, ...status.history_s.slice(0, 1));
  const begin = Math.min(Math.max(first, status.kept_from_s ?? first), status.time_s);
  const newest = Math.max(status.time_s, status.history_s[status.history_s.length - 1] ?? status.time_s);
  const end = status.end_s !== null && Number.isFinite(status.end_s) ? Math.max(status.end_s, newest) : newest;
  return [begin, Math.max(end, begin + 1e-9)];
}

const near_px = 5, most_events = 400;

export class Timeline {
  private readonly past = h('div', {class: 'past'});
  private readonly marks = h('div', {class: 'marks'});
  private readonly events = h('div', {class: 'events', testid: 'time-events'});
  private readonly head = h('div', {class: 'head'});
  private readonly hint = h('div', {class: 'hint mono', hidden: true});
  readonly element = h('div', {class: 'timeline', role: 'slider', tabindex: '0', 'aria-label': 'Time', testid: 'timeline'},
      h('div', {class: 'rail'}, this.past), this.marks, this.events, this.head, this.hint);
  private marksKey = '';
  private eventsKey = '';
  private events_: TimeMark[] = [];
  private held_s: number | null = null;

  constructor(private readonly context: Context, private readonly game: Game) {
    game.onLog.on(() => ticker.request(this.update));
    context.store.onStatus.on(() => ticker.request(this.update));
    context.store.onRole.on(() => ticker.request(this.update));
    this.element.addEventListener('pointermove', (event) => this.hover(event));
    this.element.addEventListener('pointerleave', () => {
      if (this.held_s === null) this.hint.hidden = true;
    });
    this.element.addEventListener('pointerdown', (event) => {
      if (this.reason() !== null || event.button !== 0) return;
      this.element.setPointerCapture(event.pointerId);
      this.held_s = this.timeAt(event.clientX);
      ticker.request(this.update);
    });
    this.element.addEventListener('pointerup', () => this.release(true));
    this.element.addEventListener('pointercancel', () => this.release(false));
    this.element.addEventListener('keydown', (event) => {
      const status = context.store.status;
      const by = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
      if (by === 0 || !status || this.reason() !== null) return;
      event.preventDefault();
      event.stopPropagation();
      const [begin, end] = spanOf(status);
      context.steer.jump(Math.max(begin, Math.min(end, status.time_s + by * Math.max(status.step_s, (end - begin) / 50))));
    });
  }

  private reason(): string | null {
    return this.context.store.whyNotJump();
  }

  private release(jump: boolean): void {
    if (this.held_s !== null && jump) this.context.steer.jump(this.held_s);
    this.held_s = null;
    this.hint.hidden = true;
    ticker.request(this.update);
  }

  /** The event that the pointer is at. */
  private eventAt(x_px: number): TimeMark | null {
    const status = this.context.store.status;
    if (!status || this.events_.length === 0) return null;
    const box = this.element.getBoundingClientRect();
    const [begin, end] = spanOf(status);
    const s_per_px = (end - begin) / Math.max(1, box.width - 16);
    return markNear(this.events_, begin + (x_px - box.left - 8) * s_per_px, near_px * s_per_px);
  }

  private timeAt(x_px: number): number {
    const event = this.eventAt(x_px);
    if (event) return event.time_s;
    const status = this.context.store.status;
    const box = this.element.getBoundingClientRect();
    const part = Math.max(0, Math.min(1, (x_px - box.left - 8) / Math.max(1, box.width - 16)));
    if (!status) return 0;
    const [begin, end] = spanOf(status);
    const at = begin + part * (end - begin);
    // Whole steps: there is no time between them.
    return status.step_s > 0 ? Math.round(at / status.step_s) * status.step_s : at;
  }

  private hover(event: PointerEvent): void {
    const status = this.context.store.status;
    if (!status) return;
    const time_s = this.timeAt(event.clientX);
    if (this.held_s !== null) this.held_s = time_s;
    const box = this.element.getBoundingClientRect();
    const reason = this.reason();
    this.hint.hidden = false;
    const mark = this.eventAt(event.clientX);
    this.hint.textContent = mark ? `${formatTime(mark.time_s)}  ${mark.title}` : reason ?? formatTime(time_s);
    const half_px = this.hint.offsetWidth / 2;
    this.hint.style.left = `${Math.max(half_px, Math.min(box.width - half_px, event.clientX - box.left))}px`;
    ticker.request(this.update);
  }

  private readonly update = (): void => {
    const status = this.context.store.status;
    const reason = this.reason();
    this.element.classList.toggle('off', !status || reason !== null);
    if (!status) return;
    setTitle(this.element, reason === null ? '' : reason);
    const [begin, end] = spanOf(status);
    const part = (time_s: number): number => Math.max(0, Math.min(1, (time_s - begin) / (end - begin)));
    const shown = this.held_s ?? status.target_s ?? status.time_s;
    this.past.style.transform = `scaleX(${part(status.time_s)})`;
    this.head.style.left = `calc(8px + (100% - 16px) * ${part(shown).toFixed(4)})`;
    this.element.setAttribute('aria-valuemin', String(begin));
    this.element.setAttribute('aria-valuemax', String(end));
    this.element.setAttribute('aria-valuenow', String(status.time_s));
    this.element.setAttribute('aria-valuetext', formatTime(status.time_s));
    this.showEvents(begin, end, part);
    const kept = status.history_s.filter((t) => t >= begin);
    const thinned = kept.length > 400 ? kept.filter((_, i) => i % Math.ceil(kept.length / 400) === 0) : kept;
    const key = status.replay ? '' : thinned.map((t) => part(t).toFixed(3)).join();
    if (key === this.marksKey) return;
    this.marksKey = key;
    this.marks.replaceChildren(...(status.replay ? [] : thinned.map((t) => h('i', {class: 'mark', style: {left: `${(part(t) * 100).toFixed(2)}%`}}))));
  };

  /** Goals and cards always, of the rest what fits. */
  private showEvents(begin: number, end: number, part: (time_s: number) => number): void {
    const all = this.game.marks(begin, end);
    const notes = all.filter((m) => m.weight === 'minor' || m.weight === 'call');
    const step = Math.ceil(notes.length / most_events);
    const kept = step <= 1 ? all : all.filter((m) => (m.weight !== 'minor' && m.weight !== 'call') || notes.indexOf(m) % step === 0);
    const key = kept.map((m) => `${part(m.time_s).toFixed(4)}${m.color}${m.weight}`).join();
    if (key === this.eventsKey) return;
    this.eventsKey = key;
    this.events_ = kept;
    this.events.replaceChildren(...kept.map((m) => {
      const mark = h('i', {class: `event ${m.weight}`, 'data-time': m.time_s.toFixed(3), style: {left: `${(part(m.time_s) * 100).toFixed(2)}%`}});
      mark.style.background = m.color;
      return mark;
    }));
  }
}
