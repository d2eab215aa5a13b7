// The tree of what is in the world. Only rows in view have elements.
import type {Context, Panel} from '../app/context';
import {ticker} from '../app/ticker';
import {h} from './dom';
import {icon} from './icons';
import {openMenu} from './overlays';
import {Row, rowsOf} from './tree_rows';
import {teamColor} from './teams';

const row_px = 26;
const icons: Record<Row['kind'], string> = {group: '', robot: 'robot', object: 'box', static: 'wall', device: 'chip', controller: 'brain'};

export class Tree implements Panel {
  private readonly filter = h('input', {type: 'search', placeholder: 'Filter', 'aria-label': 'Filter', testid: 'tree-filter'});
  private readonly add = h('button', {class: 'plain icon-only', 'aria-label': 'Add an object', testid: 'add-object'}, icon('plus'));
  private readonly space = h('div', {class: 'tree-space'});
  private readonly scroller = h('div', {class: 'tree-rows', role: 'tree', tabindex: '0', testid: 'tree', 'aria-label': 'Robots and objects'}, this.space);
  private readonly empty = h('div', {class: 'empty'});
  readonly element = h('div', {class: 'tree'}, h('div', {class: 'side-head'}, h('div', {class: 'search grow'}, icon('search', 14), this.filter), this.add), this.scroller, this.empty);
  private rows: Row[] = [];
  private readonly open = new Set<string>(['-group:static']);
  private visible = true;
  private stale = true;

  constructor(private readonly context: Context) {
    const {store, actions} = context;
    const again = (): void => {
      this.stale = true;
      ticker.request(this.update);
    };
    store.onWorld.on(again);
    store.onRole.on(again);
    this.filter.addEventListener('input', again);
    this.filter.title = actions.titleOf('panels.filter', 'Filter by name, team or kind');
    this.filter.addEventListener('keydown', (event) => {
      if (event.key === 'Escape') {
        this.filter.value = '';
        this.filter.blur();
        again();
      } else if (event.key === 'ArrowDown' || event.key === 'Enter') {
        this.scroller.focus();
        const first = this.rows.find((r) => r.kind !== 'group');
        if (first && event.key === 'Enter') store.select(first.key);
      }
    });
    this.add.addEventListener('click', () => actions.run('scene.add'));
    this.scroller.addEventListener('scroll', () => ticker.request(this.draw), {passive: true});
    new ResizeObserver(() => ticker.request(this.draw)).observe(this.scroller);
    store.onSelection.on((address) => {
      if (address !== null) this.reveal(address);
      ticker.request(this.update);
    });
    this.scroller.addEventListener('keydown', (event) => this.key(event));
    again();
  }

  setVisible(visible: boolean): void {
    this.visible = visible;
    if (visible) ticker.request(this.update);
  }

  focusFilter(): void {
    this.filter.focus();
    this.filter.select();
  }

  private readonly update = (): void => {
    if (!this.visible) return;
    if (this.stale) {
      this.stale = false;
      const {store, actions} = this.context;
      this.rows = store.world ? rowsOf(store.world, this.open, this.filter.value) : [];
      this.space.style.height = `${this.rows.length * row_px}px`;
      const reason = store.whyNotSteer();
      this.add.disabled = reason !== null;
      this.add.title = reason ?? actions.titleOf('scene.add');
      this.empty.hidden = this.rows.length > 0;
      this.empty.textContent = !store.world ? 'Waiting for a world' : this.filter.value !== '' ? 'Nothing matches' : 'The world is empty';
    }
    this.draw();
  };

  private readonly draw = (): void => {
    if (!this.visible) return;
    const first = Math.max(0, Math.floor(this.scroller.scrollTop / row_px) - 4);
    const last = Math.min(this.rows.length, Math.ceil((this.scroller.scrollTop + this.scroller.clientHeight) / row_px) + 4);
    const drawn = new Map<string, {signature: string; element: HTMLElement}>();
    for (let i = first; i < last; i++) {
      const row = this.rows[i] as Row;
      // A row that says the same keeps its element: one that is pressed must still be there when it is let go.
      const signature = JSON.stringify([row.kind, row.label, row.detail, row.depth, row.folded, row.team, row.key === this.context.store.selection, row.instance?.id]);
      const known = this.drawn.get(row.key);
      const element = known?.signature === signature ? known.element : this.rowElement(row);
      element.style.top = `${i * row_px}px`;
      drawn.set(row.key, {signature, element});
      if (element.parentElement === null) this.space.append(element);
    }
    for (const [key, {element}] of this.drawn) if (drawn.get(key)?.element !== element) element.remove();
    this.drawn = drawn;
  };

  private drawn = new Map<string, {signature: string; element: HTMLElement}>();

  private rowElement(row: Row): HTMLElement {
    const {store} = this.context;
    const selected = store.selection === row.key;
    const element = h('div', {
      class: `row ${row.kind}${selected ? ' selected' : ''}`, role: 'treeitem', 'aria-level': row.depth + 1, 'aria-selected': String(selected),
      'aria-expanded': row.folded === null ? undefined : String(!row.folded), 'data-address': row.key, title: row.kind === 'group' ? undefined : row.key,
      style: {'padding-left': `${6 + Math.max(0, row.depth - 1) * 16}px`},
      on: {
        click: (event) => {
          if (row.kind === 'group') this.toggle(row);
          else {
            store.select(row.key);
            if (event.detail === 2) this.context.scene.frame(row.instance?.name ?? row.key);
          }
        },
        contextmenu: (event) => {
          if (row.kind === 'group' || !row.instance) return;
          event.preventDefault();
          store.select(row.key);
          this.menu(row, {x: event.clientX, y: event.clientY});
        },
      },
    });
    const twist = h('span', {class: `twist${row.folded === false ? ' open' : ''}`, on: {click: (event) => {
      event.stopPropagation();
      this.toggle(row);
    }}}, row.folded === null ? null : icon('chevron', 12));
    if (row.kind !== 'group') {
      const symbol = h('span', {class: 'symbol'}, icon(icons[row.kind], 14));
      if (row.team !== '') symbol.style.color = teamColor(row.team, store.world);
      element.append(twist, symbol);
    } else {
      element.append(twist);
    }
    element.append(h('span', {class: 'label ellipsis'}, row.label), h('span', {class: 'detail ellipsis'}, row.team !== '' && row.depth === 1 ? row.team : row.detail));
    if (row.kind === 'robot' || row.kind === 'object') {
      element.append(h('button', {class: 'plain small icon-only more', 'aria-label': `More for ${row.label}`, tabindex: '-1', on: {click: (event) => {
        event.stopPropagation();
        store.select(row.key);
        this.menu(row, event.currentTarget as HTMLElement);
      }}}, icon('dots', 14)));
    }
    return element;
  }

  private menu(row: Row, at: HTMLElement | {x: number; y: number}): void {
    const {actions, store} = this.context;
    const reason = store.whyNotSteer();
    openMenu(at, [
      {label: 'Follow', icon: 'follow', run: () => actions.run('robots.follow')},
      {label: 'Frame', icon: 'frame', key: 'F', run: () => actions.run('scene.frame')},
      ...(row.instance?.robot ? [{label: 'Drive', icon: 'gamepad', reason, run: () => actions.run('robots.drive')}] : []),
      'line',
      {label: 'Duplicate', icon: 'copy', reason, run: () => actions.run('scene.duplicate')},
      {label: 'Remove', icon: 'trash', key: 'X', danger: true, reason, run: () => actions.run('scene.remove')},
    ]);
  }

  private toggle(row: Row): void {
    const key = row.kind === 'group' ? `-${row.key}` : row.key;
    if (!this.open.delete(key)) this.open.add(key);
    this.stale = true;
    ticker.request(this.update);
  }

  private reveal(address: string): void {
    const owner = this.context.store.find(address)?.instance;
    if (!owner) return;
    if (owner.name !== address) this.open.add(owner.name);
    if (this.context.store.world) this.rows = rowsOf(this.context.store.world, this.open, this.filter.value);
    this.space.style.height = `${this.rows.length * row_px}px`;
    const at = this.rows.findIndex((r) => r.key === address);
    if (at < 0) return;
    const top = at * row_px;
    const {scrollTop, clientHeight} = this.scroller;
    if (top < scrollTop || top + row_px > scrollTop + clientHeight) this.scroller.scrollTop = top - clientHeight / 2;
  }

  private key(event: KeyboardEvent): void {
    const {store} = this.context;
    const at = this.rows.findIndex((r) => r.key === store.selection);
    const go = (to: number, by: number): void => {
      while (this.rows[to] && this.rows[to]?.kind === 'group') to += by;
      const row = this.rows[to];
      if (row) store.select(row.key);
    };
    const row = this.rows[at];
    if (event.key === 'ArrowDown') go(at + 1, 1);
    else if (event.key === 'ArrowUp') go(at - 1, -1);
    else if (event.key === 'Home') go(0, 1);
    else if (event.key === 'End') go(this.rows.length - 1, -1);
    else if (event.key === 'ArrowRight' && row?.folded === true) this.toggle(row);
    else if (event.key === 'ArrowRight' && row?.folded === false) go(at + 1, 1);
    else if (event.key === 'ArrowLeft' && row?.folded === false) this.toggle(row);
    else if (event.key === 'ArrowLeft' && row && row.depth === 2) store.select(row.instance?.name ?? null);
    else if (event.key === 'ContextMenu' && row) this.menu(row, {x: this.scroller.getBoundingClientRect().left + 40, y: this.scroller.getBoundingClientRect().top + at * row_px - this.scroller.scrollTop + row_px});
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
