// Puts the page together: connection, store, scene, panels, keys.
import {Client} from '../net/client';
import {socketAddress, targetOf} from '../net/address';
import {MatrixPanel} from '../plots/matrix';
import {PlotsPanel} from '../plots/plots_panel';
import {AgentsPanel} from '../ui/agents';
import type {Status, World} from '../protocol';
import {SceneView} from '../scene/scene';
import {freeName, openAdd} from '../ui/add_dialog';
import {Bar, speeds} from '../ui/bar';
import {ClientsPanel} from '../ui/clients';
import {CommandsPanel} from '../ui/commands';
import {ConsolePanel} from '../ui/console';
import {h} from '../ui/dom';
import {Frame} from '../ui/frame';
import {GraphPanel} from '../ui/graph';
import {openHelp} from '../ui/help';
import {Inspector} from '../ui/inspector';
import {LayersLegend} from '../ui/layers';
import {LogPanel} from '../ui/log';
import {MatchPanel} from '../ui/match';
import {Toasts} from '../ui/overlays';
import {openPalette} from '../ui/palette';
import {saveBlob} from '../ui/save';
import {Score} from '../ui/score';
import {ScoreBoard} from '../ui/score_board';
import {CameraMode, cameras, overlays, SceneTools, Tool} from '../ui/scene_tools';
import {Teleop} from '../ui/teleop';
import {TopicsPanel} from '../ui/topics';
import {PicturesPanel} from '../ui/pictures';
import {RobotPanelsPane} from '../ui/robot_panels';
import {Tree} from '../ui/tree';
import {Video} from '../ui/video';
import {Actions, keyOf} from './actions';
import {bindKeys} from './bindings';
import type {Context} from './context';
import {dragLine} from './drags';
import {word} from './format';
import {Game} from './game';
import {Goals} from './goals';
import {Layers} from './layers';
import {Parameters} from './parameters';
import {SensorOverlays} from './sensors';
import {remember, remembered} from './settings';
import {plain, Steer} from './steer';
import {Store} from './store';
import {actionTable, Doers} from './tables';

export class App {
  readonly store = new Store();
  readonly client: Client;
  readonly scene: SceneView;
  readonly plots: PlotsPanel;
  readonly agents: AgentsPanel;
  readonly game: Game;
  readonly layers: Layers;
  private readonly steer: Steer;
  private readonly actions: Actions;
  private readonly toasts = new Toasts();
  private readonly frame: Frame;
  private readonly bar: Bar;
  private readonly tools: SceneTools;
  private readonly teleop: Teleop;
  private readonly tree: Tree;
  private readonly console: ConsolePanel;
  private readonly context: Context;
  private readonly video: Video;

  constructor(root: HTMLElement) {
    this.setTheme(this.preferredTheme());
    const {target, cleanHref} = targetOf(location, sessionStorage);
    if (cleanHref !== location.href) history.replaceState(null, '', cleanHref);
    this.client = new Client({address: () => socketAddress(target)});
    this.steer = new Steer(this.client, this.store);
    this.actions = new Actions((action) => action.group === 'Time' && action.id !== 'time.record' ? this.store.whyNotPlay() : this.store.whyNotSteer(), (text) => this.toasts.show(text, 'warning'));
    this.actions.add(...actionTable(this.doers()));

    const sceneElement = h('div', {class: 'scene-canvas'});
    // The scene looks at its host's size: it must be in the page, with the frame's style, before it is made.
    const stage = h('div', {class: 'frame'}, h('main', {class: 'scene-host'}, sceneElement));
    root.append(stage);
    this.scene = new SceneView(sceneElement, {assetBase: '/assets'});
    this.context = {
      client: this.client, store: this.store, steer: this.steer, parameters: new Parameters(this.client), actions: this.actions, scene: this.scene,
      toast: (text, kind, button) => this.toasts.show(text, kind, button), openPane: (id) => this.frame.open(id),
      plot: (address, unit) => {
        this.frame.open('plots');
        this.plots.addValue(address, unit);
      },
      phase: (addresses) => {
        this.frame.open('plots');
        this.plots.addPhase(addresses);
      },
      showMatrix: (topic) => {
        this.frame.open('matrix');
        matrix.choose(topic);
      },
      showPicture: (topic) => {
        this.frame.open('pictures');
        pictures.show(topic);
      },
      showLog: (program) => {
        this.frame.open('log');
        log.showOnly(program);
      },
    };
    // What is counted at a message of poses needs the scene to have had it.
    this.client.subscribe('/sandlot/poses', (message) => this.scene.applyPoses(message.bytes));
    this.game = new Game(this.client, this.store, this.scene);
    this.bar = new Bar(this.context, this.game);
    this.frame = new Frame(this.bar.element);
    this.frame.sceneHost.append(sceneElement);
    stage.remove();
    root.append(this.frame.element, this.toasts.element);

    this.teleop = new Teleop(this.context);
    let armed: string | null = null;
    this.teleop.onChange.on(() => {
      // On a phone the stick needs the room of the sheet.
      if (this.teleop.armed !== armed && this.teleop.armed !== null) this.frame.openPhone('none');
      armed = this.teleop.armed;
    });
    this.video = new Video(this.context);
    this.tree = new Tree(this.context);
    const inspector = new Inspector(this.context, this.teleop);
    this.frame.left.append(this.tree.element);
    this.frame.right.append(inspector.element);
    this.plots = new PlotsPanel(this.context);
    this.console = new ConsolePanel(this.context);
    const log = new LogPanel(this.context, (text) => this.frame.setBadge('log', text));
    const matrix = new MatrixPanel(this.context);
    this.agents = new AgentsPanel(this.context);
    const pictures = new PicturesPanel(this.context);
    const match = new MatchPanel(this.context, this.game);
    for (const [id, title, panel] of [['plots', 'Plots', this.plots], ['match', 'Match', match], ['pictures', 'Cameras', pictures], ['panels', 'Panels', new RobotPanelsPane(this.context)], ['console', 'Console', this.console], ['log', 'Log', log], ['clients', 'Clients', new ClientsPanel(this.context)], ['topics', 'Topics', new TopicsPanel(this.context)],
      ['graph', 'Graph', new GraphPanel(this.context)], ['matrix', 'Matrix', matrix], ['agents', 'Agents', this.agents], ['commands', 'Commands', new CommandsPanel(this.context)]] as const) {
      this.frame.addPane({id, title, panel});
    }
    this.frame.setPresent('match', false);
    this.game.onState.on((state) => {
      this.frame.setPresent('match', state !== null);
      if (state !== null) this.frame.suggest('match');
    });
    this.frame.addPhoneTab('tree', 'World', 'list');
    this.frame.addPhoneTab('inspect', 'Inspect', 'sliders');
    this.frame.addPhoneTab('dock', 'Plots', 'plot', 'plots');
    this.frame.addPhoneTab('dock', 'Console', 'terminal', 'console');
    this.frame.addPhoneTab('dock', 'Log', 'help', 'log');
    this.frame.onShown = () => {
      this.tree.setVisible(this.frame.shows('left'));
      inspector.setVisible(this.frame.shows('right'));
    };
    this.frame.onShown();

    this.layers = new Layers(this.client, this.store, this.scene);
    const legend = new LayersLegend(this.layers);
    const goals = new Goals(this.client, this.store, this.scene, this.layers, (text, kind) => this.toasts.show(text, kind));
    this.scene.onAim = (aim) => goals.aim(aim);
    this.tools = new SceneTools(this.context, this.teleop, this.video, goals, this.frame.sceneHost);
    this.frame.sceneHost.append(...this.tools.elements, legend.element, new Score(this.context).element, new ScoreBoard(this.context, this.game).element);
    const sensors = new SensorOverlays(this.client, this.store, this.scene);
    this.tools.onOverlays = () => {
      sensors.show({scans: this.tools.on.scans ?? false, ranges: this.tools.on.ranges ?? false, views: this.tools.on.frusta ?? false, objects: this.tools.on.objects ?? false});
      this.layers.show(this.tools.on.layers ?? true);
      legend.setShown(this.tools.on.layers ?? true);
      this.listen();
    };
    this.store.onWorld.on(() => this.listen());
    this.tools.onOverlays();

    this.wire();
    bindKeys(this.client, this.steer, this.actions, (text) => this.toasts.show(text));
    this.scene.setTheme(this.theme());
    this.keys();
    this.client.connect();
  }

  private wire(): void {
    const {client, store, scene} = this;
    let session: string | undefined;
    let framed = false;
    client.onInfo.on((info) => {
      if (session !== undefined && info.sessionId !== session) {
        // The program was started anew: its ids and its epochs mean other things.
        scene.reset();
        store.forget();
        framed = false;
      }
      session = info.sessionId;
      // A server that is not ours has no roles: who is connected may do what it offers.
      store.setRole(info.metadata?.sandlot_role ?? 'admin');
    });
    client.onState.on((state) => {
      if (state !== 'open') store.setRole('');
    });
    client.subscribe('/sandlot/world', (message) => store.setWorld(message.value() as World), {background: true});
    client.subscribe('/sandlot/status', (message) => store.setStatus(message.value() as Status), {background: true});
    document.addEventListener('visibilitychange', () => client.setHidden(document.hidden && !this.video.active));
    client.setHidden(document.hidden);
    client.onStatus.on((status) => {
      if (status.level > 0) this.toasts.show(status.message, status.level > 1 ? 'error' : 'warning');
    });
    store.onWorld.on((world) => {
      scene.setWorld(world);
      if (framed) return;
      framed = true;
      scene.frameAll();
    });
    store.onSelection.on((address) => scene.select(address));
    let state = '';
    store.onStatus.on((status) => {
      if (status.state === 'failed' && state !== 'failed' && status.reason) this.toasts.show(`The run failed: ${status.reason}`, 'error');
      state = status.state;
      // As fast as it goes, or as it was told to, whichever is slower.
      const factor = Math.min(status.speed ?? Infinity, status.real_time_factor > 0 ? status.real_time_factor : Infinity);
      scene.setPace(state === 'playing', (1000 * status.step_s) / factor);
    });
    this.steer.onError.on((text) => this.toasts.show(text, 'error'));
    this.steer.onNote.on((text) => this.toasts.show(text));
    scene.onSelect = (address) => store.select(address);
    scene.onDrag = (drag) => {
      const reason = store.whyNotSteer();
      if (reason !== null) {
        if (drag.phase === 'start') this.toasts.show(reason, 'warning');
        return;
      }
      const line = dragLine(drag);
      if (line === null) return;
      // A run that stands still moves it with its next tick: until then it is shown where the hand put it.
      if (store.status?.state !== 'playing' && drag.mode !== 'pull') scene.override(drag.name, drag.target, drag.yaw);
      this.steer.drag(line);
    };
  }

  private readonly stops = new Map<string, () => void>();

  /** Subscribes to what the overlays that are on draw, where the world has such things. */
  private listen(): void {
    const {scene, store, tools} = this;
    const wants = (topic: string, wanted: boolean, take: (bytes: Uint8Array) => void): void => {
      if (wanted === this.stops.has(topic)) return;
      this.stops.get(topic)?.();
      this.stops.delete(topic);
      if (wanted) this.stops.set(topic, this.client.subscribe(topic, (message) => take(message.bytes)));
    };
    const has_media = (store.world?.media ?? []).length > 0;
    const has_batteries = (store.world?.instances ?? []).some((i) => (i.devices ?? []).some((d) => d.kind === 'battery'));
    wants('/sandlot/contacts', tools.on.contacts ?? false, (bytes) => scene.setContacts(bytes));
    wants('/sandlot/deliveries', (tools.on.links ?? false) && has_media, (bytes) => scene.setDeliveries(bytes));
    wants('/sandlot/batteries', (tools.on.batteries ?? false) && has_batteries, (bytes) => scene.setBatteries(bytes));
  }

  // --- the theme

  private preferredTheme(): 'light' | 'dark' {
    const kept = remembered<string>('theme', '');
    return kept === 'light' || kept === 'dark' ? kept : matchMedia('(prefers-color-scheme: light)').matches ? 'light' : 'dark';
  }

  private theme(): 'light' | 'dark' {
    return document.documentElement.dataset.theme === 'light' ? 'light' : 'dark';
  }

  private setTheme(theme: 'light' | 'dark'): void {
    document.documentElement.dataset.theme = theme;
  }

  // --- keys

  private keys(): void {
    addEventListener('keydown', (event) => {
      const key = keyOf(event);
      if (key === null || event.defaultPrevented) return;
      const target = event.target as HTMLElement;
      const typing = target.matches('input:not([type=checkbox]):not([type=range]), select, textarea, [contenteditable]');
      if (typing && key === 'escape') {
        target.blur();
        return;
      }
      const modal = document.querySelector('dialog[open]') !== null;
      if (modal || (typing && !key.startsWith('ctrl+')) || (typing && ['ctrl+d', 'ctrl+i', 'ctrl+b'].includes(key))) return;
      if (this.teleop.key(key, true)) {
        event.preventDefault();
        return;
      }
      // Buttons and the tree have keys of their own.
      if ((key === 'space' || key === 'enter') && target.matches('button, [role=tab], summary, input')) return;
      if (event.repeat && key !== '.') return;
      if (this.actions.press(key)) event.preventDefault();
    });
    addEventListener('keyup', (event) => {
      const key = keyOf(event);
      if (key !== null) this.teleop.key(key.replace(/^.*\+(?=.)/, ''), false);
    });
  }

  private doers(): Doers {
    const selected = (): string | null => this.store.selected()?.instance?.name ?? null;
    const need = (run: (name: string) => void) => (): void => {
      const name = selected();
      if (name === null) this.toasts.show('Select a robot or an object first');
      else run(name);
    };
    const speed = (by: number) => (): void => {
      const now = this.store.status?.speed ?? Number.POSITIVE_INFINITY;
      const next = by > 0 ? speeds.find((s) => s > now) : [...speeds].reverse().find((s) => s < now);
      void this.steer.say(`speed ${next ?? (by > 0 ? 'max' : speeds[0])}`);
    };
    const robot = (by: number) => (): void => {
      const robots = (this.store.world?.instances ?? []).filter((i) => i.robot);
      const at = robots.findIndex((r) => r.name === selected());
      this.store.select(robots[(Math.max(at, by > 0 ? -1 : 0) + by + robots.length) % robots.length]?.name ?? null);
    };
    const camera = ([mode]: [CameraMode, string]): [string, () => void] => [`camera.${mode}`, () => {
      const target = selected() ?? this.store.world?.instances.find((i) => i.robot)?.name;
      this.scene.setCamera(mode, target ?? undefined);
      this.tools.show();
    }];
    const pane = (id: string): [string, () => void] => [`pane.${id}`, () => this.frame.open(id)];
    const tool = (id: Tool): [string, () => void] => [`tool.${id}`, () => this.tools.setTool(id)];
    return {
      ...Object.fromEntries(cameras.map(camera)), ...Object.fromEntries(overlays.map(([id]) => [`overlay.${id}`, () => this.tools.toggle(id)])),
      ...Object.fromEntries(['plots', 'match', 'pictures', 'log', 'clients', 'topics', 'graph', 'matrix', 'agents', 'panels', 'commands'].map(pane)), ...Object.fromEntries((['orbit', 'move', 'pull', 'goal'] as Tool[]).map(tool)),
      'time.play': () => this.steer.togglePlay(),
      'time.step': () => void this.steer.say('step'),
      'time.reset': () => void this.steer.say('reset'),
      'time.slower': speed(-1),
      'time.faster': speed(1),
      'time.max': () => void this.steer.say('speed max'),
      'time.record': () => void this.steer.say(this.store.status?.recording ? 'record off' : `record ${(this.store.world?.name ?? 'run').replace(/[^\w-]+/g, '-')}.mcap`),
      'scene.frame': () => (selected() === null ? this.scene.frameAll() : this.scene.frame(this.store.selection ?? '')),
      'robots.follow': need((name) => {
        this.scene.setCamera('follow', name);
        this.tools.show();
      }),
      'robots.drive': need((name) => (this.teleop.armed === name ? this.teleop.disarm() : this.teleop.arm(name))),
      'robots.next': robot(1),
      'robots.previous': robot(-1),
      'scene.add': () => openAdd(this.context, (what, put) => this.tools.place(what, put)),
      'scene.duplicate': need((name) => this.duplicate(name)),
      'scene.remove': need((name) => void this.remove(name)),
      'scene.screenshot': () => void this.scene.screenshot().then((blob) => saveBlob(blob, 'sandlot.png'), (error: unknown) => this.toasts.show(String(error), 'error')),
      'scene.video': () => this.video.toggle(),
      'panels.filter': () => {
        if (!this.frame.shows('left')) this.frame.toggle('left');
        this.tree.focusFilter();
      },
      'panels.console': () => {
        this.frame.open('console');
        this.console.focus();
      },
      'panels.left': () => this.frame.toggle('left'),
      'panels.right': () => this.frame.toggle('right'),
      'panels.dock': () => this.frame.toggle('dock'),
      'page.palette': () => openPalette(this.context),
      'page.theme': () => {
        this.setTheme(this.theme() === 'dark' ? 'light' : 'dark');
        remember('theme', this.theme());
        this.scene.setTheme(this.theme());
        this.bar.showTheme();
        this.plots.themeChanged();
        this.agents.themeChanged();
      },
      'page.help': () => openHelp(this.actions),
      'page.escape': () => {
        if (!this.tools.cancel()) this.store.select(null);
      },
    };
  }

  /** Where it stood is kept for the undo. A robot that comes back is a new one: its state is that of a start. */
  private async remove(name: string): Promise<void> {
    const {store, scene} = this;
    const instance = store.instance(name);
    const pose = scene.pose(name);
    const index = store.world?.instances.indexOf(instance as never) ?? -1;
    const answer = await this.steer.remove(name);
    if (!answer.ok || !instance) return;
    if (store.selection === name) store.select(null);
    const model = store.world?.models.find((m) => m.id === instance.model)?.name ?? '';
    this.toasts.show(`Removed ${name}`, 'info', pose && index >= 0 && model ? {label: 'Undo', run: () => void this.steer.say(this.addLine(model, name, pose))} : undefined);
  }

  private addLine(model: string, name: string, pose: {position: number[]; quaternion: number[]}, shift_m = 0): string {
    const [w = 1, x = 0, y = 0, z = 0] = pose.quaternion;
    const yaw = Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
    const [px = 0, py = 0, pz = 0] = pose.position;
    return ['add', word(model), word(name), ...[px + shift_m, py, pz, yaw].map((v) => plain(Math.round(v * 1e4) / 1e4))].join(' ');
  }

  private duplicate(name: string): void {
    const instance = this.store.instance(name);
    const pose = this.scene.pose(name);
    const model = this.store.world?.models.find((m) => m.id === instance?.model);
    if (!instance || !pose || !model) return;
    const copy = freeName(`${name.replace(/\d+$/, '')}2`, (n) => this.store.instance(n) !== undefined);
    void this.steer.say(this.addLine(model.name, copy, pose, 0.6)).then((answer) => {
      if (answer.ok) setTimeout(() => this.store.select(copy), 250);
    });
  }
}
