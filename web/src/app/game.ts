// The match of this run: finds the referee's topics by their types, keeps the log, and counts what the maps of the pane show.
import type {Client} from '../net/client';
import {Signal} from '../net/signal';
import type {SceneView} from '../scene/scene';
import {teamColor} from '../ui/teams';
import {decisionOf, decisionType, DecisionBook, Dimensions, dimensionsOf, gameOf, GameState, lengthOfField, Spot, stateType, Tally, TimeMark, titleOf, trackOf, weightOf} from './match';
import type {Decision} from './match';
import type {Store} from './store';

const service = '/sandlot/decisions', track_service = '/sandlot/match_track';
const period_s = 0.2, gap_s = 1, track_pause_ms = 10_000;
const fallback_colors = ['#12a5c9', '#d6189b'];

export class Game {
  state: GameState | null = null;
  dimensions: Dimensions = dimensionsOf(0);
  readonly tally = new Tally(this.dimensions);
  readonly onState = new Signal<GameState | null>();
  /** The log has changed; the decision is the newest where one came just now. */
  readonly onLog = new Signal<Decision | null>();
  private readonly book = new DecisionBook();
  private topic = '';
  private log_topic = '';
  private stops: (() => void)[] = [];
  private asked = 0;
  private fetched = '';
  private sampled_s = Number.NEGATIVE_INFINITY;
  private seen_s = Number.NEGATIVE_INFINITY;  // time of the latest poses
  private gap = false;  // something was not seen that the server has
  private tracks_asked = 0;
  private track_asked_ms = Number.NEGATIVE_INFINITY;
  private seeking = false;

  constructor(private readonly client: Client, private readonly store: Store, private readonly scene: SceneView) {
    client.onChannels.on(() => this.find());
    client.onState.on((state) => {
      if (state !== 'open') this.fetched = '';
    });
    store.onWorld.on((world) => {
      this.dimensions = dimensionsOf(lengthOfField(world.instances));
      this.tally.setDimensions(this.dimensions);
      this.find();
    });
    store.onEpoch.on(() => {
      this.fetched = '';
      this.find();
    });
    store.onStatus.on((status) => {
      // On its way to an earlier time a run still knows what it will forget there.
      const seeking = status.state === 'seeking';
      if (this.seeking && !seeking) {
        this.fetched = '';
        this.find();
      }
      this.seeking = seeking;
    });
  }

  /** Whether there is a referee. */
  get present(): boolean {
    return this.topic !== '';
  }

  color(team: string): string {
    const known = teamColor(team, this.store.world);
    if (known !== 'inherit') return known;
    const index = this.state?.teams.findIndex((t) => t.name === team) ?? -1;
    return fallback_colors[index] ?? 'var(--dim)';
  }

  /** Decisions within the times that the run can go to. */
  decisions(begin_s: number, end_s: number): Decision[] {
    return this.book.between(begin_s, end_s);
  }

  marks(begin_s: number, end_s: number): TimeMark[] {
    return this.decisions(begin_s, end_s).map((d) => {
      const weight = weightOf(d);
      const color = weight === 'card' ? (d.rule === 'yellow_card' ? '#f2c40f' : '#e5484d') : d.team === '' ? 'var(--dim)' : this.color(d.team);
      return {time_s: d.time_s, color, weight, title: titleOf(d)};
    });
  }

  teamOf(robot: string): string {
    return this.store.instance(robot)?.team ?? '';
  }

  /** The name of the ball; null: the world has none. */
  ball(): string | null {
    if (this.store.instance('ball')) return 'ball';
    return this.store.world?.instances.find((i) => !i.robot && /ball/i.test(i.name))?.name ?? null;
  }

  spotOf(name: string | null): Spot | null {
    const pose = name === null ? null : this.scene.pose(name);
    return pose ? [pose.position[0], pose.position[1]] : null;
  }

  /** The topic of a type; that of a rule comes before those of robots, which repeat what they were told. */
  private topicOf(type: string): string {
    const rank = (topic: string): number => (topic.startsWith('/rules/') ? 0 : this.store.instance(topic.split('/')[1] ?? '') ? 2 : 1);
    return [...this.client.channels.values()].filter((c) => c.schemaName === type).map((c) => c.topic).sort((a, b) => rank(a) - rank(b) || a.localeCompare(b, 'en'))[0] ?? '';
  }

  private find(): void {
    const [topic, log_topic] = [this.topicOf(stateType), this.topicOf(decisionType)];
    if (topic !== this.topic || log_topic !== this.log_topic) {
      [this.topic, this.log_topic] = [topic, log_topic];
      for (const stop of this.stops.splice(0)) stop();
      if (topic === '') {
        this.state = null;
        this.book.set([]);
        this.onState.emit(null);
        this.onLog.emit(null);
      } else {
        this.stops.push(this.client.subscribe(topic, (message) => this.take(gameOf(message.value()))), this.client.subscribe('/sandlot/poses', (message) => this.sample(Number(message.time_ns) * 1e-9)));
      }
      // In the background, too: decisions are few, and a log without holes is worth them.
      if (log_topic !== '') this.stops.push(this.client.subscribe(log_topic, (message) => this.add(decisionOf(message.value())), {background: true}));
    }
    if (log_topic !== '' && this.client.services.has(service) && this.fetched !== log_topic) {
      this.fetched = log_topic;
      void this.fetch(log_topic);
      void this.fetchTrack();
    }
  }

  private async fetch(topic: string): Promise<void> {
    const asked = ++this.asked;
    try {
      const answer = await this.client.call<{decisions?: unknown[]}>(service, {topic});
      if (asked !== this.asked) return;
      this.book.set((answer.decisions ?? []).map(decisionOf));
      this.onLog.emit(null);
    } catch {
      // Those that come from now on are the log.
    }
  }

  /** Maps of what was before the page was opened, and while it did not look. */
  private async fetchTrack(): Promise<void> {
    if (!this.client.services.has(track_service)) return;
    const asked = ++this.tracks_asked;
    this.track_asked_ms = performance.now();
    this.gap = false;
    try {
      const answer = await this.client.call(track_service, {});
      if (asked !== this.tracks_asked) return;
      this.tally.load(trackOf(answer));
      this.sampled_s = this.tally.latest_s;
      this.onLog.emit(null);
    } catch {
      // What the page sees from now on makes the maps.
    }
  }

  private add(decision: Decision): void {
    if (this.book.add(decision)) this.onLog.emit(decision);
  }

  private take(state: GameState): void {
    this.state = state;
    this.tally.touch(state.time_s, state.last_touch, state.in_play, (robot) => this.teamOf(robot));
    this.onState.emit(state);
  }

  private sample(time_s: number): void {
    // A window in the background sees nothing, a quick run little, and one that jumps nothing of its way.
    if (time_s > this.seen_s + gap_s && this.seen_s > Number.NEGATIVE_INFINITY) this.gap = true;
    this.seen_s = time_s;
    if (this.gap && performance.now() > this.track_asked_ms + track_pause_ms) void this.fetchTrack();
    if (time_s < this.sampled_s) {
      this.tally.forgetAfter(time_s);
      this.sampled_s = Number.NEGATIVE_INFINITY;
    }
    if (time_s < this.sampled_s + period_s || this.state?.in_play !== true) return;
    this.sampled_s = time_s;
    const robots = (this.store.world?.instances ?? []).filter((i) => i.robot && i.team !== '').map((i) => ({name: i.name, team: i.team, at: this.spotOf(i.name)}));
    this.tally.sample(time_s, this.spotOf(this.ball()), robots.filter((r): r is {name: string; team: string; at: Spot} => r.at !== null));
  }
}
