// Sliders of error models: the stages of noise that devices have, and what media lose. One slider sets all devices of its kind in its scope.
import type {Context} from '../app/context';
import {word} from '../app/format';
import {worldParts} from '../app/store';
import type {Device, Instance, World} from '../protocol';
import {h} from './dom';
import {FieldRow} from './field_row';
import {FieldView, fieldViews} from './forms';
import {heading} from './pose_section';
import type {Listed} from './readings';

/** A parameter that a slider shows, and all that it sets. */
export interface ErrorSlider {
  view: FieldView;
  addresses: string[];
}

/** Fields of stages that are no strength of an error. */
const passed = new Set(['mean', 'channels', 'whole', 'seed']);
const shares = new Set(['salt', 'pepper', 'rate', 'probability', 'dead', 'hot']);
const media_errors = new Set(['bit_error_rate', 'drop']);
const models_most = 12;

/** The end of a slider: what a real sensor may have. More can be typed; a larger value that holds already is in the range, too. */
export function sliderMost(name: string, unit: string, value: number): number {
  const usual = shares.has(name) ? 0.2 : ({m: 0.2, rad: 0.2, 'm/s': 0.2, 'rad/s': 0.5, '': 0.2, '1': 0.2} as Record<string, number>)[unit] ?? 1;
  return value > usual ? 10 ** Math.ceil(Math.log10(value)) : usual;
}

/** Stages among the values of a device: "noise.stages[0].gaussian.std" of rover/laser. */
export function errorViews(owner: string, listed: Listed[]): FieldView[] {
  const views: FieldView[] = [];
  for (const {address, unit, help, value} of listed) {
    if (!address.startsWith(`${owner}.`) || value === null) continue;
    const parts = address.slice(owner.length + 1).split('.');
    const name = parts.at(-1) ?? '', stage = parts.at(-2) ?? '';
    if (!/^stages\[\d+\]$/.test(parts.at(-3) ?? '') || passed.has(name)) continue;
    const words = [...parts.slice(0, -3), stage].map((part) => part.replace(/_/g, ' '));
    const most = sliderMost(name, unit, value);
    views.push({path: parts.join('/'), address, label: name.replace(/_/g, ' '), group: words.join(' › '), control: 'number', unit: unit === '1' ? '' : unit, help, tunable: true,
      slider: {min: 0, max: most, step: most / 200}, integer: false, length: 0, fallback: '0', choices: [], min: 0, max: shares.has(name) ? 1 : null});
  }
  return views;
}

/** The sliders of devices: those of each model and kind by its first device, joined over models. */
export function joined(found: {device: Device; views: FieldView[]; same: Device[]}[]): ErrorSlider[] {
  const out = new Map<string, ErrorSlider>();
  for (const {device, views, same} of found)
    for (const view of views) {
      const end = view.address.slice(device.path.length);
      const addresses = same.map((each) => each.path + end);
      const known = out.get(`${device.kind}${end}`);
      if (known) known.addresses.push(...addresses);
      else out.set(`${device.kind}${end}`, {view: {...view, group: `${device.kind.replace(/_/g, ' ')} › ${view.group}`}, addresses});
    }
  return [...out.values()];
}

/** One device of each kind of each model, with all that are like it. */
export function representatives(world: World, instances: Instance[]): {device: Device; same: Device[]}[] {
  const out = new Map<string, {device: Device; same: Device[]}>();
  const models = new Set<string>();
  for (const instance of instances) {
    if (models.size >= models_most && !models.has(instance.model)) continue;
    models.add(instance.model);
    for (const device of instance.devices ?? []) {
      const errs = device.kind.endsWith('_drive') || (world.kinds[device.kind]?.fields ?? []).some((field) => field.path === 'errors');
      if (!errs) continue;
      const key = `${instance.model} ${device.kind}`;
      const known = out.get(key);
      if (known) known.same.push(device);
      else out.set(key, {device, same: [device]});
    }
  }
  return [...out.values()];
}

export class ErrorModels {
  readonly element = h('section', {class: 'block form', testid: 'error-models', hidden: true}, heading('Error models'));
  private rows: FieldRow[] = [];
  private closed = false;
  private readonly closing: (() => void)[] = [];

  /** @param instances  robots whose devices are meant; @param media  whether the world's media are, too */
  constructor(private readonly context: Context, world: World, instances: Instance[], media: boolean) {
    void this.load(world, instances, media);
  }

  private async load(world: World, instances: Instance[], media: boolean): Promise<void> {
    const found = await Promise.all(representatives(world, instances).map(async ({device, same}) => {
      const listed = await this.context.steer.list<Listed[]>(word(device.path));
      return {device, same, views: errorViews(device.path, Array.isArray(listed) ? listed : [])};
    }));
    if (this.closed) return;
    const sliders = joined(found);
    if (media)
      for (const part of worldParts(world).find(({kinds}) => kinds === 'media/')?.parts ?? [])
        for (const view of fieldViews(part.path, world.kinds[`media/${part.kind}`]?.fields ?? []))
          if (media_errors.has(view.path)) sliders.push({view: {...view, group: `${part.kind} › ${part.name}`}, addresses: [view.address]});
    if (sliders.length > 0) this.show(sliders);
  }

  private show(sliders: ErrorSlider[]): void {
    const {parameters} = this.context;
    const rows = new Map<string, FieldRow>();
    let group = '';
    for (const {view, addresses} of sliders) {
      if (view.group !== group) {
        group = view.group;
        this.element.append(h('h4', {}, group));
      }
      const row = new FieldRow(view, {values: parameters.values, set: (_name, value) => parameters.setAll(addresses, value)});
      row.element.title = addresses.length > 1 ? `Sets ${addresses.length} devices` : '';
      rows.set(view.address, row);
      this.element.append(row.element);
    }
    this.rows = [...rows.values()];
    const show = (names: Iterable<string>): void => {
      for (const name of names) rows.get(name)?.show(parameters.values.get(name));
    };
    this.closing.push(parameters.onChange.on(show), parameters.look([...rows.keys()]));
    show([...rows.keys()].filter((name) => parameters.values.has(name)));
    this.steering();
    this.element.hidden = false;
  }

  steering(): void {
    for (const row of this.rows) row.setReason(this.context.store.whyNotSteer());
  }

  close(): void {
    this.closed = true;
    for (const end of this.closing) end();
  }
}
