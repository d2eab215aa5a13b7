// What floats over the scene: tools, cameras, overlays, video; the stick and the note of the robot that is driven; the veil while there
// is not a connection.
import type {Context} from '../app/context';
import {Goals, inputName, isGoal} from '../app/goals';
import {remember, remembered} from '../app/settings';
import {h, setReason, setText} from './dom';
import {icon} from './icons';
import {openMenu} from './overlays';
import {Stick} from './stick';
import type {Teleop} from './teleop';
import type {Video} from './video';

export type Tool = 'orbit' | 'move' | 'pull' | 'goal';
export type CameraMode = 'orbit' | 'static' | 'follow' | 'tv' | 'race' | 'top' | 'robot';

export const cameras: [CameraMode, string][] = [
  ['orbit', 'Orbit'], ['static', 'Fixed'], ['follow', 'Follow'], ['tv', 'TV'], ['race', 'Race'], ['top', 'From above'], ['robot', 'Robot’s own'],
];

export const overlays: [string, string, boolean][] = [
  ['grid', 'Grid', true], ['shadows', 'Shadows', true], ['names', 'Names', true], ['trails', 'Trails', true], ['links', 'Communication links', true], ['batteries', 'Batteries', true],
  ['scans', 'Laser scans', true], ['ranges', 'Ranges with distances', true], ['frusta', 'Camera views', false], ['objects', 'Detected objects', true], ['velocity', 'Velocities', false], ['frames', 'Frames', false], ['contacts', 'Contacts', false], ['collisions', 'Collision shapes', false], ['teams', 'Team colours', true],
  ['layers', 'Maps, plans and estimates', true],
];

export class SceneTools {
  tool: Tool = 'orbit';
  readonly on: Record<string, boolean> = {...Object.fromEntries(overlays.map(([id, , standard]) => [id, standard])), ...remembered<Record<string, boolean>>('overlays', {})};
  private readonly tools = new Map<Tool, HTMLButtonElement>();
  private readonly camera = h('button', {class: 'plain', 'aria-haspopup': 'menu', testid: 'camera'}, icon('camera'), h('span'));
  private readonly layers = h('button', {class: 'plain icon-only', 'aria-haspopup': 'menu', 'aria-label': 'Overlays', title: 'Overlays', testid: 'overlays'}, icon('layers'));
  private readonly film = h('button', {class: 'plain', 'aria-label': 'Record video', testid: 'video'}, icon('video'), h('span'));
  private readonly banner = h('div', {class: 'scene-banner', hidden: true, role: 'status'});
  private readonly stickHost = h('div', {class: 'stick-host', hidden: true});
  private readonly veil = h('div', {class: 'veil', hidden: true, testid: 'veil'});
  readonly elements: HTMLElement[];
  private placing: {what: string; put: (x: number, y: number) => void} | null = null;
  private veilTimer: ReturnType<typeof setTimeout> | undefined;
  /** Told of overlays that were switched. */
  onOverlays: () => void = () => undefined;

  constructor(private readonly context: Context, private readonly teleop: Teleop, private readonly video: Video, private readonly goals: Goals, private readonly host: HTMLElement) {
    const {actions, store, client} = context;
    const toolButton = (tool: Tool, id: string, symbol: string, label: string): HTMLButtonElement => {
      const button = h('button', {class: 'plain icon-only', 'aria-label': label, 'aria-pressed': 'false', testid: `tool-${tool}`, on: {click: () => actions.run(id)}}, icon(symbol));
      this.tools.set(tool, button);
      return button;
    };
    this.camera.addEventListener('click', () => openMenu(this.camera, cameras.map(([mode, label], i) => ({label, key: String(i + 1), checked: context.scene.cameraMode === mode, run: () => actions.run(`camera.${mode}`)}))));
    this.layers.addEventListener('click', () => openMenu(this.layers, overlays.map(([id, label]) => ({label, checked: this.on[id] ?? false, key: {grid: 'G', trails: 'T', names: 'N'}[id], run: () => this.toggle(id)})), true));
    this.film.addEventListener('click', () => actions.run('scene.video'));
    const photo = h('button', {class: 'plain icon-only', 'aria-label': 'Save a picture', title: actions.titleOf('scene.screenshot'), testid: 'screenshot', on: {click: () => actions.run('scene.screenshot')}}, icon('image'));
    const stick = new Stick((x, y) => {
      teleop.stick.forward = y;
      teleop.stick.turn = -x;
    });
    this.stickHost.append(stick.element);
    this.elements = [
      h('div', {class: 'float top-left', role: 'toolbar', 'aria-label': 'Tools'}, toolButton('orbit', 'tool.orbit', 'cursor', 'Look around'), toolButton('move', 'tool.move', 'move', 'Move things'), toolButton('pull', 'tool.pull', 'pull', 'Pull things'), toolButton('goal', 'tool.goal', 'flag', 'Send the robot somewhere')),
      h('div', {class: 'float top-right', role: 'toolbar', 'aria-label': 'View'}, this.camera, this.layers, this.film, photo), this.banner, this.stickHost, this.veil,
    ];
    this.camera.title = 'Camera (1 to 7)';
    host.addEventListener('click', (event) => this.click(event), true);
    store.onRole.on(() => {
      if (this.tool === 'goal' && store.whyNotSteer() !== null) this.setTool('orbit');
      this.show();
    });
    // With the tool in hand another robot is sent.
    store.onSelection.on(() => {
      if (this.tool === 'goal') this.beginGoal();
    });
    goals.onChange.on(() => {
      if (this.tool === 'goal' && goals.input === null) this.beginGoal();
      this.show();
    });
    client.onState.on(() => this.showVeil());
    teleop.onChange.on(() => this.show());
    video.onChange = () => this.show();
    setInterval(() => {
      if (video.active) this.show();
    }, 1000);
    this.context.scene.setOverlays(this.on);
    this.show();
    this.showVeil();
  }

  toggle(id: string): void {
    this.on[id] = !this.on[id];
    remember('overlays', this.on);
    this.context.scene.setOverlays({[id]: this.on[id]});
    this.onOverlays();
  }

  setTool(tool: Tool): void {
    if (this.tool === 'goal') this.goals.end();
    this.tool = this.tool === tool ? 'orbit' : tool;
    this.context.scene.setTool(this.tool);
    this.show();
    if (this.tool === 'goal') this.beginGoal();
  }

  /** What a press in the scene does now, and what else it could tell the robot. */
  private showGoalBanner(robot: string): void {
    const {goals} = this;
    const {input} = goals;
    const choices = goals.inputs.length < 2 ? [] : goals.inputs.map((each) => h('button', {
      class: 'plain small', 'aria-pressed': String(each === input), title: `${each.topic} (${each.type}), read by ${each.programs.join(' and ')}`, testid: `goal-${inputName(each, robot)}`,
      on: {click: () => {
        goals.choose(each);
        this.show();
      }},
    }, inputName(each, robot)));
    this.banner.replaceChildren(icon('flag'), h('span', {}, 'Press where ', h('b', {}, robot), input === null || isGoal(input) ? ' shall go' : ' is', ', drag for the heading'),
        goals.status === '' ? '' : h('span', {class: 'faint', title: 'Status of the program', testid: 'goal-status'}, goals.status), ...choices, h('button', {class: 'small', on: {click: () => void this.cancel()}}, 'Done'));
  }

  private beginGoal(): void {
    const why = this.goals.begin();
    if (why !== null) {
      this.context.toast(why, 'warning');
      this.setTool('orbit');
    }
    this.show();
  }

  /** The next click in the scene says where. */
  place(what: string, put: (x: number, y: number) => void): void {
    this.placing = {what, put};
    this.show();
  }

  /** True when there was something to give up. */
  cancel(): boolean {
    if (this.placing) this.placing = null;
    else if (this.teleop.armed !== null) this.teleop.disarm();
    else if (this.tool !== 'orbit') this.setTool('orbit');
    else return false;
    this.show();
    return true;
  }

  private click(event: MouseEvent): void {
    if (!this.placing || (event.target as Element).closest('.float, .scene-banner, .stick-host, .veil')) return;
    const box = this.host.getBoundingClientRect();
    const at = this.context.scene.pick(event.clientX - box.left, event.clientY - box.top)?.point;
    event.stopPropagation();
    event.preventDefault();
    if (!at) {
      this.context.toast('There is no ground there', 'warning');
      return;
    }
    const {put} = this.placing;
    this.placing = null;
    this.show();
    put(at[0], at[1]);
  }

  show(): void {
    const {store, actions, scene} = this.context;
    const reason = store.whyNotSteer();
    for (const [tool, button] of this.tools) {
      button.setAttribute('aria-pressed', String(this.tool === tool));
      setReason(button, tool === 'orbit' ? null : reason, actions.titleOf(`tool.${tool}`));
    }
    setText(this.camera.lastElementChild as Element, cameras.find(([mode]) => mode === scene.cameraMode)?.[1] ?? '');
    this.film.classList.toggle('filming', this.video.active);
    setText(this.film.lastElementChild as Element, this.video.active ? this.video.elapsed() : '');
    this.film.title = this.video.active ? 'Stop and save the video' : actions.titleOf('scene.video');
    const armed = this.teleop.armed;
    this.stickHost.hidden = armed === null;
    const sends = this.tool === 'goal' ? this.goals.robot : null;
    this.banner.hidden = armed === null && this.placing === null && sends === null;
    this.banner.classList.toggle('armed', armed !== null);
    if (this.placing) {
      this.banner.replaceChildren(h('span', {}, `Click where ${this.placing.what} shall stand`), h('button', {class: 'small', on: {click: () => void this.cancel()}}, 'Cancel'));
    } else if (sends !== null) {
      this.banner.classList.remove('armed');
      this.showGoalBanner(sends);
    } else if (armed !== null) {
      const how = this.teleop.gamepad ? 'gamepad, W A S D or stick' : 'W A S D, arrows or stick';
      this.banner.replaceChildren(icon('gamepad'), h('span', {}, 'Driving ', h('b', {}, armed)), h('span', {class: 'dim how'}, how), h('button', {class: 'small', on: {click: () => this.teleop.disarm()}}, 'Stop'));
    }
  }

  private showVeil(): void {
    const {client} = this.context;
    clearTimeout(this.veilTimer);
    if (client.state === 'open') {
      this.veil.hidden = true;
      return;
    }
    // A blink of the connection is not worth a veil.
    this.veilTimer = setTimeout(() => {
      if (client.state === 'open') return;
      const known = this.context.store.world !== null;
      const ended = this.context.store.status?.state === 'ended';
      this.veil.hidden = false;
      // What came last stays to be looked at.
      this.veil.classList.toggle('clear', known);
      this.veil.replaceChildren(h('div', {class: 'card', role: 'status'},
          h('h2', {}, ended ? 'The run has ended' : known ? 'The connection is gone' : 'Connecting'),
          h('p', {}, ended ? `${this.context.store.status?.reason || 'This is how it stood'}. The page goes on by itself when a run begins at this address.` :
              known ? 'The run was stopped, or the network is away. What you see is the last that came; the page comes back by itself.' :
              'Waiting for the simulator. Is it running, with a port? For example: sandlot run FILE --port 8080'),
          client.closeReason ? h('p', {class: 'mono'}, client.closeReason) : null, h('button', {class: 'main', on: {click: () => client.connect()}}, 'Try now')));
    }, this.context.store.world ? 1200 : 800);
  }
}
