// What the run and the server say: /rosout, and messages of the server.
import type {Context, Panel} from '../app/context';
import {formatTime} from '../app/format';
import {secondsOf} from '../net/decoders';
import {ticker} from '../app/ticker';
import {h} from './dom';
import {icon} from './icons';
import {VirtualList} from './virtual_list';

export interface LogEntry {
  time_s: number;
  level: number;  // as rcl_interfaces/Log: 10 debug, 20 info, 30 warning, 40 error, 50 fatal
  name: string;
  text: string;
}

const kept = 5000;
const sources_max = 500;
const levels: [number, string][] = [[10, 'Debug'], [20, 'Info'], [30, 'Warnings'], [40, 'Errors']];

export function levelName(level: number): string {
  return level >= 40 ? 'error' : level >= 30 ? 'warning' : level >= 20 ? 'info' : 'debug';
}

/** A program's output is logged as "rover/brain: its line": the program is its source. */
export function withSource(entry: LogEntry, isProgram: (path: string) => boolean): LogEntry {
  const [, path, text] = /^([^\s:]+\/[^\s:]+): (.*)$/s.exec(entry.text) ?? [];
  return path !== undefined && text !== undefined && isProgram(path) ? {...entry, name: path, text} : entry;
}

/** @param source  ''  all of them */
export function filterLog(entries: readonly LogEntry[], least: number, search: string, source = ''): LogEntry[] {
  const text = search.trim().toLowerCase();
  return entries.filter((e) => e.level >= least && (source === '' || e.name === source) && (text === '' || `${e.name} ${e.text}`.toLowerCase().includes(text)));
}

export class LogPanel implements Panel {
  private readonly entries: LogEntry[] = [];
  private readonly level = h('select', {'aria-label': 'Least level', title: 'Least level'}, ...levels.map(([value, label]) => h('option', {value}, label)));
  private readonly source = h('select', {'aria-label': 'Source', title: 'Source', testid: 'log-source'}, h('option', {value: ''}, 'All sources'));
  private readonly search = h('input', {type: 'search', placeholder: 'Search', 'aria-label': 'Search the log'});
  private readonly list = new VirtualList<LogEntry>(22, (e) => h('div', {class: `log-row ${levelName(e.level)}`, title: e.text},
      h('span', {class: 'mono faint time'}, formatTime(e.time_s)), h('span', {class: 'level'}, levelName(e.level)), h('span', {class: 'dim ellipsis who'}, e.name), h('span', {class: 'ellipsis grow'}, e.text)));
  readonly element = h('div', {class: 'pane log'}, h('div', {class: 'pane-head'}, this.level, this.source, h('div', {class: 'search grow'}, icon('search', 14), this.search),
      h('button', {class: 'plain small', on: {click: () => this.clear()}}, 'Clear'),
      h('button', {class: 'plain small', on: {click: () => {
        this.list.follow = true;
        this.list.draw();
      }}}, 'Newest')), this.list.element);
  private visible = false;
  private warnings = 0;

  constructor(context: Context, private readonly badge: (text: string) => void) {
    this.level.value = '20';
    this.list.followTail();
    this.level.addEventListener('change', this.update);
    this.source.addEventListener('change', this.update);
    this.search.addEventListener('input', this.update);
    context.client.subscribe('/rosout', (message) => {
      const log = message.value() as {stamp?: unknown; level?: number; name?: string; msg?: string} | undefined;
      if (!log) return;
      const entry = {time_s: secondsOf(log.stamp), level: Number(log.level ?? 20), name: String(log.name ?? ''), text: String(log.msg ?? '')};
      this.add(withSource(entry, (path) => context.store.find(path)?.part != null));
    });
    context.client.onStatus.on((status) => this.add({time_s: context.store.time_s, level: [20, 30, 40][status.level] ?? 20, name: 'server', text: String(status.message)}));
    context.store.onEpoch.on(() => this.add({time_s: context.store.time_s, level: 20, name: 'page', text: 'The run begins anew here'}));
  }

  /** Shows the lines of one source, whatever their level. */
  showOnly(source: string): void {
    this.level.value = '10';
    this.search.value = '';
    this.know(source);
    this.source.value = source;
    this.update();
  }

  private know(source: string): void {
    if (source === '' || [...this.source.options].some((o) => o.value === source) || this.source.options.length >= sources_max) return;
    this.source.append(h('option', {value: source}, source));
  }

  add(entry: LogEntry): void {
    this.know(entry.name);
    this.entries.push(entry);
    if (this.entries.length > kept) this.entries.splice(0, kept / 10);
    if (entry.level >= 30 && !this.visible) this.badge(String(++this.warnings > 99 ? '99+' : this.warnings));
    if (this.visible) ticker.request(this.update);
  }

  private clear(): void {
    this.entries.length = 0;
    this.update();
  }

  private readonly update = (): void => this.list.set(filterLog(this.entries, Number(this.level.value), this.search.value, this.source.value));

  setVisible(visible: boolean): void {
    this.visible = visible;
    if (!visible) return;
    this.warnings = 0;
    this.badge('');
    this.update();
  }
}
