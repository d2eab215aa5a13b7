// The pane Match: the referee's log, the moment of each decision from above, maps of ball and passes, and who plays as what.
import type {Context, Panel} from '../app/context';
import {formatTime} from '../app/format';
import type {Game} from '../app/game';
import {clockText, Decision, PlayerReport, playerOf, playerType, reasonOf, shortStage, titleOf, weightOf, wordsOf} from '../app/match';
import {ticker} from '../app/ticker';
import {h, setReason, setText, setTitle} from './dom';
import {FieldPicture} from './field_picture';
import {icon} from './icons';
import {spanOf} from './timeline';
import {VirtualList} from './virtual_list';

const row_px = 25, before_s = 5, most_passes = 60, players_max = 24;
const ball_rgb = [255, 138, 31] as const;

type View = 'now' | 'moment' | 'ball' | 'passes' | `team ${string}`;

function rgbOf(color: string): [number, number, number] {
  const hex = /^#([\da-f]{2})([\da-f]{2})([\da-f]{2})/i.exec(color);
  return hex ? [parseInt(hex[1] as string, 16), parseInt(hex[2] as string, 16), parseInt(hex[3] as string, 16)] : [140, 150, 165];
}

function sentence(decision: Decision): string {
  const text = reasonOf(decision);
  return decision.robot !== '' && text.startsWith(decision.robot) ? text : text.charAt(0).toUpperCase() + text.slice(1);
}

interface PlayerRow {
  element: HTMLElement;
  role: HTMLElement;
  intention: HTMLElement;
  ball: HTMLElement;
  camera: HTMLButtonElement;
}

export class MatchPanel implements Panel {
  private readonly log: VirtualList<Decision>;
  private readonly count = h('span', {class: 'faint', testid: 'match-count'});
  private readonly field = new FieldPicture();
  private readonly views = h('div', {class: 'match-views', role: 'toolbar', 'aria-label': 'Picture of the field'});
  private readonly caption = h('div', {class: 'match-caption'});
  private readonly captionText = h('span', {class: 'grow', testid: 'match-caption'});
  private readonly before = h('button', {class: 'small plain', testid: 'match-before', on: {click: () => this.jump(-before_s)}}, `${before_s} s before`);
  private readonly there = h('button', {class: 'small', testid: 'match-jump', on: {click: () => this.jump(0)}}, 'Go there');
  private readonly bar = h('div', {class: 'possession-bar', testid: 'possession'});
  private readonly touch = h('div', {class: 'match-touch', testid: 'last-touch'});
  private readonly players = h('div', {class: 'match-players', testid: 'match-players'});
  private readonly hint = h('div', {class: 'empty'}, 'No referee in this world: the rule “referee” judges a match.');
  private readonly body: HTMLElement;
  readonly element: HTMLElement;
  private readonly rows = new Map<string, PlayerRow>();
  private readonly reports = new Map<string, PlayerReport>();
  private stops: (() => void)[] = [];
  private visible = false;
  private view: View = 'now';
  private chosen: Decision | null = null;
  private span = '';
  private bar_key = '';
  private drawn_ms = 0;

  constructor(private readonly context: Context, private readonly game: Game) {
    this.log = new VirtualList(row_px, (d) => this.makeRow(d));
    this.log.refreshRow = (row, d) => row.setAttribute('aria-selected', String(d === this.chosen));
    this.log.followTail();
    this.log.element.classList.add('match-log');
    this.log.element.setAttribute('aria-label', 'Decisions of the referee');
    this.log.element.addEventListener('keydown', (event) => this.key(event));
    this.caption.append(this.captionText, this.before, this.there);
    this.body = h('div', {class: 'match-body'},
        h('section', {class: 'match-part log-part', 'aria-label': 'Log of the referee'}, h('div', {class: 'match-head'}, h('b', {}, 'Referee'), this.count), this.log.element),
        h('section', {class: 'match-part field-part', 'aria-label': 'Field'}, this.views, h('div', {class: 'field-host'}, this.field.element), this.caption),
        h('section', {class: 'match-part side-part', 'aria-label': 'Ball and players'}, h('div', {class: 'match-head'}, h('b', {}, 'Possession')), this.bar, this.touch, this.players));
    this.element = h('div', {class: 'pane match', testid: 'match'}, this.body, this.hint);
    game.onState.on(() => ticker.request(this.update));
    game.onLog.on((fresh) => {
      if (fresh !== null && this.view === 'moment' && this.log.follow) this.chosen = fresh;
      this.span = '';
      ticker.request(this.update);
    });
    context.store.onStatus.on(() => ticker.request(this.update));
    context.store.onWorld.on(() => {
      this.rows.clear();
      this.players.replaceChildren();
      ticker.request(this.update);
    });
    context.client.onChannels.on(() => {
      if (this.visible) this.listen();
    });
    this.chooseView('now');
  }

  // --- the log

  private makeRow(d: Decision): HTMLElement {
    const weight = weightOf(d);
    const dot = h('i', {class: 'dot'});
    dot.style.background = d.team === '' ? 'transparent' : this.game.color(d.team);
    return h('div', {
      class: `decision ${weight}`, role: 'option', 'aria-selected': String(d === this.chosen), 'data-sequence': d.sequence, testid: 'decision', on: {click: () => this.choose(d)},
      title: `${titleOf(d)}\n${reasonOf(d)}\n${formatTime(d.time_s)}, tick ${d.tick}${d.command === '' ? '' : `, ${d.command}`}`,
    }, h('span', {class: 'number when'}, h('i', {class: 'faint'}, shortStage(d.stage)), clockText(d.clock_s)), dot, h('b', {class: 'rule'}, wordsOf(d.rule)),
    weight === 'goal' && d.score.length === 2 ? h('span', {class: 'number goal-score'}, `${d.score[0]} : ${d.score[1]}`) : null, h('span', {class: 'dim ellipsis reason'}, reasonOf(d)));
  }

  choose(decision: Decision): void {
    this.chosen = decision;
    this.chooseView('moment');
    this.log.draw();
  }

  private key(event: KeyboardEvent): void {
    const by = event.key === 'ArrowDown' ? 1 : event.key === 'ArrowUp' ? -1 : 0;
    if (by === 0) return;
    event.preventDefault();
    event.stopPropagation();
    const all = this.shownDecisions();
    const at = this.chosen ? all.indexOf(this.chosen) : by > 0 ? -1 : all.length;
    const next = all[Math.max(0, Math.min(all.length - 1, at + by))];
    if (!next) return;
    this.choose(next);
    const top = all.indexOf(next) * row_px, element = this.log.element;
    if (top < element.scrollTop) element.scrollTop = top;
    else if (top + row_px > element.scrollTop + element.clientHeight) element.scrollTop = top + row_px - element.clientHeight;
  }

  private shownDecisions(): Decision[] {
    const status = this.context.store.status;
    if (!status) return [];
    // What lies before the times that can be gone to has been all the same.
    return this.game.decisions(Number.NEGATIVE_INFINITY, spanOf(status)[1]);
  }

  private jump(by_s: number): void {
    const status = this.context.store.status;
    if (!this.chosen || !status) return;
    this.context.steer.jump(Math.max(spanOf(status)[0], this.chosen.time_s + by_s));
  }

  // --- the picture

  private chooseView(view: View): void {
    this.view = view;
    this.drawn_ms = 0;
    for (const button of this.views.querySelectorAll('button')) button.setAttribute('aria-pressed', String(button.dataset.view === view));
    ticker.request(this.update);
  }

  private fillViews(): void {
    const teams = this.game.state?.teams ?? [];
    const all: [View, string, string][] = [
      ['now', 'Now', 'Where everything is'], ['moment', 'Decision', 'The moment of the decision that is chosen in the log'], ['ball', 'Ball', 'Where the ball was for how long'],
      ...teams.map((t): [View, string, string] => [`team ${t.name}`, wordsOf(t.name), `Where the robots of ${t.name} were for how long`]), ['passes', 'Passes', 'From robot to robot of a team'],
    ];
    const key = all.map(([id]) => id).join();
    if (this.views.dataset.shown === key) return;
    this.views.dataset.shown = key;
    this.views.replaceChildren(...all.map(([id, label, title]) => h('button', {class: 'small plain', title, 'data-view': id, testid: `match-view-${id.replace(' ', '-')}`, 'aria-pressed': String(id === this.view), on: {click: () => this.chooseView(id)}}, label)));
  }

  private fillPicture(): void {
    const {game, field} = this;
    const color = (team: string): string => game.color(team);
    field.setDimensions(game.dimensions);
    const moment = this.view === 'moment' ? this.chosen : null;
    this.before.hidden = this.there.hidden = moment === null;
    let caption = '';
    if (this.view === 'moment') {
      if (moment) field.showMoment(moment.players, moment.ball, color, moment.robot, weightOf(moment) === 'minor' || (moment.point[0] === 0 && moment.point[1] === 0 && moment.rule !== 'goal') ? null : moment.point);
      else field.showMoment([], null, color);
      caption = moment ? `${titleOf(moment)}. ${sentence(moment)}` : 'Choose a decision in the log';
      const reason = this.context.store.whyNotJump();
      for (const button of [this.there, this.before]) setReason(button, reason, button === this.there ? 'Take the run to this moment' : `Take the run to ${before_s} s before this moment`);
    } else if (this.view === 'now') {
      const robots = (this.context.store.world?.instances ?? []).filter((i) => i.robot).map((i) => ({
        name: i.name, team: i.team, number: Number(/\d+$/.exec(i.name)?.[0] ?? 0), at: game.spotOf(i.name) ?? ([0, 0] as const), yaw: this.yawOf(i.name)}));
      field.showMoment(robots, game.spotOf(game.ball()), color, game.state?.last_touch ?? '');
      caption = game.state?.last_touch ? `Last touch: ${game.state.last_touch}` : 'Nobody has touched the ball yet';
    } else if (this.view === 'passes') {
      const passes = game.tally.passes;
      field.showPasses(passes.slice(-most_passes), color);
      const counts = (game.state?.teams ?? []).map((t) => `${t.name} ${passes.filter((p) => p.team === t.name).length}`);
      caption = `Passes so far: ${counts.join(', ')}`;
    } else {
      const key = this.view === 'ball' ? 'ball' : this.view.slice(5);
      field.showHeat(game.tally.heat(key), key === 'ball' ? ball_rgb : rgbOf(color(key)));
      caption = `${key === 'ball' ? 'Ball' : `Robots of ${key}`} in ${clockText(game.tally.seconds)} of play`;
    }
    setText(this.captionText, caption);
    setTitle(this.captionText, caption);
    field.setTitle(caption);
  }

  private yawOf(name: string): number {
    const [w = 1, x = 0, y = 0, z = 0] = this.context.scene.pose(name)?.quaternion ?? [];
    return Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  }

  // --- possession, players

  private fillPossession(): void {
    const state = this.game.state;
    if (!state) return;
    const all = state.teams.reduce((sum, t) => sum + t.possession_s, 0);
    const key = state.teams.map((t) => `${t.name} ${Math.round(t.possession_s)}`).join();
    if (key !== this.bar_key) {
      this.bar_key = key;
      this.bar.replaceChildren(...state.teams.map((t) => {
        const share = all > 0 ? t.possession_s / all : 1 / state.teams.length;
        const part = h('div', {class: 'possession-part', title: `${t.name}: ${clockText(t.possession_s)} of play`}, all > 0 ? `${Math.round(100 * share)} %` : '–');
        part.style.flexGrow = String(Math.max(0.02, share));
        part.style.background = this.game.color(t.name);
        return part;
      }));
    }
    const robot = state.last_touch;
    if (this.touch.dataset.shown === robot) return;
    this.touch.dataset.shown = robot;
    const dot = h('i', {class: 'dot'});
    dot.style.background = this.game.color(this.game.teamOf(robot));
    this.touch.replaceChildren(h('span', {class: 'dim'}, 'Last touch'), ...(robot === '' ? [h('span', {class: 'faint'}, 'nobody')] : [dot, h('b', {}, robot)]));
  }

  private fillPlayers(): void {
    const {store} = this.context;
    const teams = (this.game.state?.teams ?? []).map((t) => t.name);
    const robots = (store.world?.instances ?? []).filter((i) => i.robot && teams.includes(i.team))
      .sort((a, b) => teams.indexOf(a.team) - teams.indexOf(b.team) || a.name.localeCompare(b.name, 'en', {numeric: true})).slice(0, players_max);
    if (robots.length !== this.rows.size) {
      this.rows.clear();
      this.players.replaceChildren(...robots.map((robot) => {
        const row = this.makePlayer(robot.name, robot.team);
        this.rows.set(robot.name, row);
        return row.element;
      }));
    }
    for (const robot of robots) {
      const row = this.rows.get(robot.name), report = this.reports.get(robot.name);
      if (!row) continue;
      setText(row.role, report ? wordsOf(report.role) : '–');
      setText(row.intention, report?.intention ? report.intention.replace(/_/g, ' ') : '');
      row.ball.classList.toggle('held', report?.ball_engaged === true);
      row.ball.style.opacity = report ? String(0.15 + 0.85 * report.ball_confidence) : '0';
      setTitle(row.ball, !report ? '' : report.ball_engaged ? 'Holds the ball' : `Sees the ball: ${Math.round(100 * report.ball_confidence)} %`);
      const camera = this.cameraOf(robot.name);
      row.camera.disabled = camera === '';
      setTitle(row.camera, camera === '' ? 'No camera sends pictures at its present level' : `What ${robot.name} sees`);
    }
  }

  private makePlayer(name: string, team: string): PlayerRow {
    const dot = h('i', {class: 'dot'});
    dot.style.background = this.game.color(team);
    const role = h('span', {class: 'ellipsis role'}), intention = h('span', {class: 'dim ellipsis intention'}), ball = h('i', {class: 'sees-ball'});
    const camera = h('button', {class: 'plain small icon-only', 'aria-label': `Camera of ${name}`, testid: `match-camera-${name}`, on: {click: (event) => {
      event.stopPropagation();
      this.context.showPicture(this.cameraOf(name));
    }}}, icon('camera', 14));
    const element = h('div', {class: 'match-player', 'data-robot': name, on: {click: () => this.context.store.select(name)}}, dot, h('b', {class: 'ellipsis'}, name), role, intention, ball, camera);
    return {element, role, intention, ball, camera};
  }

  /** The first topic of a robot that has pictures as JPEG; '': none. */
  private cameraOf(robot: string): string {
    const prefix = `/${robot}/`;
    for (const c of this.context.client.channels.values()) if (c.topic.startsWith(prefix) && c.encoding === 'cdr' && c.schemaName.endsWith('/CompressedImage')) return c.topic;
    return '';
  }

  private listen(): void {
    for (const stop of this.stops.splice(0)) stop();
    this.reports.clear();
    if (!this.visible) return;
    const topics = [...this.context.client.channels.values()].filter((c) => c.schemaName === playerType).map((c) => c.topic).slice(0, players_max);
    for (const topic of topics) {
      const robot = topic.split('/')[1] ?? '';
      this.stops.push(this.context.client.subscribe(topic, (message) => {
        this.reports.set(robot, playerOf(message.value()));
        ticker.request(this.update);
      }));
    }
  }

  private readonly update = (): void => {
    if (!this.visible) return;
    const present = this.game.state !== null;
    this.body.hidden = !present;
    this.hint.hidden = present;
    if (!present) return;
    const decisions = this.shownDecisions();
    const last = decisions[decisions.length - 1];
    const span = `${decisions.length} ${last?.sequence ?? 0} ${last?.tick ?? 0}`;
    if (span !== this.span) {
      this.span = span;
      this.log.set(decisions);
      setText(this.count, decisions.length === 0 ? 'no decision yet' : decisions.length === 1 ? '1 decision' : `${decisions.length} decisions`);
    }
    this.fillViews();
    // A picture of the whole field ten times a second is as good as sixty times.
    const now_ms = performance.now();
    if (now_ms - this.drawn_ms >= 100) {
      this.drawn_ms = now_ms;
      this.fillPicture();
    }
    this.fillPossession();
    this.fillPlayers();
  };

  setVisible(visible: boolean): void {
    if (visible === this.visible) return;
    this.visible = visible;
    this.listen();
    this.span = '';
    ticker.request(this.update);
  }
}
