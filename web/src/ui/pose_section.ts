// Where something is and how it moves, live; and its pose set by numbers.
import type {Context} from '../app/context';
import {formatFixed, parseNumber, word} from '../app/format';
import {plain} from '../app/steer';
import {ticker} from '../app/ticker';
import {Watch} from '../app/watcher';
import {h, setReason, setText} from './dom';
import {icon} from './icons';
import {draggableValue} from './values';

const rows: [string, string, string, [string, string][]][] = [
  ['Position', 'm', 'pose', [['x', 'x'], ['y', 'y'], ['z', 'z']]],
  ['Angles', 'rad', 'pose', [['roll', 'roll'], ['pitch', 'pitch'], ['yaw', 'yaw']]],
  ['Velocity', 'm/s', 'twist.linear', [['x', 'x'], ['y', 'y'], ['z', 'z']]],
  ['Turning', 'rad/s', 'twist.angular', [['x', 'x'], ['y', 'y'], ['z', 'z']]],
];
const rate_hz = 10;

export class PoseSection {
  readonly element = h('section', {class: 'block pose'});
  private readonly cells: HTMLElement[] = [];
  private readonly inputs: Record<'x' | 'y' | 'z' | 'yaw', HTMLInputElement>;
  private readonly apply = h('button', {class: 'main small', type: 'submit', testid: 'pose-apply'}, 'Apply');
  private readonly take = h('button', {class: 'small', type: 'button', title: 'Fill in where it is now'}, 'Current');
  private readonly watch: Watch;
  private values: ArrayLike<number> = [];

  constructor(private readonly context: Context, private readonly name: string, movable: boolean) {
    const addresses: string[] = [];
    const table = h('div', {class: 'pose-table'});
    for (const [label, unit, base, parts] of rows) {
      table.append(h('span', {class: 'dim', title: unit}, label));
      for (const [part, short] of parts) {
        const address = `${name}.${base}.${part}`;
        const text = h('span', {class: 'v'}, '–');
        const cell = h('button', {class: 'cell number', title: `${address} [${unit}]: click to plot`, 'data-address': address, on: {click: () => context.plot(address, unit)}}, h('i', {}, short.slice(0, 1)), text);
        draggableValue(cell, address, unit);
        addresses.push(address);
        this.cells.push(text);
        table.append(cell);
      }
    }
    const input = (label: string): HTMLInputElement => h('input', {class: 'number', 'aria-label': label, placeholder: label, title: label === 'yaw' ? 'Yaw, rad; “90 deg” works too' : `${label}, m`, testid: `pose-${label}`, autocomplete: 'off', spellcheck: 'false'});
    this.inputs = {x: input('x'), y: input('y'), z: input('z'), yaw: input('yaw')};
    const form = h('form', {class: 'pose-form', on: {submit: (event) => {
      event.preventDefault();
      void this.send();
    }}}, ...Object.values(this.inputs), this.take, this.apply);
    this.take.addEventListener('click', () => this.fill());
    this.element.append(h('h3', {}, 'Pose'), table, movable ? form : '');
    for (const one of Object.values(this.inputs)) one.addEventListener('focus', () => {
      if (Object.values(this.inputs).every((i) => i.value === '')) this.fill();
    });
    this.watch = new Watch(context.client, addresses, rate_hz, (_time, values) => {
      this.values = values;
      ticker.request(this.draw);
    });
    this.steering();
    setTimeout(() => this.fromScene(), 300);
  }

  private fill(): void {
    const at = [0, 1, 2, 5].map((i) => this.values[i] ?? Number.NaN);
    Object.values(this.inputs).forEach((input, i) => {
      input.value = Number.isFinite(at[i]) ? String(Number((at[i] as number).toFixed(4))) : '';
      input.classList.remove('wrong');
    });
  }

  private async send(): Promise<void> {
    const numbers = Object.values(this.inputs).map((input) => {
      const value = parseNumber(input.value);
      input.classList.toggle('wrong', value === null);
      return value;
    });
    if (numbers.includes(null)) return;
    await this.context.steer.say(`pose ${word(this.name)} ${numbers.map((v) => plain(v as number)).join(' ')}`);
  }

  /** A run that stands still may tell no samples: then what the scene knows. */
  private fromScene(): void {
    const pose = this.context.scene.pose(this.name);
    if (this.values.length > 0 || !pose) return;
    const [w, x, y, z] = pose.quaternion;
    const pitch = Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x))));
    this.values = [...pose.position, Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), pitch, Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))];
    this.draw();
  }

  private readonly draw = (): void => {
    this.cells.forEach((cell, i) => setText(cell, formatFixed(this.values[i] ?? Number.NaN, 3)));
  };

  steering(): void {
    const reason = this.context.store.whyNotSteer();
    setReason(this.apply, reason, 'Put it there');
    setReason(this.take, reason, 'Fill in where it is now');
    for (const input of Object.values(this.inputs)) input.disabled = reason !== null;
  }

  close(): void {
    this.watch.close();
  }
}

/** A small heading with a symbol, used by the sections of the inspector. */
export function heading(text: string, symbol?: string): HTMLElement {
  return h('h3', {}, symbol ? icon(symbol, 13) : null, text);
}
