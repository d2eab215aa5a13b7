// What is selected: its pose, its drive, its devices; or a device with its levels, readings and parameters; or a program, a medium,
// a rule with theirs.
import type {Context, Panel} from '../app/context';
import {word} from '../app/format';
import {type Selected, worldParts} from '../app/store';
import type {Device, Instance, Kind, Part as WorldPart} from '../protocol';
import {ControllersSection} from './controllers_section';
import {clear, h, setReason} from './dom';
import {DriveSection} from './drive_section';
import {FieldRow} from './field_row';
import {ErrorModels} from './error_models';
import {errorsView, FieldView, fieldViews} from './forms';
import {icon} from './icons';
import {heading, PoseSection} from './pose_section';
import {Listed, Readings} from './readings';
import {teamColor} from './teams';
import {hasPanel, RobotPanelSection} from './robot_panel';
import type {Teleop} from './teleop';
import {WorldSection} from './world_section';

interface Part {
  element: HTMLElement;
  steering?(): void;
  close?(): void;
}

const partRow = (part: WorldPart, name: string): {path: string; name: string; detail: string} => ({path: part.path, name, detail: part.kind.replace(/_/g, ' ')});

export class Inspector implements Panel {
  private readonly head = h('div', {class: 'inspector-head'});
  private readonly body = h('div', {class: 'inspector-body'});
  readonly element = h('div', {class: 'inspector', testid: 'inspector'}, this.head, this.body);
  private parts: Part[] = [];
  private shown = '';
  private visible = true;
  private stale = true;  // made before the services of this connection were there

  constructor(private readonly context: Context, private readonly teleop: Teleop) {
    context.store.onSelection.on(() => this.show());
    context.store.onWorld.on(() => this.show());
    context.store.onRole.on(() => this.steering());
    // While the connection is away the last that was known stays to be read.
    context.client.onChannels.on(() => {
      if (!this.stale || !context.client.services.has('/sandlot/console')) return;
      this.stale = false;
      this.show(true);
    });
    context.client.onState.on((state) => {
      if (state !== 'open') this.stale = true;
    });
    let may: boolean | null = null;
    context.store.onStatus.on((status) => {
      if (status.may_steer === may) return;
      may = status.may_steer;
      this.steering();
    });
    this.show();
  }

  setVisible(visible: boolean): void {
    if (visible === this.visible) return;
    this.visible = visible;
    this.show(true);
  }

  private steering(): void {
    for (const part of this.parts) part.steering?.();
  }

  private show(again = false): void {
    const {store} = this.context;
    const selected = this.visible ? store.selected() : null;
    // A world that changed elsewhere leaves the form, with what somebody is typing in it, as it is.
    const key = selected ? JSON.stringify([selected.address, store.epoch, selected.device ?? selected.part ?? [selected.instance?.id, selected.instance?.team, selected.instance?.controllers, selected.instance?.devices]]) :
      store.world && this.visible ? JSON.stringify([store.world.name, store.world.instances.length, store.world.seed, store.epoch]) : '';
    if (key === this.shown && !again) return;
    this.shown = key;
    for (const part of this.parts) part.close?.();
    this.parts = [];
    clear(this.head);
    clear(this.body);
    if (!selected && store.world && this.visible) {
      this.head.append(h('div', {class: 'title'}, h('h2', {class: 'ellipsis', title: store.world.name}, store.world.name)), h('div', {class: 'chips'}, h('span', {class: 'chip'}, 'World')));
      const section = new WorldSection(this.context, store.world);
      this.parts.push(section);
      for (const {title, parts} of worldParts(store.world)) this.list(title, title === 'Teams' ? 'brain' : title === 'Media' ? 'waves' : 'flag', parts.map((p) => partRow(p, title === 'Teams' ? p.path : p.name)));
      this.form([errorsView('sim', 'Factor on the errors of all devices of all robots')], 'Errors');
      this.parts.push(new ErrorModels(this.context, store.world, store.world.instances.filter((each) => each.robot), true));
      for (const part of this.parts) this.body.append(part.element);
      return;
    }
    if (!selected) {
      this.body.append(h('div', {class: 'empty tall'}, icon('cursor', 20), h('p', {}, 'Select a robot or an object, here or in the scene.')));
      return;
    }
    this.header(selected);
    if (selected.device) this.device(selected.device);
    else if (selected.part) this.part(selected.part);
    else if (selected.instance) this.instance(selected.instance);
    for (const part of this.parts) this.body.append(part.element);
  }

  private header({address, instance, device, part}: Selected): void {
    const {store, actions} = this.context;
    const own = instance !== null && address === instance.name;
    const chips = h('div', {class: 'chips'});
    const chip = (text: string, color = ''): void => void chips.append(h('span', {class: 'chip'}, color ? h('i', {class: 'dot', style: {background: color}}) : null, text));
    if (own) {
      chip(instance.robot ? 'Robot' : store.world?.models.find((m) => m.id === instance.model)?.static ? 'Static' : 'Object');
      if (instance.team) chip(instance.team, teamColor(instance.team, store.world));
      if (instance.original && instance.original !== instance.name) chip(instance.original);
    } else {
      chip((device ?? part)?.kind.replace(/_/g, ' ') ?? '');
      const team = instance ? undefined : store.world?.teams?.find((t) => t.programs.some((p) => p.path === address));
      if (team) chip(team.name, teamColor(team.name, store.world));
    }
    const owner = address.split('/')[0] ?? '';
    const title = own ? h('h2', {class: 'ellipsis', title: address}, address) :
      h('h2', {class: 'ellipsis', title: address}, h('button', {class: 'plain crumb', title: `Select ${instance ? owner : 'the world'}`, on: {click: () => store.select(instance ? owner : null)}}, owner), h('span', {class: 'faint'}, '/'), address.slice(owner.length + 1));
    const buttons = h('div', {class: 'buttons'});
    const button = (id: string, name: string, steers: boolean): HTMLButtonElement => {
      const element = h('button', {class: 'plain icon-only', 'aria-label': actions.titleOf(id), title: actions.titleOf(id), on: {click: () => actions.run(id)}}, icon(name));
      if (steers) this.parts.push({element: h('span'), steering: () => setReason(element, store.whyNotSteer(), actions.titleOf(id))});
      buttons.append(element);
      return element;
    };
    if (instance) {
      button('robots.follow', 'follow', false);
      button('scene.frame', 'frame', false);
    }
    if (own) {
      button('scene.duplicate', 'copy', true);
      button('scene.remove', 'trash', true);
    }
    this.parts.forEach((part) => part.steering?.());
    this.head.append(h('div', {class: 'title'}, title, buttons), chips);
    const help = device ? store.world?.kinds[device.kind]?.help : part && !instance ? this.kindOf(part)?.help : undefined;
    if (help) this.head.append(h('p', {class: 'help dim'}, help));
  }

  /** Rows that select what they name. */
  private list(title: string, symbol: string, rows: {path: string; name: string; detail: string}[]): void {
    if (rows.length === 0) return;
    this.parts.push({element: h('section', {class: 'block'}, heading(title), ...rows.map((row) =>
      h('button', {class: 'plain part-row', title: row.path, testid: `part-${row.path}`, on: {click: () => this.context.store.select(row.path)}}, icon(symbol, 14), h('span', {}, row.name), h('span', {class: 'faint ellipsis'}, row.detail), icon('chevron', 12))))});
  }

  private instance(instance: Instance): void {
    const world = this.context.store.world;
    const fixed = world?.models.find((m) => m.id === instance.model)?.static ?? false;
    this.parts.push(new PoseSection(this.context, instance.name, !fixed));
    if (hasPanel(instance)) this.parts.push(new RobotPanelSection(this.context, instance));
    if (instance.robot) this.parts.push(new DriveSection(this.context, this.teleop, instance));
    if ((instance.devices ?? []).length > 0) this.form([errorsView(instance.name, 'Factor on the errors of all its devices')], 'Errors');
    if (world && (instance.devices ?? []).length > 0) this.parts.push(new ErrorModels(this.context, world, [instance], false));
    this.list('Devices', 'chip', (instance.devices ?? []).map((d) => ({path: d.path, name: d.name, detail: `${d.kind.replace(/_/g, ' ')}${d.active?.length ? ` · ${d.active.join(', ')}` : ''}`})));
    if (instance.robot) this.parts.push(new ControllersSection(this.context, instance.name));
    this.list('Team', 'brain', (world?.teams ?? []).find((team) => team.name === instance.team)?.programs.map((p) => partRow(p, p.path)) ?? []);
  }

  private device(device: Device): void {
    const kind = this.context.store.world?.kinds[device.kind];
    if (kind && kind.levels?.length > 0) this.levels(device, kind.levels);
    const views = fieldViews(device.path, kind?.fields ?? []);
    const listed = this.context.steer.list<Listed[]>(word(device.path));
    this.parts.push(new Readings(this.context, device.path, new Set(views.map((v) => v.address)), (device.topics ?? []).map((t) => t.name), listed));
    this.form(views, 'Parameters', listed);
    const {world} = this.context.store;
    const owner = world?.instances.find((each) => (each.devices ?? []).some((d) => d.path === device.path));
    if (world && owner) this.parts.push(new ErrorModels(this.context, world, [{...owner, devices: [device]}], false));
  }

  private kindOf(part: WorldPart): Kind | undefined {
    const world = this.context.store.world;
    const list = world ? worldParts(world).find(({parts}) => parts.some((p) => p.path === part.path)) : undefined;
    return world?.kinds[`${list?.kinds ?? ''}${part.kind}`];
  }

  private part(part: WorldPart): void {
    const views = fieldViews(part.path, this.kindOf(part)?.fields ?? []);
    this.form(views);
    this.parts.push(new Readings(this.context, part.path, new Set(views.map((v) => v.address)), []));
  }

  private levels(device: Device, levels: {name: string; message: string; command: string; help: string}[]): void {
    const {store, steer} = this.context;
    // Levels that take commands exclude each other; those that only measure may be on together.
    const exclusive = levels.every((l) => l.command !== '');
    const buttons = levels.map((level) => {
      const active = device.active?.includes(level.name) ?? false;
      const title = [level.help, level.message && `publishes ${level.message}`, level.command && `takes ${level.command}`].filter((t) => t).join('\n');
      const button = h('button', {class: 'small', 'aria-pressed': String(active), testid: `level-${level.name}`, on: {click: () => {
        const wanted = exclusive ? [level.name] : levels.map((l) => l.name).filter((name) => (name === level.name ? !active : device.active?.includes(name)));
        if (wanted.length === 0) this.context.toast('A device runs at one level at least');
        else if (!exclusive || !active) void steer.say(`level ${word(device.path)} ${wanted.map(word).join(' ')}`.trimEnd());
      }}}, level.name);
      return {button, title};
    });
    const part: Part = {
      element: h('section', {class: 'block'}, heading(exclusive ? 'Level' : 'Levels'), h('div', {class: 'levels'}, ...buttons.map((b) => b.button))),
      steering: () => buttons.forEach(({button, title}) => setReason(button, store.whyNotSteer(), title)),
    };
    part.steering?.();
    this.parts.push(part);
  }

  /** @param actual  values of what is fixed, where they are known; else the defaults are shown */
  private form(views: FieldView[], title = 'Parameters', actual: Promise<Listed[] | null> | null = null): void {
    const {parameters, store} = this.context;
    if (views.length === 0) return;
    const groups = [...new Set(views.map((v) => v.group))];
    const ordered = [...views].sort((a, b) => Number(b.tunable) - Number(a.tunable) || groups.indexOf(a.group) - groups.indexOf(b.group));
    const section = h('section', {class: 'block form'});
    const rows = new Map<string, FieldRow>();
    const headings = new Map<string, HTMLElement>();
    const put = (into: HTMLElement, list: FieldView[]): void => {
      let group = '';
      for (const view of list) {
        // The kind lists the parameters of all agents; an agent has some of them.
        const perhaps = view.tunable && view.path.startsWith('parameters/');
        if (view.group !== group) {
          group = view.group;
          const heading = h('h4', {hidden: perhaps}, group);
          into.append(heading);
          if (perhaps) headings.set(group, heading);
        }
        const row = new FieldRow(view, parameters);
        row.element.hidden = perhaps;
        rows.set(view.address, row);
        into.append(row.element);
      }
    };
    const tunable = ordered.filter((v) => v.tunable);
    const fixed = ordered.filter((v) => !v.tunable);
    section.append(heading(title));
    if (tunable.length === 0) section.append(h('div', {class: 'none faint'}, 'Nothing here changes while running'));
    put(section, tunable);
    if (fixed.length > 0) {
      const more = h('details', {class: 'fixed-fields'}, h('summary', {}, `Fixed while running (${fixed.length})`));
      put(more, fixed);
      section.append(more);
    }
    const steering = (): void => rows.forEach((row) => row.setReason(store.whyNotSteer()));
    const show = (names: Iterable<string>): void => {
      for (const name of names) {
        const row = rows.get(name);
        const value = parameters.values.get(name);
        if (row && value !== undefined && value !== null) {
          row.element.hidden = false;
          headings.get(views.find((v) => v.address === name)?.group ?? '')?.removeAttribute('hidden');
        }
        row?.show(value);
      }
    };
    void actual?.then((listed) => {
      const values = new Map((Array.isArray(listed) ? listed : []).map((entry) => [entry.address, entry.value]));
      for (const view of fixed) {
        const dot = view.address.indexOf('.');
        const value = values.get(`${view.address.slice(0, dot)}.parameter${view.address.slice(dot)}`) ?? values.get(view.address);
        if (value === undefined || value === null) continue;
        if (view.control === 'number') rows.get(view.address)?.show(value);
        else if (view.control === 'switch') rows.get(view.address)?.show(value !== 0);
        else if (view.control === 'choice') rows.get(view.address)?.show(view.choices[value] ?? String(value));
      }
    });
    const stopChange = parameters.onChange.on(show);
    const stopLook = parameters.look(tunable.map((v) => v.address));
    show([...rows.keys()].filter((name) => parameters.values.has(name)));
    steering();
    this.parts.push({element: section, steering, close: () => {
      stopChange();
      stopLook();
    }});
  }
}
