// Adds an object: a model of the world or of the models folder, or a box, sphere or cylinder; placed by a click in the scene.
import type {Context} from '../app/context';
import {parseNumber, word} from '../app/format';
import {plain} from '../app/steer';
import {h} from './dom';
import {icon} from './icons';
import {openDialog} from './overlays';

interface ListedModel {
  name: string;
  help: string;
}

const primitives: [string, string, string][] = [['box', 'Box', '0.4 0.4 0.4'], ['sphere', 'Sphere', '0.4'], ['cylinder', 'Cylinder', '0.4 0.4']];
const sizeHints: Record<string, string> = {box: 'Size x y z', sphere: 'Diameter', cylinder: 'Diameter, height'};

/** `known`: the number of instances tells a name that is free. */
export function freeName(stem: string, taken: (name: string) => boolean): string {
  const base = stem.replace(/\d+$/, '').replace(/[^\w-]+/g, '_') || 'object';
  if (!taken(stem) && stem !== '') return stem;
  for (let n = 2; ; n++) if (!taken(`${base}${n}`)) return `${base}${n}`;
}

export function colorWords(hex: string): string {
  return [1, 3, 5].map((at) => Number((parseInt(hex.slice(at, at + 2), 16) / 255).toFixed(3))).join(',');
}

export function openAdd(context: Context, place: (what: string, put: (x: number, y: number) => void) => void): void {
  const {steer, store} = context;
  let model = 'box';
  const search = h('input', {type: 'search', placeholder: 'Find a model', 'aria-label': 'Find a model'});
  const list = h('div', {class: 'model-list', role: 'listbox', 'aria-label': 'Models'});
  const name = h('input', {'aria-label': 'Name', testid: 'add-name'});
  const size = h('input', {class: 'number', 'aria-label': 'Size, m'});
  const color = h('input', {type: 'color', value: '#d9822b', 'aria-label': 'Colour'});
  const mass = h('input', {class: 'number', value: '1', 'aria-label': 'Mass, kg'});
  const sizeLabel = h('span', {}, 'Size');
  const onlyPrimitives = h('div', {class: 'form-grid'}, sizeLabel, h('div', {class: 'with-unit'}, size, h('span', {class: 'unit'}, 'm')), h('span', {}, 'Colour'), color, h('span', {}, 'Mass'), h('div', {class: 'with-unit'}, mass, h('span', {class: 'unit'}, 'kg')));
  let models: ListedModel[] = [];
  let named = false;
  name.addEventListener('input', () => (named = true));

  const choose = (which: string): void => {
    model = which;
    const primitive = primitives.find((p) => p[0] === which);
    onlyPrimitives.hidden = !primitive;
    if (primitive) {
      size.value = primitive[2];
      sizeLabel.textContent = sizeHints[which] ?? 'Size';
    }
    if (!named) name.value = freeName((which.split('/').slice(-2)[0] ?? which).replace(/\.\w+$/, ''), (n) => store.instance(n) !== undefined);
    for (const row of list.children) row.setAttribute('aria-selected', String((row as HTMLElement).dataset.model === which));
  };
  const show = (): void => {
    const text = search.value.trim().toLowerCase();
    const entries = [...primitives.map(([id, title]) => ({id, title, help: '', symbol: 'box'})), ...models.map((m) => ({id: m.name, title: m.name, help: m.help, symbol: 'robot'}))].filter((e) => `${e.title} ${e.help}`.toLowerCase().includes(text));
    list.replaceChildren(...entries.slice(0, 300).map((e) => h('button', {class: 'plain part-row', role: 'option', 'data-model': e.id, title: e.help, on: {click: () => choose(e.id)}}, icon(e.symbol, 14), h('span', {class: 'ellipsis'}, e.title), h('span', {class: 'faint ellipsis'}, e.help))));
    choose(model);
  };
  search.addEventListener('input', show);
  void steer.list<ListedModel[]>('models').then((listed) => {
    models = (Array.isArray(listed) ? listed : []).filter((m) => typeof m?.name === 'string' && !primitives.some((p) => p[0] === m.name));
    show();
  });

  const words = (): string[] | null => {
    if (!primitives.some((p) => p[0] === model)) return [];
    const sizes = size.value.split(/[\s,x×]+/).filter((s) => s !== '').map(parseNumber);
    const kilograms = parseNumber(mass.value);
    size.classList.toggle('wrong', sizes.length === 0 || sizes.some((s) => s === null || s <= 0));
    mass.classList.toggle('wrong', kilograms === null || kilograms <= 0);
    if (size.classList.contains('wrong') || mass.classList.contains('wrong')) return null;
    return [`size=${sizes.map((s) => plain(s as number)).join(',')}`, `color=${colorWords(color.value)}`, `mass=${plain(kilograms as number)}`];
  };
  const go = h('button', {class: 'main', testid: 'add-place', on: {click: () => {
    const more = words();
    if (more === null) return;
    const what = freeName(name.value.trim() || 'object', (n) => store.instance(n) !== undefined);
    dialog.close();
    place(what, (x, y) => {
      const line = ['add', word(model), word(what), plain(x), plain(y), ...more].join(' ');
      void steer.say(line).then((answer) => {
        if (answer.ok) setTimeout(() => store.select(what), 200);
      });
    });
  }}}, 'Place in the scene');
  const cancel = h('button', {on: {click: () => dialog.close()}}, 'Cancel');
  const dialog = openDialog('Add an object', h('div', {class: 'add-body'}, search, list, h('div', {class: 'form-grid'}, h('span', {}, 'Name'), name), onlyPrimitives), [cancel, go]);
  show();
}
