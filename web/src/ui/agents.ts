// Agents that find their own behaviour: their matrices, their network and their parameters, live.
import type {Context, Panel} from '../app/context';
import {formatNumber, word} from '../app/format';
import {remember, remembered} from '../app/settings';
import {ticker} from '../app/ticker';
import {orderOf, signedMaps, Weights, weightsOf} from '../plots/weights';
import {clear, h, setReason, setText} from './dom';
import {FieldRow} from './field_row';
import {fieldViews} from './forms';
import {MatrixTile} from './matrix_tile';
import {describeNode, drawNetwork, NetworkInput, NetworkLayout, nodeAt} from './network';

const kind = 'selforg';

/** What the letters of the equations mean (docs/selforg.md). */
const meanings: Record<string, string> = {
  C: 'Controller: sensors to motors', A: 'Model: motors to sensors', S: 'Model: sensors to next sensors, caused by the environment', h: 'Bias of the controller', H: 'Bias of the controller',
  b: 'Bias of the model', x: 'Sensor values', y: 'Motor values', xi: 'Prediction error of the model', v: 'Reconstruction error', self_caused: 'Predicted: caused by the motors', environment_caused: 'Predicted: caused by the environment',
};

export class AgentsPanel implements Panel {
  private readonly choice = h('select', {'aria-label': 'Agent', testid: 'agent'});
  private readonly what = h('span', {class: 'dim ellipsis'});
  private readonly scalars = h('span', {class: 'agent-scalars mono'});
  private readonly readout = h('span', {class: 'mono dim readout ellipsis'});
  private readonly file = h('input', {class: 'mono agent-file', 'aria-label': 'File of what the agent has learned', title: 'File in the folder of the run', testid: 'agent-file'});
  private readonly storeButton = h('button', {class: 'small', testid: 'agent-store'}, 'Store');
  private readonly loadButton = h('button', {class: 'small', testid: 'agent-load'}, 'Load');
  private readonly phaseButton = h('button', {class: 'plain small', title: 'Plot the first motor against the first sensor', testid: 'agent-phase'}, 'Phase plot');
  private readonly tiles = h('div', {class: 'weights'});
  private readonly network = h('canvas', {class: 'network-canvas', testid: 'agent-network', 'aria-label': 'Network of the agent: sensors, motors, predicted sensors'});
  private readonly networkArea = h('div', {class: 'network'}, this.network);
  private readonly form = h('div', {class: 'agent-form form'});
  private readonly hint = h('div', {class: 'empty'}, 'No robot of this world has a controller of kind selforg');
  private readonly body = h('div', {class: 'agent-body'}, this.tiles, this.networkArea, this.form);
  readonly element = h('div', {class: 'pane agents'}, h('div', {class: 'pane-head'}, this.choice, this.what, this.scalars, this.readout, this.phaseButton, this.file, this.storeButton, this.loadButton), this.body, this.hint);
  private visible = false;
  private chosen = remembered('agent', '');
  private listed = '';
  private shown = '';
  private stops: (() => void)[] = [];
  private readonly values = new Map<string, Weights>();
  private readonly tile = new Map<string, MatrixTile>();
  private order: string[] = [];
  private layout: NetworkLayout | null = null;
  private hovered = -1;
  private whatAsked = 0;

  constructor(private readonly context: Context) {
    this.choice.addEventListener('change', () => this.choose(this.choice.value));
    this.storeButton.addEventListener('click', () => this.file_('store'));
    this.loadButton.addEventListener('click', () => this.file_('load'));
    this.phaseButton.addEventListener('click', () => this.context.phase([`${this.chosen}/x.data[0]`, `${this.chosen}/y.data[0]`]));
    this.network.addEventListener('pointermove', (event) => {
      const box = this.network.getBoundingClientRect();
      this.hovered = this.layout ? nodeAt(this.layout, event.clientX - box.left, event.clientY - box.top) : -1;
      ticker.request(this.draw);
    });
    this.network.addEventListener('pointerleave', () => {
      this.hovered = -1;
      setText(this.readout, '');
      ticker.request(this.draw);
    });
    new ResizeObserver(() => ticker.request(this.draw)).observe(this.body);
    context.store.onWorld.on(() => this.list());
    context.store.onSelection.on(() => this.follow());
    context.store.onRole.on(() => this.steering());
    context.store.onEpoch.on(() => this.show(true));
    context.client.onChannels.on(() => {
      if (this.visible && this.stops.length === 0) this.show(true);
    });
  }

  private agents(): string[] {
    return (this.context.store.world?.instances ?? []).flatMap((i) => i.controllers ?? []).filter((c) => c.kind === kind).map((c) => c.path);
  }

  private list(): void {
    const agents = this.agents();
    const key = agents.join('\n');
    if (key !== this.listed || this.choice.options.length === 0) {
      this.listed = key;
      this.choice.replaceChildren(...agents.slice(0, 2000).map((path) => h('option', {value: path}, path)));
    }
    if (!agents.includes(this.chosen)) this.chosen = agents[0] ?? '';
    this.choice.value = this.chosen;
    this.hint.hidden = agents.length > 0;
    this.body.hidden = agents.length === 0;
    for (const each of [this.choice, this.file, this.storeButton, this.loadButton, this.phaseButton]) each.hidden = agents.length === 0;
    this.show();
  }

  /** The agent of the robot that is selected elsewhere. */
  private follow(): void {
    const selected = this.context.store.selected();
    const robot = selected?.instance?.name;
    const own = this.agents().filter((path) => path.split('/')[0] === robot);
    const path = own.find((p) => p === selected?.address) ?? own[0];
    if (path !== undefined && path !== this.chosen) this.choose(path);
  }

  choose(path: string): void {
    this.chosen = path;
    this.choice.value = path;
    remember('agent', path);
    this.show();
  }

  private file_(what: 'store' | 'load'): void {
    void this.context.steer.say(`${what} ${word(this.chosen)} ${word(this.file.value.trim() || this.fileName())}`).then((answer) => {
      if (answer.ok && what === 'store') this.context.toast(answer.text);
    });
  }

  private fileName(): string {
    return `${this.chosen.replace(/[^\w-]+/g, '-')}.agent`;
  }

  private steering(): void {
    const reason = this.context.store.whyNotSteer();
    setReason(this.storeButton, reason, 'Write what the agent has learned to the file');
    setReason(this.loadButton, reason, 'Give the agent what is in the file');
  }

  private show(again = false): void {
    const key = this.visible ? this.chosen : '';
    if (key === this.shown && !again) return;
    this.shown = key;
    for (const stop of this.stops.splice(0)) stop();
    this.values.clear();
    this.tile.clear();
    this.order = [];
    clear(this.tiles);
    clear(this.form);
    setText(this.scalars, '');
    if (key === '') return;
    this.file.placeholder = this.fileName();
    this.steering();
    this.listen(key);
    this.parameters(key);
    void this.describe(key);
  }

  private listen(path: string): void {
    const prefix = `/${path}/`;
    const topics = [...this.context.client.channels.values()].filter((c) => c.topic.startsWith(prefix) && c.schemaName.endsWith('/Float64MultiArray')).map((c) => c.topic);
    for (const topic of topics) {
      const name = topic.slice(prefix.length);
      this.stops.push(this.context.client.subscribe(topic, (message) => {
        const weights = weightsOf(name, message.value());
        if (!weights) return;
        const fresh = !this.values.has(name);
        this.values.set(name, weights);
        if (fresh) this.order = [...this.values.values()].sort(orderOf).map((w) => w.name);
        ticker.request(this.draw);
      }));
    }
    if (topics.length === 0) this.tiles.append(h('div', {class: 'empty'}, 'It publishes no matrices: publish_interval is 0, or the run has not begun'));
  }

  private async describe(path: string): Promise<void> {
    const asked = ++this.whatAsked;
    const agents = await this.context.steer.list<{path: string; agent?: string; wiring?: string; sensors?: number; motors?: number}[]>('agents');
    const agent = agents?.find((a) => a.path === path);
    if (asked === this.whatAsked) setText(this.what, agent?.agent ? `${agent.agent} behind ${agent.wiring} · ${agent.sensors} sensors, ${agent.motors} motors` : '');
  }

  /** Sliders for the parameters that this agent has: the kind lists those of all agents. */
  private parameters(path: string): void {
    const {parameters, store} = this.context;
    const views = fieldViews(path, store.world?.kinds[kind]?.fields ?? []).filter((v) => v.tunable);
    const rows = new Map(views.map((view) => [view.address, new FieldRow(view, parameters)]));
    for (const row of rows.values()) {
      row.element.hidden = true;
      this.form.append(row.element);
    }
    const reason = (): void => rows.forEach((row) => row.setReason(store.whyNotSteer()));
    const show = (names: Iterable<string>): void => {
      for (const name of names) {
        const row = rows.get(name);
        const value = parameters.values.get(name);
        if (!row || value === undefined || value === null) continue;
        row.element.hidden = false;
        row.show(value);
      }
    };
    this.stops.push(parameters.onChange.on(show), store.onRole.on(reason), parameters.look(views.map((v) => v.address)));
    show([...rows.keys()].filter((name) => parameters.values.has(name)));
    reason();
  }

  private readonly draw = (): void => {
    if (!this.visible || this.values.size === 0) return;
    const map = document.documentElement.dataset.theme === 'light' ? signedMaps.light : signedMaps.dark;
    const css = getComputedStyle(document.documentElement);
    const line = css.getPropertyValue('--line-strong');
    const height = Math.max(60, this.tiles.clientHeight - 34);
    // So that all matrices are seen at once where their cells stay large enough.
    const matrices = this.order.filter((name) => (this.values.get(name)?.columns ?? 1) > 1).length;
    const width = Math.max(110, (this.tiles.clientWidth - 24) / Math.max(1, Math.min(3, matrices)) - 16);
    const scalars: string[] = [];
    for (const name of this.order) {
      const weights = this.values.get(name) as Weights;
      if (weights.values.length === 1 && !['h', 'b', 'x', 'y'].includes(name)) {
        scalars.push(`${name} ${formatNumber(weights.values[0] as number, 3)}`);
        continue;
      }
      let tile = this.tile.get(name);
      if (!tile) {
        tile = new MatrixTile(name, meanings[name] ?? '', (k) => this.context.plot(`${this.chosen}/${name}.data[${k}]`, '1'), (text) => setText(this.readout, text));
        this.tile.set(name, tile);
        const next = this.order.slice(this.order.indexOf(name) + 1).map((n) => this.tile.get(n)).find((t) => t !== undefined);
        this.tiles.insertBefore(tile.element, next?.element ?? null);
      }
      tile.draw(weights, width, height, map, line);
    }
    setText(this.scalars, scalars.join('   '));
    const own = (name: string): Weights | null => this.values.get(name) ?? null;
    const input: NetworkInput = {controller: own('C'), model: own('A'), sensors: own('x'), motors: own('y')};
    this.networkArea.hidden = input.controller === null;
    if (input.controller === null || this.networkArea.clientWidth === 0) return;
    this.layout = drawNetwork(this.network, this.networkArea.clientWidth, this.networkArea.clientHeight, input,
        {map, line, text: css.getPropertyValue('--text'), dim: css.getPropertyValue('--dim'), ground: css.getPropertyValue('--raised')}, this.hovered);
    if (this.hovered >= 0) setText(this.readout, describeNode(this.layout, this.hovered, input));
  };

  setVisible(visible: boolean): void {
    if (visible === this.visible) return;
    this.visible = visible;
    if (visible) this.list();
    this.show(true);
  }

  themeChanged(): void {
    ticker.request(this.draw);
  }
}
