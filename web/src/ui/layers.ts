// The legend of the layers: what is drawn of a robot's maps, plans and estimates, in which colour, each with its switch.
import type {Layer, Layers} from '../app/layers';
import {remember, remembered} from '../app/settings';
import {LAYER_COLORS} from '../scene/overlays/layers';
import {h, setText, setTitle, svg} from './dom';
import {icon} from './icons';
import {openMenu} from './overlays';

/** Texts change with each message: not more often than one can read. */
const texts_ms = 250;

function swatch(layer: Layer): Element {
  const picture = svg('svg', {viewBox: '0 0 22 14', width: 22, height: 14, 'aria-hidden': 'true'});
  switch (layer.kind) {
    case 'map':
      picture.append(svg('rect', {x: 1, y: 1, width: 20, height: 12, rx: 2, class: 'free'}), svg('path', {d: 'M1 3.5h7v4h5V1', class: 'wall'}), svg('rect', {x: 14, y: 8, width: 3, height: 3, class: 'cost'}));
      break;
    case 'path':
      picture.append(svg('path', {d: 'M2 11 8 5l6 3 6-5', class: 'stroke thick'}), svg('circle', {cx: 8, cy: 5, r: 2.3, class: 'fill'}), svg('circle', {cx: 14, cy: 8, r: 2.3, class: 'fill'}));
      break;
    case 'particles':
      for (const [x, y, turn] of [[5, 5, 0], [10, 9, -20], [12, 4, 15], [17, 8, -5]] as const) picture.append(svg('path', {d: 'M3 0-2 2-1 0-2-2z', transform: `translate(${x} ${y}) rotate(${turn})`, class: 'fill'}));
      break;
    case 'pose':
      picture.append(svg('ellipse', {cx: 11, cy: 7, rx: 9.5, ry: 5.5, class: 'stroke soft'}), svg('path', {d: 'M6 0-4 3.6-2 0-4-3.6z', transform: 'translate(10.5 7)', class: 'fill'}));
  }
  return picture;
}

interface Row {
  element: HTMLButtonElement;
  info: HTMLElement;
  key: string;
}

export class LayersLegend {
  private readonly body = h('div', {class: 'legend-body', hidden: true});
  private readonly fold = h('button', {class: 'plain small legend-head', testid: 'layers-fold', on: {click: () => this.choose()}}, icon('chevron', 12), h('span', {}, 'Layers'));
  readonly element = h('section', {class: 'float legend', 'aria-label': 'Layers', hidden: true, testid: 'layers'}, this.fold, this.body);
  /** 'yes' or 'no' by the user; else it is folded until something of it is drawn. */
  private chosen = remembered<string>('layers.fold', '');
  private used = false;
  private readonly rows = new Map<string, Row>();
  private built = '';
  private timer: ReturnType<typeof setTimeout> | undefined;
  private wanted = true;

  constructor(private readonly layers: Layers) {
    layers.onChange.on(() => this.soon());
  }

  setShown(shown: boolean): void {
    this.wanted = shown;
    this.show();
  }

  private choose(): void {
    this.chosen = this.body.hidden ? 'no' : 'yes';
    remember('layers.fold', this.chosen);
    this.showFold();
  }

  private toggle(layer: Layer): void {
    this.used = true;  // who switches the last one off may want it again
    this.layers.toggle(layer.topic);
  }

  private showFold(): void {
    const folded = this.chosen === '' ? !this.used && this.layers.list.every((layer) => !layer.on) : this.chosen === 'yes';
    if (folded === this.body.hidden && this.fold.title !== '') return;
    this.body.hidden = folded;
    this.fold.setAttribute('aria-expanded', String(!folded));
    this.fold.title = folded ? 'Show which layers are drawn' : 'Fold the list of layers';
  }

  private soon(): void {
    this.timer ??= setTimeout(() => {
      this.timer = undefined;
      this.show();
    }, this.built === '' ? 0 : texts_ms);
  }

  private show(): void {
    const {list, hidden} = this.layers;
    this.element.hidden = !this.wanted || list.length === 0;
    if (this.element.hidden) return;
    const wanted = JSON.stringify([list.map((l) => [l.topic, l.owner, l.color]), hidden]);
    if (wanted !== this.built) {
      this.built = wanted;
      this.build();
    }
    for (const layer of list) this.showRow(layer);
    this.showFold();
  }

  private build(): void {
    this.rows.clear();
    this.body.replaceChildren();
    let owner: string | null = null;
    for (const layer of this.layers.list) {
      if (layer.owner !== owner) {
        owner = layer.owner;
        this.body.append(this.head(layer.owner));
      }
      const info = h('span', {class: 'info'});
      const [light, dark] = LAYER_COLORS[layer.color % LAYER_COLORS.length] as readonly [string, string];
      const element = h('button', {class: 'plain layer', testid: 'layer', 'data-topic': layer.topic, style: {'--light': light, '--dark': dark}, on: {click: () => this.toggle(layer)}},
          swatch(layer), h('span', {class: 'name ellipsis'}, layer.label), info);
      this.rows.set(layer.topic, {element, info, key: ''});
      this.body.append(element);
    }
    const {hidden} = this.layers;
    if (hidden > 0) this.body.append(h('div', {class: 'faint more'}, `${hidden} more ${hidden === 1 ? 'robot' : 'robots'}: select one`));
  }

  private head(owner: string): HTMLElement {
    const frames = h('button', {class: 'plain small icon-only', title: 'Where frames are', 'aria-label': `Where frames of ${owner} are`, on: {click: () => this.openFrames(frames, owner)}}, icon('dots', 12));
    return h('div', {class: 'owner'}, h('span', {class: 'ellipsis'}, owner === '' ? 'Of no robot' : owner), owner === '' ? null : frames);
  }

  private openFrames(at: HTMLElement, owner: string): void {
    const frames = this.layers.frames(owner);
    openMenu(at, frames.length === 0 ? [{heading: 'All frames are known'}] : frames.flatMap(({frame, place, told}) => [
      {heading: frame},
      ...(told ? [{label: 'Where a program says', checked: place === 'told', run: () => this.layers.setPlace(frame, 'told')}] : []),
      {label: `Where ${owner} began`, checked: place === 'start', run: () => this.layers.setPlace(frame, 'start')},
      {label: 'The world’s', checked: place === 'world', run: () => this.layers.setPlace(frame, 'world')},
    ]));
  }

  private showRow(layer: Layer): void {
    const row = this.rows.get(layer.topic);
    if (!row) return;
    const key = `${layer.on} ${layer.info} ${layer.note} ${layer.frame}`;
    if (key === row.key) return;
    row.key = key;
    row.element.setAttribute('aria-pressed', String(layer.on));
    row.element.classList.toggle('noted', layer.note !== '');
    setText(row.info, !layer.on ? 'off' : layer.note !== '' && layer.info === '' ? 'not drawn' : layer.info);
    setTitle(row.element, [`${layer.topic} (${layer.type})`, layer.frame === null ? '' : `in ${layer.frame === '' ? 'no frame' : layer.frame}`, layer.kind === 'pose' && layer.info !== '' ? 'The ellipse is two standard deviations' : '', layer.note]
      .filter((line) => line !== '').join('\n'));
  }
}
