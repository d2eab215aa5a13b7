// What comes up and goes away: menus, dialogs, toasts, lists of candidates.
import {h} from './dom';
import {icon} from './icons';

export interface MenuItem {
  label: string;
  icon?: string;
  key?: string;
  checked?: boolean;
  reason?: string | null;  // why it is disabled; null or absent: it is not
  danger?: boolean;
  run: () => void;
}

export type MenuEntry = MenuItem | 'line' | {heading: string};

let closeOpen: (() => void) | null = null;

/** Opens a menu below an element or at a point. Arrow keys move, Esc closes, focus goes back to where it was. */
export function openMenu(at: HTMLElement | {x: number; y: number}, entries: MenuEntry[], keepOpen = false): void {
  closeOpen?.();
  const before = document.activeElement as HTMLElement | null;
  const menu = h('div', {class: 'menu', role: 'menu'});
  const close = (): void => {
    if (closeOpen !== close) return;
    closeOpen = null;
    menu.remove();
    document.removeEventListener('pointerdown', outside, true);
    before?.focus({preventScroll: true});
  };
  const outside = (event: Event): void => {
    if (!menu.contains(event.target as Node)) close();
  };
  for (const entry of entries) {
    if (entry === 'line') {
      menu.append(h('hr'));
    } else if ('heading' in entry) {
      menu.append(h('h4', {}, entry.heading));
    } else {
      const check = entry.checked === undefined ? null : h('span', {class: 'check'}, entry.checked ? '✓' : '');
      const button = h('button', {
        role: entry.checked === undefined ? 'menuitem' : 'menuitemcheckbox', class: entry.danger ? 'danger' : '', title: entry.reason ?? undefined,
        'aria-checked': entry.checked === undefined ? undefined : String(entry.checked), disabled: (entry.reason ?? null) !== null,
        on: {click: () => {
          if (!keepOpen) close();
          entry.run();
          if (check && keepOpen) {
            entry.checked = !entry.checked;
            check.textContent = entry.checked ? '✓' : '';
            button.setAttribute('aria-checked', String(entry.checked));
          }
        }},
      }, check, entry.icon ? icon(entry.icon, 14) : null, entry.label, entry.key ? h('kbd', {}, entry.key) : null);
      menu.append(button);
    }
  }
  menu.addEventListener('keydown', (event) => {
    const items = [...menu.querySelectorAll<HTMLButtonElement>('button:not(:disabled)')];
    const now = items.indexOf(document.activeElement as HTMLButtonElement);
    if (event.key === 'Escape' || event.key === 'Tab') close();
    else if (event.key === 'ArrowDown') items[(now + 1) % items.length]?.focus();
    else if (event.key === 'ArrowUp') items[(now - 1 + items.length) % items.length]?.focus();
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  document.body.append(menu);
  const box = at instanceof HTMLElement ? at.getBoundingClientRect() : null;
  const size = menu.getBoundingClientRect();
  const x = box ? box.left : (at as {x: number}).x;
  let y = box ? box.bottom + 5 : (at as {y: number}).y;
  if (y + size.height > innerHeight - 8) y = Math.max(8, (box ? box.top - 5 : y) - size.height);
  menu.style.left = `${Math.max(8, Math.min(x, innerWidth - size.width - 8))}px`;
  menu.style.top = `${y}px`;
  closeOpen = close;
  setTimeout(() => document.addEventListener('pointerdown', outside, true));
  menu.querySelector<HTMLButtonElement>('button:not(:disabled)')?.focus({preventScroll: true});
}

/** A modal dialog; `foot` are its buttons. Closing removes it. */
export function openDialog(title: string, body: HTMLElement, foot: HTMLElement[] = []): HTMLDialogElement {
  const dialog = h('dialog', {'aria-label': title},
      h('div', {class: 'head'}, h('h2', {}, title),
        h('button', {class: 'plain icon-only', title: 'Close (Esc)', 'aria-label': 'Close', on: {click: () => dialog.close()}}, icon('close'))),
      h('div', {class: 'body'}, body));
  if (foot.length > 0) dialog.append(h('div', {class: 'foot'}, ...foot));
  dialog.addEventListener('close', () => dialog.remove());
  dialog.addEventListener('click', (event) => {
    if (event.target === dialog) dialog.close();
  });
  document.body.append(dialog);
  dialog.showModal();
  return dialog;
}

export class Toasts {
  readonly element = h('div', {class: 'toasts', role: 'status', 'aria-live': 'polite'});
  private readonly shown = new Map<string, {element: HTMLElement; count: number; timer: ReturnType<typeof setTimeout>}>();

  show(text: string, kind: 'info' | 'warning' | 'error' = 'info', button?: {label: string; run: () => void}): void {
    const stay_ms = kind === 'error' ? 9000 : button ? 7000 : 4500;
    const short = text.length > 400 ? `${text.slice(0, 400)}…` : text;
    const same = this.shown.get(short);
    if (same && !button) {
      // The same thing again is counted, not stacked.
      same.count += 1;
      const badge = same.element.querySelector('.count') ?? same.element.insertBefore(h('span', {class: 'count chip'}), same.element.lastChild);
      badge.textContent = `×${same.count}`;
      clearTimeout(same.timer);
      same.timer = setTimeout(() => this.hide(short), stay_ms);
      return;
    }
    this.hide(short);
    while (this.shown.size >= 5) this.hide(this.shown.keys().next().value as string);
    const element = h('div', {class: `toast ${kind}`}, h('span', {class: 'grow'}, short));
    if (button) {
      element.append(h('button', {class: 'small', on: {click: () => {
        this.hide(short);
        button.run();
      }}}, button.label));
    }
    element.append(h('button', {class: 'plain small icon-only', 'aria-label': 'Dismiss', title: 'Dismiss', on: {click: () => this.hide(short)}}, icon('close', 12)));
    this.element.append(element);
    this.shown.set(short, {element, count: 1, timer: setTimeout(() => this.hide(short), stay_ms)});
  }

  private hide(text: string): void {
    const entry = this.shown.get(text);
    if (!entry) return;
    clearTimeout(entry.timer);
    entry.element.remove();
    this.shown.delete(text);
  }
}

/** Candidates for a text field, chosen with the arrow keys, Tab or Enter. */
export class Suggestions {
  private popover: HTMLElement | null = null;
  private candidates: string[] = [];
  private at = -1;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly input: HTMLInputElement, private readonly ask: (text: string) => Promise<string[]>,
              private readonly take: (candidate: string) => void, automatic = true) {
    input.autocomplete = 'off';
    input.spellcheck = false;
    if (automatic) {
      input.addEventListener('input', () => {
        clearTimeout(this.timer);
        this.timer = setTimeout(() => void this.refresh(), 120);
      });
    }
    input.addEventListener('keydown', (event) => this.key(event), true);
    input.addEventListener('blur', () => setTimeout(() => this.close(), 150));
  }

  async refresh(): Promise<string[]> {
    const text = this.input.value;
    const candidates = await this.ask(text);
    if (this.input.value !== text || document.activeElement !== this.input) return [];
    this.show(candidates.slice(0, 60));
    return candidates;
  }

  show(candidates: string[]): void {
    this.close();
    if (candidates.length === 0) return;
    this.candidates = candidates;
    const box = this.input.getBoundingClientRect();
    this.popover = h('div', {class: 'popover', role: 'listbox'});
    candidates.forEach((candidate) => this.popover?.append(h('div', {role: 'option', on: {pointerdown: (event) => {
      event.preventDefault();
      this.choose(candidate);
    }}}, candidate)));
    document.body.append(this.popover);
    this.popover.style.left = `${box.left}px`;
    this.popover.style.minWidth = `${Math.min(box.width, 300)}px`;
    const height = this.popover.offsetHeight;
    this.popover.style.top = `${box.bottom + height + 6 > innerHeight ? box.top - height - 4 : box.bottom + 4}px`;
  }

  get open(): boolean {
    return this.popover !== null;
  }

  close(): void {
    // What was typed a moment ago is not asked for any more.
    clearTimeout(this.timer);
    this.popover?.remove();
    this.popover = null;
    this.at = -1;
  }

  private choose(candidate: string): void {
    this.close();
    this.take(candidate);
  }

  private key(event: KeyboardEvent): void {
    if (!this.popover) return;
    if (event.key === 'ArrowDown' || event.key === 'ArrowUp') {
      this.at = (this.at + (event.key === 'ArrowDown' ? 1 : this.candidates.length - 1 + (this.at < 0 ? 1 : 0))) % this.candidates.length;
      [...this.popover.children].forEach((row, i) => {
        row.setAttribute('aria-selected', String(i === this.at));
        if (i === this.at) row.scrollIntoView({block: 'nearest'});
      });
    } else if ((event.key === 'Tab' && this.candidates.length > 0) || (event.key === 'Enter' && this.at >= 0)) {
      this.choose(this.candidates[Math.max(0, this.at)] as string);
    } else if (event.key === 'Escape') {
      this.close();
    } else {
      return;
    }
    event.preventDefault();
    event.stopImmediatePropagation();
  }
}
