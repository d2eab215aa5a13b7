// Who is connected, as what, how late: /sandlot/clients. Subscribed to while the pane is seen.
import type {Context, Panel} from '../app/context';
import {formatBytes, formatNumber} from '../app/format';
import {ticker} from '../app/ticker';
import type {AnsweredProgram, ClientRow, Clients, OutsideProgram} from '../protocol';
import {columnsOf, formatAge, formatDuration, isSilent, judge, missedShare, place, rowsOfPrograms, stateOf} from './client_figures';
import {h, setText, setTitle, svg} from './dom';
import {icon} from './icons';
import {teamColor} from './teams';

const disconnect = '/sandlot/disconnect_client', restart = '/sandlot/restart_program';
const sure_ms = 3000;
const columns = 30;

/** A button that asks once more, in its own place, before it does something that another person would notice. */
function askingButton(label: string, title: string, testid: string, run: () => void): HTMLButtonElement {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const button = h('button', {class: 'small plain', title, testid, on: {click: (event) => {
    event.stopPropagation();
    const sure = timer !== undefined;
    clearTimeout(timer);
    timer = sure ? undefined : setTimeout(() => {
      timer = undefined;
      button.textContent = label;
      button.classList.remove('danger');
    }, sure_ms);
    button.textContent = sure ? label : 'Sure?';
    button.classList.toggle('danger', !sure);
    if (sure) run();
  }}}, label);
  return button;
}

/** All latencies between 0.1 ms and the deadline, with the 99th percentile of the latest as a line. */
function latencyPicture(program: AnsweredProgram): SVGElement {
  const width = 4 * columns - 1, height = 18;
  const bars = columnsOf(program, columns).map((share, i) => svg('rect', {
    x: 4 * i, width: 3, y: height - Math.max(1, share * height), height: Math.max(1, share * height), class: share === 0 ? 'none' : i === columns - 1 ? 'late' : i >= 0.92 * columns ? 'close' : 'in-time',
  }));
  const at = program.latency_s ? Math.min(1, place(program.latency_s.p99, program.deadline_s)) * width : -1;
  const mark = at < 0 ? [] : [svg('path', {d: `M${at} -2V${height}`, class: 'p99'})];
  return svg('svg', {viewBox: `0 -2 ${width} ${height + 2}`, width, height: height + 2, 'aria-hidden': 'true', class: 'latency-picture'}, ...bars, ...mark);
}

/** A row and what is in its cells. Rows stay while their client does: a button that is pressed must be there when it is let go. */
interface Row {
  element: HTMLElement;
  cells: HTMLElement[];
}

export class ClientsPanel implements Panel {
  private readonly count = h('span', {class: 'faint', testid: 'clients-count'});
  private readonly table = h('div', {class: 'client-table', role: 'table', 'aria-label': 'Clients'});
  private readonly head = h('div', {class: 'client-row client-head faint', role: 'row'},
      ...['Client', 'Drives', 'Time to answer', 'Missed', 'Traffic', ''].map((title) => h('span', {role: 'columnheader'}, title)));
  private readonly note = h('div', {class: 'empty hidden'}, 'Only an administrator sees who else is connected.');
  readonly element = h('div', {class: 'pane clients', testid: 'clients'}, h('div', {class: 'pane-head'}, this.count), h('div', {class: 'client-scroll', tabindex: '0'}, this.table, this.note));
  private readonly rows = new Map<string, Row>();
  private latest: Clients | null = null;
  private stop: (() => void) | null = null;

  constructor(private readonly context: Context) {
    this.table.append(this.head);
    context.store.onRole.on(() => ticker.request(this.update));
  }

  private readonly update = (): void => {
    const {store} = this.context;
    const admin = store.role === 'admin';
    const {clients, programs} = this.latest ?? {clients: [], programs: []};
    const listed = rowsOfPrograms(programs, clients);
    const waiting = listed.filter((program) => stateOf(program, clients)[1] === 'warn').length;
    setText(this.count, !this.latest ? 'Waiting for the server' : `${clients.length} connected${waiting > 0 ? `, ${waiting} ${waiting === 1 ? 'robot waits' : 'robots wait'} for a client` : ''}`);
    this.note.classList.toggle('hidden', admin || !this.latest);
    const seen = new Set<string>();
    let last: Element = this.head;
    const show = (key: string, make: () => Row, fill: (row: Row) => void): void => {
      seen.add(key);
      let row = this.rows.get(key);
      if (!row) this.rows.set(key, row = make());
      fill(row);
      if (last.nextElementSibling !== row.element) last.after(row.element);
      last = row.element;
    };
    // Who drives comes first, then who waits to be driven, then who looks on.
    const order = {lockstep: 0, free: 1, watching: 3};
    const ordered = [...clients].sort((a, b) => order[a.mode] - order[b.mode] || a.id - b.id);
    const showClient = (client: ClientRow): void => show(`client ${client.id}`, () => this.makeRow(client.drives), (row) => this.fillClient(row, client, admin));
    for (const client of ordered.filter((c) => c.mode !== 'watching')) showClient(client);
    for (const program of listed) show(`program ${program.path}`, () => this.makeRow(program.path.split('/')[0] ?? ''), (row) => this.fillProgram(row, program, clients, admin));
    for (const client of ordered.filter((c) => c.mode === 'watching')) showClient(client);
    for (const [key, row] of this.rows) {
      if (seen.has(key)) continue;
      row.element.remove();
      this.rows.delete(key);
    }
  };

  private makeRow(robot: string): Row {
    const cells = ['who', 'drives', 'latency', 'missed', 'traffic', 'tools'].map((name) => h('div', {class: `cell ${name}`, role: 'cell'}));
    const element = h('div', {class: 'client-row', role: 'row', on: {click: () => {
      if (this.context.store.instance(robot)) this.context.store.select(robot);
    }}}, ...cells);
    return {element, cells};
  }

  private lines(cell: HTMLElement | undefined, first: (Node | string)[], second: string, title = ''): void {
    if (!cell) return;
    setTitle(cell, title);
    const key = `${first.map((part) => (typeof part === 'string' ? part : (part as Element).outerHTML)).join('')}\n${second}`;
    if (cell.dataset.shown === key) return;
    cell.dataset.shown = key;
    cell.replaceChildren(h('div', {class: 'first'}, ...first), h('div', {class: 'second faint ellipsis'}, second));
  }

  private drives(robot: string): Node[] {
    if (robot === '') return [];
    const world = this.context.store.world;
    const team = this.context.store.instance(robot)?.team ?? ((world?.teams ?? []).some((t) => t.name === robot) ? robot : '');
    const dot = team === '' ? [] : [h('i', {class: 'dot', style: {background: teamColor(team, world)}})];
    return [...dot, h('b', {class: 'ellipsis'}, robot)];
  }

  private fillClient({element, cells}: Row, client: ClientRow, admin: boolean): void {
    const [who, drives, latency, missed, traffic, tools] = cells;
    const you = String(client.id) === this.context.client.info?.metadata?.sandlot_client;
    const name = client.protocol === 'page' ? 'Page' : client.name || `Client ${client.id}`;
    element.dataset.client = String(client.id);
    element.dataset.mode = client.mode;
    element.classList.toggle('you', you);
    const address = client.address === '' ? '' : ` · ${client.address}`;
    this.lines(who, [icon(client.mode !== 'watching' ? 'terminal' : 'eye', 14), h('b', {class: 'ellipsis'}, name), ...(you ? [h('span', {class: 'tag you'}, 'you')] : [])],
        `${client.protocol}${address}`, `Client ${client.id}, connected for ${formatAge(client.connected_s)}\n${client.protocol}${address}`);
    const mode = client.mode === 'watching' ? (client.commands > 0 ? 'sends commands' : 'looks on') : client.mode;
    this.lines(drives, client.mode === 'watching' ? [h('span', {class: 'dim'}, client.role)] : this.drives(client.drives),
        client.mode === 'watching' ? mode : `${client.role} · ${mode}`, client.robots.length > 1 ? client.robots.join(', ') : '');
    this.fillLatency(latency, client);
    this.fillMissed(missed, client);
    const bytes = `${formatBytes(client.bytes_in)} in · ${formatBytes(client.bytes_out)} out`;
    const lost = [client.dropped > 0 ? `${client.dropped} dropped` : '', client.refused > 0 ? `${client.refused} refused` : ''].filter((text) => text !== '').join(', ');
    this.lines(traffic, [h('span', {class: 'number'}, `${formatNumber(client.messages_per_s, 3)} msg/s`), ...(lost === '' ? [] : [h('span', {class: 'tag warn'}, lost)])], bytes,
        `Messages received: ${client.messages}\nMessages dropped because it is too slow: ${client.dropped}\nRequests refused: ${client.refused}`);
    const may = admin && !you && this.context.client.services.has(disconnect);
    if (tools && may !== (tools.childElementCount > 0)) {
      tools.replaceChildren(...(may ? [askingButton('Disconnect', 'End this connection; its robots stop', 'disconnect', () => void this.ask(disconnect, {client: client.id}, `Client ${client.id} is gone`))] : []));
    }
  }

  private fillLatency(cell: HTMLElement | undefined, client: ClientRow): void {
    const program = client.programs[0];
    if (!cell) return;
    cell.classList.toggle('plain', !program);
    if (!program) {
      const commands = client.mode === 'free' || client.commands > 0;
      return this.lines(cell, commands ? [h('span', {class: 'number'}, `${formatNumber(client.commands_per_s, 3)} commands/s`)] : [h('span', {class: 'faint'}, '–')], commands ? `${client.commands} in all` : '');
    }
    const {latency_s: latency, step_s: step} = program;
    const verdict = judge(program);
    cell.dataset.judgement = verdict;
    const silent = isSilent(program);
    const text = latency ? `${formatDuration(latency.mean)} · 99 % in ${formatDuration(latency.p99)}` : 'no answer yet';
    const key = `${verdict} ${text} ${silent ? formatAge(program.waiting_s ?? 0) : ''} ${program.deadline_s} ${program.latencies.counts.join()}`;
    const title = [`${program.path}: from a step sent to its answer`, ...(latency ? [`last ${formatDuration(latency.last)}, mean ${formatDuration(latency.mean)}, 99 % within ${formatDuration(latency.p99)}, longest ${formatDuration(latency.max)} (of the latest 1000)`] : []),
      `picture: all answers, from 0.1 ms to the deadline of ${formatDuration(program.deadline_s)} at the right, logarithmic; the line is the 99th percentile`,
      ...(step ? [`a step every ${formatDuration(step.mean)} of wall time, ${formatDuration(program.control_period_s)} of simulated time`] : [])].join('\n');
    setTitle(cell, title);
    if (cell.dataset.shown === key) return;
    cell.dataset.shown = key;
    cell.replaceChildren(h('div', {class: 'figure'}, latencyPicture(program) as unknown as Node, h('span', {class: 'faint deadline'}, `≤ ${formatDuration(program.deadline_s)}`)),
        h('div', {class: 'second number ellipsis', testid: 'latency'}, silent ? `silent for ${formatAge(program.waiting_s ?? 0)}` : text));
  }

  private fillMissed(cell: HTMLElement | undefined, client: ClientRow): void {
    const misses = client.programs.reduce((sum, program) => sum + program.misses, 0);
    const steps = client.programs.reduce((sum, program) => sum + program.steps, 0);
    const first = client.programs[0];
    if (first) {
      const all = {...first, misses, steps};
      this.lines(cell, [h('span', {class: `number${misses > 0 ? ' warn' : ' good'}`, testid: 'misses', 'data-misses': misses}, missedShare(all))], `of ${steps} steps`);
    } else if (client.stops > 0) {
      this.lines(cell, [h('span', {class: 'number warn'}, `${client.stops} ${client.stops === 1 ? 'stop' : 'stops'}`)], 'for silence', 'It sent nothing for long, and its robots were stopped');
    } else {
      this.lines(cell, [h('span', {class: 'faint'}, '–')], '');
    }
  }

  private fillProgram({element, cells}: Row, program: OutsideProgram, clients: ClientRow[], admin: boolean): void {
    const [who, drives, latency, missed, traffic, tools] = cells;
    const [text, verdict] = stateOf(program, clients);
    element.dataset.program = program.path;
    element.classList.add('program');
    this.lines(who, [icon('chip', 14), h('span', {class: `ellipsis ${verdict === 'good' ? 'dim' : verdict}`}, text)], program.is_client && !program.started ? `to answer for ${program.path}` : `${program.path} · ${program.kind}`, program.path);
    this.lines(drives, this.drives(program.path.split('/')[0] ?? ''), program.is_client ? 'remote program' : 'process');
    this.lines(latency, [h('span', {class: 'faint'}, '–')], program.answers > 0 ? `${program.answers} answers until now` : '');
    latency?.classList.add('plain');
    const steps = program.answers + program.misses;
    this.lines(missed, [h('span', {class: `number${program.misses > 0 && verdict === 'good' && !program.is_client ? ' warn' : ' faint'}`}, steps === 0 ? '–' : String(program.misses))], steps === 0 ? '' : `of ${steps} steps`);
    this.lines(traffic, [], '');
    const may = admin && program.started && this.context.client.services.has(restart);
    const wanted = [...(may ? ['restart'] : []), ...(program.is_client && !program.started ? [] : ['output'])].join();
    if (!tools || tools.dataset.tools === wanted) return;
    tools.dataset.tools = wanted;
    tools.replaceChildren(...(may ? [askingButton('Restart', 'End the process of this program and start it again', 'restart-program', () => void this.ask(restart, {program: program.path}, `${program.path} starts again`))] : []),
        ...(wanted.includes('output') ? [h('button', {class: 'small plain', title: 'What it writes: the log of this program', testid: 'program-output', on: {click: (event) => {
          event.stopPropagation();
          this.context.showLog(program.path);
        }}}, 'Output')] : []));
  }

  private async ask(service: string, request: Record<string, unknown>, done: string): Promise<void> {
    try {
      const answer = await this.context.client.call<{ok?: boolean; text?: string}>(service, request);
      if (answer.ok === false) this.context.toast(String(answer.text || 'It was refused'), 'error');
      else this.context.toast(done);
    } catch (error) {
      this.context.toast(error instanceof Error ? error.message : String(error), 'error');
    }
  }

  setVisible(visible: boolean): void {
    if (visible === (this.stop !== null)) return;
    this.stop?.();
    this.stop = visible ? this.context.client.subscribe('/sandlot/clients', (message) => {
      this.latest = message.value() as Clients;
      ticker.request(this.update);
    }) : null;
    if (visible) this.update();
  }
}
