// The bar above: what runs, and its time.
import type {Context} from '../app/context';
import {formatBytes, formatNumber, formatTime} from '../app/format';
import type {Game} from '../app/game';
import {ticker} from '../app/ticker';
import {h, setReason, setText, setTitle, svg} from './dom';
import {icon} from './icons';
import {Timeline} from './timeline';

export const speeds = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50];

export class Bar {
  private readonly name = h('span', {class: 'name ellipsis'});
  private readonly play = h('button', {class: 'play', testid: 'play', 'aria-label': 'Play or pause'}, icon('play'));
  private readonly step = h('button', {class: 'plain icon-only', testid: 'step', 'aria-label': 'One step'}, icon('step'));
  private readonly reset = h('button', {class: 'plain icon-only', testid: 'reset', 'aria-label': 'Reset'}, icon('reset'));
  private readonly speed = h('select', {class: 'quiet', testid: 'speed', 'aria-label': 'Speed'});
  private readonly time = h('span', {class: 'time', testid: 'sim-time'}, '0.00 s');
  private readonly rtf = h('span', {class: 'rtf number', testid: 'rtf', title: 'Real-time factor: simulated seconds per second'});
  private readonly state = h('span', {class: 'chip', testid: 'state'}, h('i', {class: 'dot'}), h('span'));
  private readonly recording = h('span', {class: 'chip recording hidden'}, h('i', {class: 'dot'}), h('span'));
  private readonly viewers = h('button', {class: 'chip viewers-chip', testid: 'viewers', on: {click: () => this.context.openPane('clients')}}, icon('eye', 13), h('span', {}, '1'));
  private readonly role = h('span', {class: 'chip watching hidden', testid: 'role'});
  private readonly themeButton = h('button', {class: 'plain icon-only', testid: 'theme', 'aria-label': 'Dark or light'});
  readonly element: HTMLElement;

  constructor(private readonly context: Context, game: Game) {
    const {actions, store, steer} = context;
    for (const [button, id] of [[this.play, 'time.play'], [this.step, 'time.step'], [this.reset, 'time.reset'], [this.themeButton, 'page.theme']] as const) {
      button.addEventListener('click', () => actions.run(id));
    }
    for (const speed of speeds) this.speed.append(h('option', {value: String(speed)}, `${speed}×`));
    this.speed.append(h('option', {value: 'max'}, 'Max'));
    this.speed.addEventListener('change', () => {
      void steer.say(`speed ${this.speed.value}`);
      this.speed.blur();
    });
    const button = (id: string, iconName: string, label: string): HTMLElement =>
      h('button', {class: 'plain icon-only', title: actions.titleOf(id), 'aria-label': label, on: {click: () => actions.run(id)}}, icon(iconName));
    this.element = h('header', {class: 'bar'},
        h('div', {class: 'brand'}, svg('svg', {viewBox: '0 0 20 20', width: 20, height: 20, 'aria-hidden': 'true'},
            svg('rect', {width: 20, height: 20, rx: 5, fill: 'var(--accent-fill)'}),
            svg('path', {d: 'M4 14 10 5l6 9z', fill: 'none', stroke: '#fff', 'stroke-width': 1.8, 'stroke-linejoin': 'round'})),
          h('b', {}, 'Sandlot'), this.name),
        this.play, this.step, this.reset, this.speed,
        h('div', {class: 'clock'}, this.time, this.rtf),
        h('i', {class: 'break'}), new Timeline(context, game).element, this.recording, this.role, this.state, this.viewers,
        h('span', {class: 'sep'}),
        h('span', {class: 'layout-buttons'}, button('panels.left', 'panelLeft', 'Tree'), button('panels.dock', 'panelBottom', 'Panels below'), button('panels.right', 'panelRight', 'Inspector')),
        h('span', {class: 'palette-button'}, button('page.palette', 'search', 'All commands')), this.themeButton, button('page.help', 'help', 'Help'));
    const request = (): void => ticker.request(this.update);
    store.onStatus.on(request);
    store.onWorld.on(request);
    store.onRole.on(request);
    context.client.onState.on(request);
    this.update();
    this.showTheme();
  }

  showTheme(): void {
    const dark = document.documentElement.dataset.theme === 'dark';
    this.themeButton.replaceChildren(icon(dark ? 'sun' : 'moon'));
    this.themeButton.title = dark ? 'Light theme' : 'Dark theme';
  }

  private playing: boolean | null = null;

  private readonly update = (): void => {
    const {store, client, actions} = this.context;
    const status = store.status;
    const reason = store.whyNotPlay();
    const playing = status?.state === 'playing' || status?.state === 'seeking';
    if (playing !== this.playing) {
      this.playing = playing;
      this.play.replaceChildren(icon(playing ? 'pause' : 'play'));
      this.play.setAttribute('aria-pressed', 'false');
      this.play.setAttribute('aria-label', playing ? 'Pause' : 'Play');
    }
    const name = store.world?.name ?? '';
    setText(this.name, name);
    setTitle(this.name, name);
    const title = name === '' ? 'Sandlot' : `${name} – Sandlot`;
    if (document.title !== title) document.title = title;
    const over = status?.state === 'ended' || status?.state === 'failed';
    const overReason = over && !(status?.may_rewind ?? false) ? `The run has ${status?.state === 'failed' ? 'failed' : 'ended'}` : null;
    setReason(this.play, reason ?? overReason, actions.titleOf('time.play', playing ? 'Pause' : 'Play'));
    setReason(this.step, reason ?? overReason, actions.titleOf('time.step'));
    setReason(this.reset, reason, actions.titleOf('time.reset'));
    setReason(this.speed, reason, 'Speed');
    this.role.classList.toggle('hidden', store.role === '' || store.role === 'admin');
    setText(this.role, store.role === 'admin' ? 'Admin' : 'Watching');
    setTitle(this.role, 'You see everything and can change nothing');
    this.role.dataset.role = store.role;
    this.showState(client.state, status?.state ?? '', status?.reason ?? '');
    if (!status) return;
    setText(this.time, formatTime(status.time_s));
    this.time.dataset.seconds = String(status.time_s);
    this.time.dataset.tick = String(status.tick);
    const factor = status.real_time_factor;
    const runs = status.state === 'playing';
    setText(this.rtf, runs ? `${formatNumber(factor, factor >= 100 ? 3 : 2)}×` : '');
    this.rtf.classList.toggle('late', runs && status.speed !== null && factor < 0.9 * status.speed);
    const chosen = status.speed === null ? 'max' : String(status.speed);
    if (this.speed.value !== chosen && document.activeElement !== this.speed) {
      if (![...this.speed.options].some((o) => o.value === chosen)) {
        this.speed.querySelector('option[data-other]')?.remove();
        this.speed.append(h('option', {value: chosen, 'data-other': '1'}, `${formatNumber(Number(chosen), 3)}×`));
      }
      this.speed.value = chosen;
    }
    this.recording.classList.toggle('hidden', !status.recording);
    if (status.recording) {
      setText(this.recording.lastElementChild as Element, 'Rec');
      setTitle(this.recording, `Recording to ${status.recording.file}: ${status.recording.messages} messages, ${formatBytes(status.recording.bytes)}`);
    }
    setText(this.viewers.lastElementChild as Element, String(status.viewers));
    setTitle(this.viewers, `${status.viewers === 1 ? 'Only you are' : `${status.viewers} are`} connected`);
  };

  private showState(connection: string, state: string, reason: string): void {
    const words: Record<string, [string, string]> = {
      playing: ['Playing', 'good'], paused: ['Paused', ''], seeking: ['Seeking', 'warn'], ended: ['Ended', ''], failed: ['Failed', 'bad'],
    };
    const [text, kind] = connection === 'open' ? words[state] ?? [state === '' ? 'Connected' : state, ''] : connection === 'connecting' ? ['Connecting', 'warn'] : ['Offline', 'bad'];
    setText(this.state.lastElementChild as Element, text);
    this.state.className = `chip ${kind}`;
    this.state.dataset.state = connection === 'open' ? state : connection;
    setTitle(this.state, reason);
  }
}
