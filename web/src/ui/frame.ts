// The frame of the page: sides and dock that can be resized and folded away, and remember it.
import {remember, remembered} from '../app/settings';
import type {Panel} from '../app/context';
import {h, setText} from './dom';
import {icon} from './icons';

type Side = 'left' | 'right' | 'dock';
type PhonePanel = 'none' | 'tree' | 'inspect' | 'dock';

const limits_px: Record<Side, [number, number]> = {left: [160, 480], right: [240, 560], dock: [120, 620]};

export interface Pane {
  id: string;
  title: string;
  panel: Panel;
}

export class Frame {
  readonly element = h('div', {class: 'frame'});
  readonly left = h('aside', {class: 'side left', 'aria-label': 'What is in the world'});
  readonly right = h('aside', {class: 'side right', 'aria-label': 'What is selected'});
  readonly sceneHost = h('main', {class: 'scene-host', 'aria-label': 'Scene'});
  private readonly tabs = h('div', {class: 'tabs', role: 'tablist'});
  private readonly paneHost = h('div', {class: 'pane-host'});
  private readonly dock = h('section', {class: 'dock', 'aria-label': 'Panels'}, this.tabs, this.paneHost);
  private readonly phoneTabs = h('nav', {class: 'phone-tabs', 'aria-label': 'Panels'});
  private readonly panes = new Map<string, {pane: Pane; tab: HTMLButtonElement; badge: HTMLElement}>();
  private active = remembered('dock.tab', 'plots');
  private chosen = remembered('dock.tab', '') !== '';
  private readonly narrow = matchMedia('(max-width: 720px)');
  private fold: Record<Side, boolean> = {...{left: false, right: false, dock: innerHeight < 620}, ...remembered<Partial<Record<Side, boolean>>>('frame.folded', {})};
  private phone: PhonePanel = 'none';
  /** Told when a side is shown or hidden. */
  onShown: () => void = () => undefined;

  constructor(bar: HTMLElement) {
    for (const side of ['left', 'right', 'dock'] as Side[]) {
      const size = remembered<number>(`frame.${side}`, 0);
      if (size > 0) this.setSize(side, size);
      ({left: this.left, right: this.right, dock: this.dock})[side].append(this.grip(side));
    }
    this.element.append(bar, this.left, this.sceneHost, this.right, this.dock, this.phoneTabs);
    this.tabs.append(h('span', {class: 'grow'}), h('button', {
      class: 'plain small icon-only tab-tools', title: 'Fold or unfold the panels', 'aria-label': 'Fold or unfold the panels', on: {click: () => this.toggle('dock')},
    }, icon('panelBottom', 14)));
    this.narrow.addEventListener('change', () => this.apply());
    this.apply();
  }

  addPane(pane: Pane): void {
    const badge = h('span', {class: 'badge hidden'});
    const tab = h('button', {class: 'tab', role: 'tab', 'aria-selected': 'false', testid: `tab-${pane.id}`, on: {click: () => {
      if (pane.id === this.active && !this.fold.dock && !this.narrow.matches) return;
      this.open(pane.id);
    }}}, pane.title, badge);
    tab.addEventListener('keydown', (event) => {
      if (event.key !== 'ArrowRight' && event.key !== 'ArrowLeft') return;
      const all = [...this.panes.values()].map((p) => p.tab);
      all[(all.indexOf(tab) + (event.key === 'ArrowRight' ? 1 : all.length - 1)) % all.length]?.focus();
    });
    this.tabs.insertBefore(tab, this.tabs.querySelector('.grow'));
    pane.panel.element.setAttribute('role', 'tabpanel');
    this.paneHost.append(pane.panel.element);
    this.panes.set(pane.id, {pane, tab, badge});
    if (!this.panes.has(this.active) && this.panes.size > 6) this.active = 'plots';
    this.apply();
  }

  setBadge(id: string, text: string): void {
    const entry = this.panes.get(id);
    if (!entry) return;
    setText(entry.badge, text);
    entry.badge.classList.toggle('hidden', text === '');
  }

  /** Whether there is something behind a tab; the tab goes otherwise, unless it is open. */
  setPresent(id: string, present: boolean): void {
    const entry = this.panes.get(id);
    if (entry) entry.tab.hidden = !present && id !== this.active;
  }

  addPhoneTab(panel: PhonePanel, title: string, iconName: string, pane?: string): void {
    this.phoneTabs.append(h('button', {
      'data-phone': panel, 'data-pane': pane ?? '', 'aria-pressed': 'false', on: {click: () => {
        const same = this.phone === panel && (pane === undefined || this.active === pane);
        this.phone = same ? 'none' : panel;
        if (pane) this.chosen = true;
        if (pane && !same) this.active = pane;
        this.apply();
      }},
    }, icon(iconName, 18), title));
  }

  /** Shows a pane behind its tab, once, unless somebody has chosen one, here or in an earlier visit. */
  suggest(id: string): void {
    if (this.chosen || !this.panes.has(id)) return;
    this.chosen = true;
    this.active = id;
    this.apply();
  }

  open(id: string): void {
    if (!this.panes.has(id)) return;
    this.chosen = true;
    this.active = id;
    this.fold.dock = false;
    if (this.narrow.matches) this.phone = 'dock';
    remember('dock.tab', id);
    this.remember();
    this.apply();
  }

  openPhone(panel: PhonePanel): void {
    this.phone = panel;
    this.apply();
  }

  activePane(): string {
    return this.shows('dock') ? this.active : '';
  }

  toggle(side: Side): void {
    this.fold[side] = !this.fold[side];
    this.remember();
    this.apply();
  }

  shows(side: Side): boolean {
    if (this.narrow.matches) return this.phone === (side === 'left' ? 'tree' : side === 'right' ? 'inspect' : 'dock');
    return !this.fold[side];
  }

  private remember(): void {
    remember('frame.folded', this.fold);
  }

  private apply(): void {
    this.element.classList.toggle('no-left', this.fold.left && !this.narrow.matches);
    this.element.classList.toggle('no-right', this.fold.right && !this.narrow.matches);
    this.element.classList.toggle('no-dock', this.fold.dock);
    this.element.dataset.phone = this.phone;
    for (const [id, {pane, tab}] of this.panes) {
      const shown = id === this.active;
      tab.setAttribute('aria-selected', String(shown));
      tab.tabIndex = shown ? 0 : -1;
      pane.panel.element.hidden = !shown;
      pane.panel.setVisible(shown && this.shows('dock'));
    }
    for (const button of this.phoneTabs.querySelectorAll('button')) {
      const pane = button.dataset.pane ?? '';
      button.setAttribute('aria-pressed', String(button.dataset.phone === this.phone && (pane === '' || pane === this.active)));
    }
    this.onShown();
  }

  private setSize(side: Side, size_px: number): number {
    const [least, most] = limits_px[side];
    const room_px = side === 'dock' ? innerHeight * 0.7 : innerWidth * 0.45;
    const size = Math.round(Math.max(least, Math.min(most, room_px, size_px)));
    this.element.style.setProperty(`--${side}-px`, `${size}px`);
    return size;
  }

  private grip(side: Side): HTMLElement {
    const title = 'Drag to resize, double click to fold';
    const grip = h('div', {class: 'grip', role: 'separator', title, tabindex: '0', 'aria-label': `Size of the ${side} panel`, 'aria-orientation': side === 'dock' ? 'horizontal' : 'vertical'});
    const host = side === 'left' ? this.left : side === 'right' ? this.right : this.dock;
    const now = (): number => (side === 'dock' ? host.offsetHeight : host.offsetWidth);
    const sign = side === 'left' ? 1 : -1;
    grip.addEventListener('pointerdown', (down) => {
      const start = now();
      grip.setPointerCapture(down.pointerId);
      grip.classList.add('held');
      const move = (event: PointerEvent): void => {
        const by = side === 'dock' ? event.clientY - down.clientY : event.clientX - down.clientX;
        remember(`frame.${side}`, this.setSize(side, start + sign * by));
      };
      const up = (): void => {
        grip.classList.remove('held');
        grip.removeEventListener('pointermove', move);
        grip.removeEventListener('lostpointercapture', up);
      };
      grip.addEventListener('pointermove', move);
      grip.addEventListener('lostpointercapture', up);
    });
    grip.addEventListener('dblclick', () => this.toggle(side));
    grip.addEventListener('keydown', (event) => {
      const by = {ArrowRight: 16, ArrowLeft: -16, ArrowDown: 16, ArrowUp: -16}[event.key];
      if (by === undefined || (side === 'dock') !== (event.key === 'ArrowUp' || event.key === 'ArrowDown')) return;
      event.preventDefault();
      event.stopPropagation();
      remember(`frame.${side}`, this.setSize(side, now() + sign * by));
    });
    return grip;
  }
}
