// The panel of a robot: its screen, the keys under it, and what its speaker plays.
//
// A screen is shown pixel by pixel, from the raw images: JPEG would blur its letters. Keys are pressed by the console command `press`, with
// its rights.
import type {Context} from '../app/context';
import {formatNumber, word} from '../app/format';
import type {Device, Instance} from '../protocol';
import {clear, h, setReason, setText} from './dom';
import {icon} from './icons';

interface Screen {
  width: number;
  height: number;
  step: number;
  encoding: string;
  data: Uint8Array;
}

/** RGBA of an rgb8 image; null for what is no such image. */
export function rgbaOf(image: Screen): Uint8ClampedArray | null {
  const {width, height, step, data} = image;
  const fits = image.encoding === 'rgb8' && width > 0 && height > 0 && width <= 4096 && height <= 4096 && step >= 3 * width && data.length >= step * height;
  if (!fits) return null;
  const pixels = new Uint8ClampedArray(4 * width * height);
  for (let y = 0, to = 0; y < height; ++y) {
    for (let x = 0, from = y * step; x < width; ++x, from += 3, to += 4) {
      pixels[to] = data[from];
      pixels[to + 1] = data[from + 1];
      pixels[to + 2] = data[from + 2];
      pixels[to + 3] = 255;
    }
  }
  return pixels;
}

/** The pixel under a place of an element that shows the picture whole. */
export function pixelAt(x: number, y: number, box: {left: number; top: number; width: number; height: number}, width: number, height: number): [number, number] {
  const within = (at: number, size: number, count: number): number => Math.max(0, Math.min(count - 1, Math.floor((at / size) * count)));
  return [within(x - box.left, box.width, width), within(y - box.top, box.height, height)];
}

/** "440 Hz" or the name of a recording. */
export function soundText(sound: {frequency: number; name: string}): string {
  return sound.name !== '' ? sound.name : `${formatNumber(sound.frequency, 4)} Hz`;
}

/** Colours of the keys, from the left; further ones have none. */
const key_colors = ['red', 'green', 'yellow', 'blue'];
const usual_keys = 4;

export const hasPanel = (instance: Instance): boolean => (instance.devices ?? []).some((d) => d.kind === 'screen' || d.kind === 'keys' || d.kind === 'speaker');

export class RobotPanel {
  private readonly canvas = h('canvas', {class: 'lcd', width: 4, height: 3, hidden: true, testid: 'lcd', 'aria-label': 'Screen of the robot'});
  private readonly dark = h('div', {class: 'lcd-dark faint'}, 'Nothing drawn yet');
  private readonly keyRow = h('div', {class: 'lcd-keys'});
  private readonly sound = h('span', {class: 'sound', hidden: true, testid: 'sound', role: 'status'}, icon('speaker', 14), h('span'));
  private readonly lines = h('pre', {class: 'lcd-text mono', testid: 'lcd-text'});
  private readonly text = h('details', {hidden: true}, h('summary', {}, 'Text'), this.lines);
  /** Name, sound, and the way to the output of its program. */
  readonly head = h('div', {class: 'lcd-head'});
  readonly element = h('div', {class: 'robot-panel', testid: `panel-${this.instance.name}`});
  private readonly screen: Device | undefined;
  private readonly keys: Device | undefined;
  private readonly stops: (() => void)[] = [];
  private buttons: HTMLButtonElement[] = [];
  private own: string[] = Array<string>(usual_keys).fill('');
  private menu: string[] = [];
  private visible = false;

  constructor(private readonly context: Context, private readonly instance: Instance, titled: boolean) {
    const devices = instance.devices ?? [];
    this.screen = devices.find((d) => d.kind === 'screen');
    this.keys = devices.find((d) => d.kind === 'keys');
    const programs = instance.controllers ?? [];
    const output = programs.length > 0 ? h('button', {class: 'plain small', title: 'Output of its program, in the log', testid: 'output', on: {click: () => context.showLog(programs[0].path)}}, icon('terminal', 14), h('span', {}, 'Output')) : null;
    const name = titled ? h('button', {class: 'plain small who ellipsis', title: `Select ${instance.name}`, on: {click: () => context.store.select(instance.name)}}, instance.name) : null;
    this.head.append(...[name, this.sound, h('span', {class: 'grow'}), output].filter((part) => part !== null));
    if (titled) this.element.append(this.head);
    if (this.screen) this.element.append(h('div', {class: 'lcd-frame'}, this.canvas, this.dark));
    if (this.keys) {
      this.element.append(this.keyRow);
      this.showKeys();
      void this.readKeys(this.keys);
    }
    if (this.screen) this.element.append(this.text);
    this.canvas.addEventListener('click', (event) => {
      if (!this.keys) return;
      const [x, y] = pixelAt(event.clientX, event.clientY, this.canvas.getBoundingClientRect(), this.canvas.width, this.canvas.height);
      void context.steer.say(`press ${word(this.keys.path)} touch ${x} ${y}`, true);
    });
    this.steering();
  }

  /** How many keys there are, and their labels when no program gives them others. */
  private async readKeys(keys: Device): Promise<void> {
    const answer = await this.context.steer.ask(`show ${word(`${keys.path}.parameter.count`)} --json`);
    const count = answer.ok ? Number(/"value":\s*(\d+)/.exec(answer.text)?.[1]) : Number.NaN;
    if (!(count >= 0 && count <= 64)) return;
    this.own = Array<string>(count).fill('');
    this.showKeys();
  }

  private showKeys(): void {
    const {keys} = this;
    if (!keys) return;
    if (this.buttons.length !== this.own.length) {
      this.buttons = this.own.map((_, i) => h('button', {class: `lcd-key ${key_colors[i] ?? ''}`, testid: `key-${i + 1}`, on: {click: () => void this.context.steer.say(`press ${word(keys.path)} ${i + 1}`, true)}}));
      clear(this.keyRow);
      this.keyRow.append(...this.buttons);
    }
    this.buttons.forEach((button, i) => setText(button, (this.menu[i] ?? '') || `KEY${i + 1}`));
    this.buttons.forEach((button, i) => button.classList.toggle('unnamed', !this.menu[i]));
    this.steering();
  }

  steering(): void {
    const reason = this.context.store.whyNotSteer();
    this.buttons.forEach((button, i) => setReason(button, reason, `Press key ${i + 1}`));
    this.canvas.title = reason === null && this.keys ? 'Click to touch the screen' : '';
  }

  setVisible(visible: boolean): void {
    if (visible === this.visible) return;
    this.visible = visible;
    if (visible) this.listen();
    else this.close();
  }

  private listen(): void {
    for (const device of this.instance.devices ?? []) {
      for (const topic of device.topics ?? []) {
        const take = device.kind === 'screen' && topic.type.endsWith('/Image') ? this.draw
          : device.kind === 'screen' && topic.type.endsWith('/ScreenText') ? this.write
          : device.kind === 'speaker' && topic.type.endsWith('/SpeakerState') ? this.hear : null;
        if (take) this.stops.push(this.context.client.subscribe(topic.name, (message) => {
          const value = message.value();
          if (value) take(value);
        }));
      }
    }
  }

  private readonly draw = (value: unknown): void => {
    const image = value as Screen;
    const pixels = rgbaOf(image);
    if (!pixels) return;
    if (this.canvas.width !== image.width) this.canvas.width = image.width;
    if (this.canvas.height !== image.height) this.canvas.height = image.height;
    // Small screens are magnified by whole numbers.
    this.canvas.style.width = `${image.width * Math.max(1, Math.floor(256 / image.width))}px`;
    // Wider ones are drawn smaller than they are: letters would lose lines of theirs.
    this.canvas.style.imageRendering = image.width > 256 ? 'auto' : 'pixelated';
    this.canvas.getContext('2d')?.putImageData(new ImageData(pixels, image.width, image.height), 0, 0);
    this.canvas.hidden = false;
    this.dark.hidden = true;
  };

  private readonly write = (value: unknown): void => {
    const {lines, menu} = value as {lines: string[]; menu: string[]};
    this.menu = menu;
    setText(this.lines, lines.join('\n'));
    this.text.hidden = lines.every((line) => line === '');
    this.showKeys();
  };

  private readonly hear = (value: unknown): void => {
    const {playing, sound} = value as {playing: boolean; sound: {frequency: number; name: string}};
    this.sound.hidden = !playing;
    setText(this.sound.lastElementChild as Element, soundText(sound));
    this.sound.title = playing ? `The speaker plays ${soundText(sound)}` : '';
  };

  close(): void {
    for (const stop of this.stops.splice(0)) stop();
  }
}

/** The panel in the inspector of its robot. */
export class RobotPanelSection {
  private readonly panel: RobotPanel;
  readonly element: HTMLElement;

  constructor(context: Context, instance: Instance) {
    this.panel = new RobotPanel(context, instance, false);
    this.element = h('section', {class: 'block'}, h('div', {class: 'lcd-title'}, h('h3', {}, 'Panel'), this.panel.head), this.panel.element);
    this.panel.setVisible(true);
  }

  steering(): void {
    this.panel.steering();
  }

  close(): void {
    this.panel.close();
  }
}
