// The part of the inspector from which a robot is driven.
import type {Context} from '../app/context';
import type {Instance} from '../protocol';
import {h, setReason, setText} from './dom';
import {icon} from './icons';
import {heading} from './pose_section';
import {driveOf, Teleop} from './teleop';

export class DriveSection {
  readonly element = h('section', {class: 'block drive'});
  private readonly button = h('button', {testid: 'drive'}, icon('gamepad', 14), h('span', {}, 'Drive'));
  private readonly stop: () => void;

  constructor(private readonly context: Context, private readonly teleop: Teleop, private readonly instance: Instance) {
    const drive = driveOf(instance);
    this.element.append(heading('Drive'));
    if (!drive) {
      this.element.append(h('div', {class: 'none faint'}, 'No drive that takes a twist'));
      this.stop = () => undefined;
      return;
    }
    this.button.addEventListener('click', () => (teleop.armed === instance.name ? teleop.disarm() : teleop.arm(instance.name)));
    this.element.append(h('div', {class: 'drive-row'}, this.button, h('span', {class: 'mono faint ellipsis', title: `${drive.topic}, ${drive.type}`}, drive.topic)));
    this.element.append(this.limit('Speed', 'm/s', 0.05, 3, 0.05, () => teleop.linear_mps, (v) => teleop.setLimits(v, teleop.angular_radps)),
        this.limit('Turning', 'rad/s', 0.1, 6, 0.1, () => teleop.angular_radps, (v) => teleop.setLimits(teleop.linear_mps, v)));
    const active = (instance.controllers ?? []).filter((c) => !c.inactive);
    if (active.length > 0) {
      this.element.append(h('p', {class: 'note'}, `Active controllers: ${active.map((c) => c.name).join(', ')}. While you steer, only you are heard; let go, and the robot goes on by itself.`));
    }
    this.stop = teleop.onChange.on(() => this.steering());
    this.steering();
  }

  private limit(label: string, unit: string, min: number, max: number, step: number, get: () => number, set: (v: number) => void): HTMLElement {
    const text = h('span', {class: 'number'});
    const slider = h('input', {type: 'range', min, max, step, 'aria-label': `${label} limit, ${unit}`});
    slider.value = String(get());
    const show = (): void => setText(text, `${Number(slider.value).toFixed(2)} ${unit}`);
    slider.addEventListener('input', () => {
      set(Number(slider.value));
      show();
    });
    show();
    return h('label', {class: 'limit'}, h('span', {}, label), slider, text);
  }

  steering(): void {
    const armed = this.teleop.armed === this.instance.name;
    this.button.className = armed ? 'on' : '';
    setText(this.button.lastElementChild as Element, armed ? 'Stop driving' : 'Drive');
    setReason(this.button, this.context.store.whyNotSteer(), armed ? 'Let go (Esc)' : 'Drive with W A S D, the arrow keys, the stick or a gamepad');
  }

  close(): void {
    this.stop();
  }
}
