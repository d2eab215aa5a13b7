// A message as a tree of names and values that can be folded.
import {formatNumber} from '../app/format';
import {clear, h} from './dom';

const shown_items = 24;
const shown_rows = 400;

export interface EchoRow {
  depth: number;
  name: string;
  text: string;
  path: string;
  open: boolean | null;  // null: nothing below
}

/** Rows of a value; lists of more than `shown_items` are cut, with a row that says so. */
export function echoRows(value: unknown, closed: ReadonlySet<string>): EchoRow[] {
  const rows: EchoRow[] = [];
  const visit = (name: string, v: unknown, depth: number, path: string): void => {
    if (rows.length >= shown_rows || depth > 12) return;
    if (ArrayBuffer.isView(v) || Array.isArray(v)) {
      const list = v as ArrayLike<unknown>;
      const simple = list.length === 0 || typeof list[0] !== 'object';
      // Lists of numbers start folded: they are long.
      const open = simple ? closed.has(path) : !closed.has(path);
      rows.push({depth, name, text: `${list.length} ${list.length === 1 ? 'item' : 'items'}${simple && list.length > 0 ? `: ${Array.from(list).slice(0, 6).map(scalar).join(', ')}${list.length > 6 ? ' …' : ''}` : ''}`, path, open: list.length === 0 ? null : open});
      if (!open) return;
      for (let i = 0; i < Math.min(list.length, shown_items); i++) visit(`[${i}]`, list[i], depth + 1, `${path}[${i}]`);
      if (list.length > shown_items) rows.push({depth: depth + 1, name: '…', text: `${list.length - shown_items} more`, path: `${path}…`, open: null});
    } else if (typeof v === 'object' && v !== null) {
      const open = !closed.has(path);
      rows.push({depth, name, text: '', path, open});
      if (open) for (const [key, item] of Object.entries(v)) visit(key, item, depth + 1, `${path}.${key}`);
    } else {
      rows.push({depth, name, text: scalar(v), path, open: null});
    }
  };
  if (typeof value === 'object' && value !== null && !Array.isArray(value) && !ArrayBuffer.isView(value)) {
    for (const [key, item] of Object.entries(value)) visit(key, item, 0, key);
  } else {
    visit('value', value, 0, 'value');
  }
  return rows;
}

function scalar(v: unknown): string {
  if (typeof v === 'number') return formatNumber(v, 7);
  if (typeof v === 'string') return v.length > 300 ? `${v.slice(0, 300)}…` : v;
  return String(v);
}

export class Echo {
  readonly element = h('div', {class: 'echo mono'});
  private readonly toggled = new Set<string>();
  private value: unknown = undefined;

  show(value: unknown): void {
    this.value = value;
    const rows = echoRows(value, this.toggled);
    clear(this.element);
    for (const row of rows) {
      this.element.append(h('div', {class: `echo-row${row.open === null ? '' : ' can-open'}`, style: {'padding-left': `${8 + row.depth * 14}px`}, on: row.open === null ? {} : {click: () => {
        if (!this.toggled.delete(row.path)) this.toggled.add(row.path);
        this.show(this.value);
      }}}, h('span', {class: 'twist'}, row.open === null ? '' : row.open ? '▾' : '▸'), h('span', {class: 'key'}, row.name), h('span', {class: 'ellipsis'}, row.text)));
    }
  }

  say(text: string): void {
    this.value = undefined;
    this.element.replaceChildren(h('div', {class: 'empty'}, text));
  }
}
