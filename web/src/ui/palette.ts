// The command palette: every action and everything in the world, found by a few letters.
import type {Context} from '../app/context';
import {keyLabel} from '../app/actions';
import {h} from './dom';
import {icon} from './icons';

interface Entry {
  title: string;
  what: string;
  symbol: string;
  key: string;
  reason: string | null;
  run: () => void;
}

const shown_max = 60;

/** How well letters fit a title: they must come in order. Beginnings of words and runs count more; 0: not at all. */
export function score(title: string, letters: string): number {
  if (letters === '') return 1;
  const text = title.toLowerCase();
  const whole = text.indexOf(letters);
  if (whole >= 0) return 1000 - whole * 4 - text.length * 0.1 + (whole === 0 || /[\s/_.-]/.test(text[whole - 1] ?? '') ? 200 : 0);
  let at = 0;
  let sum = 0;
  for (const letter of letters) {
    if (letter === ' ') continue;
    const found = text.indexOf(letter, at);
    if (found < 0) return 0;
    sum += found === at ? 4 : /[\s/_.-]/.test(text[found - 1] ?? ' ') ? 3 : 1;
    at = found + 1;
  }
  return sum / (1 + text.length * 0.01);
}

export function openPalette(context: Context): void {
  const {actions, store} = context;
  const input = h('input', {placeholder: 'What would you like to do?', 'aria-label': 'Find a command or a thing', role: 'combobox', 'aria-expanded': 'true', testid: 'palette-input', spellcheck: 'false', autocomplete: 'off'});
  const list = h('ul', {role: 'listbox'});
  const dialog = h('dialog', {class: 'palette', 'aria-label': 'All commands'}, input, list);
  let found: Entry[] = [];
  let at = 0;

  const all = (): Entry[] => {
    const entries: Entry[] = actions.list.filter((a) => a.id !== 'page.palette').map((a) => ({
      title: a.title, what: a.group, symbol: 'chevron', key: a.keys[0] ? keyLabel(a.keys[0]) : '', reason: a.steers ? actions.whyNot(a) : null, run: () => actions.run(a.id),
    }));
    for (const instance of store.world?.instances ?? []) {
      entries.push({title: instance.name, what: instance.robot ? 'Robot' : 'Object', symbol: instance.robot ? 'robot' : 'box', key: '', reason: null, run: () => {
        store.select(instance.name);
        context.scene.frame(instance.name);
      }});
      for (const device of instance.devices ?? []) entries.push({title: device.path, what: device.kind.replace(/_/g, ' '), symbol: 'chip', key: '', reason: null, run: () => store.select(device.path)});
      for (const controller of instance.controllers ?? []) entries.push({title: controller.path, what: 'controller', symbol: 'brain', key: '', reason: null, run: () => store.select(controller.path)});
    }
    return entries;
  };
  const entries = all();

  const choose = (entry: Entry | undefined): void => {
    if (!entry || entry.reason !== null) return;
    dialog.close();
    entry.run();
  };
  const mark = (): void => {
    [...list.children].forEach((row, i) => {
      row.setAttribute('aria-selected', String(i === at));
      if (i === at) row.scrollIntoView({block: 'nearest'});
    });
  };
  const show = (): void => {
    const letters = input.value.trim().toLowerCase();
    found = entries.map((entry) => ({entry, value: score(entry.title, letters)})).filter((e) => e.value > 0).sort((a, b) => b.value - a.value).slice(0, shown_max).map((e) => e.entry);
    at = 0;
    list.replaceChildren(...found.map((entry) => h('li', {role: 'option', title: entry.reason ?? undefined, class: entry.reason ? 'faint' : '', on: {click: () => choose(entry)}},
        icon(entry.symbol, 14), h('span', {class: 'ellipsis'}, entry.title), h('span', {class: 'what'}, entry.what), entry.key ? h('kbd', {}, entry.key) : null)));
    if (found.length === 0) list.replaceChildren(h('div', {class: 'none'}, 'Nothing by that name'));
    mark();
  };
  input.addEventListener('input', show);
  input.addEventListener('keydown', (event) => {
    if (event.key === 'ArrowDown') at = Math.min(found.length - 1, at + 1);
    else if (event.key === 'ArrowUp') at = Math.max(0, at - 1);
    else if (event.key === 'Enter') return choose(found[at]);
    else return;
    event.preventDefault();
    mark();
  });
  dialog.addEventListener('close', () => dialog.remove());
  dialog.addEventListener('click', (event) => {
    if (event.target === dialog) dialog.close();
  });
  document.body.append(dialog);
  dialog.showModal();
  show();
  input.focus();
}
