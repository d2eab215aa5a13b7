// Layers: maps, plans, particles and estimates of robots, as their programs and devices publish them, brought to the scene while they are
// switched on. A message is read at most once per frame of the screen, and not at all where it says what the last one said.
import type {Client, Message} from '../net/client';
import {Signal} from '../net/signal';
import type {Instance} from '../protocol';
import {LAYER_COLORS} from '../scene/overlays/layers';
import type {Drawing, SceneView} from '../scene/scene';
import {drawingOf, layerKindOf, LayerKind, Place, placeOf, sameContent, startOf, Told, toldOf, tooLong} from './layer_data';
import {multiply} from '../scene/poses';
import {remember, remembered} from './settings';
import type {Store} from './store';

export interface Layer {
  topic: string;
  type: string;
  kind: LayerKind;
  /** Name of the robot; empty: of none. */
  owner: string;
  /** The topic without its robot. */
  label: string;
  on: boolean;
  /** Index in LAYER_COLORS. */
  color: number;
  /** As the latest message says it; null: none has come. */
  frame: string | null;
  /** In a few words; empty until a message has come. */
  info: string;
  /** Why something is not drawn. */
  note: string;
}

interface Running extends Layer {
  stop: (() => void) | null;
  latest: Message | null;
  bytes: Uint8Array | null;
  drawing: Drawing | null;
  /** Whether the scene has it. */
  seen: boolean;
}

/** Robots and topics beyond these are left out until one is selected. */
export const layers_max = 24;

/** What a robot's program works out is shown; what devices say of themselves, such as the drive's odometry, can be. */
export function onFirst(kind: LayerKind, of_device: boolean): boolean {
  return !(kind === 'pose' && of_device);
}

export class Layers {
  /** Those of the selected robot, else of all while they are few, else of the first; and those of no robot. In the order of their names. */
  list: readonly Layer[] = [];
  /** How many robots are left out. */
  hidden = 0;
  readonly onChange = new Signal();
  private readonly running = new Map<string, Running>();
  private readonly switched = remembered<Record<string, boolean>>('layers', {});
  private readonly places = remembered<Record<string, Place>>('layer_frames', {});
  private shown = true;
  private flushing = 0;
  /** The robot whose layers are read though they may be switched off: where its frames are is wanted. */
  private held: string | null = null;
  /** Topics of type TransformStamped with what they said last. */
  private readonly transforms = new Map<string, {owner: string; stop: () => void; latest: Message | null; told: Told | null}>();

  constructor(private readonly client: Client, private readonly store: Store, private readonly scene: SceneView) {
    client.onChannels.on(() => this.update());
    store.onWorld.on(() => {
      this.update();
      // A robot may have been put elsewhere, its link renamed.
      this.placeAll();
    });
    store.onSelection.on(() => this.update());
    store.onEpoch.on(() => this.forget());
  }

  /** All of them at once. */
  show(shown: boolean): void {
    if (shown === this.shown) return;
    this.shown = shown;
    this.update();
  }

  /** The layers of a robot are read, seen or not, until another one is held; null: of none. */
  hold(robot: string | null): void {
    if (robot === this.held) return;
    this.held = robot;
    this.update();
  }

  toggle(topic: string): void {
    const layer = this.running.get(topic);
    if (!layer) return;
    this.switched[keyOf(layer)] = !layer.on;
    remember('layers', this.switched);
    this.update();
  }

  /** Frames of the layers that are drawn and are not the world's own, with where they are. */
  frames(owner: string): {frame: string; place: Place; told: boolean}[] {
    const names = new Set([...this.running.values()].filter((l) => l.owner === owner && l.frame !== null).map((l) => l.frame as string));
    return [...names].sort().map((frame) => ({frame, place: this.placeOf(frame, owner), told: this.told(frame, owner) !== null})).filter(({place, frame}) => place !== 'body' && frame !== '' && frame !== 'world');
  }

  /** For frames of which the page cannot know where they are. */
  setPlace(frame: string, place: Place): void {
    this.places[frame] = place;
    remember('layer_frames', this.places);
    this.placeAll();
    this.onChange.emit();
  }

  /** The frame in which a program is told poses: that of what it says itself, of maps first; else of its robot's maps; null: not known. */
  goalFrame(robot: string, program: string): string | null {
    const of = [...this.running.values()].filter((l) => l.owner === robot && l.frame !== null && l.frame !== '' && this.placeOf(l.frame, robot) !== 'body');
    const own = of.filter((l) => l.topic.startsWith(`/${program}/`)).sort((l, m) => goal_order[l.kind] - goal_order[m.kind]);
    // Maps that another program of the robot makes from odometry alone are that one's affair.
    const map = of.find((l) => (l.kind === 'map' || l.kind === 'particles') && !/(^|\/)odom[^/]*$/.test(l.frame ?? ''));
    return (own[0] ?? map)?.frame ?? null;
  }

  /** Pose of a frame in the world. @param topic  of a message in it: of its program depends what "upright" is */
  framePose(frame: string, owner: string, topic = '', most_parents = 4): Float64Array {
    const place = this.placeOf(frame, owner);
    if (place === 'body') return this.scene.framePose(frame) ?? startOf(undefined, undefined);
    const told = place === 'told' ? this.told(frame, owner) : null;
    if (told && most_parents > 0) {
      const out = new Float64Array(7);
      multiply(this.framePose(told.parent, owner, '', most_parents - 1), 0, told.pose, 0, out, 0);
      return out;
    }
    const instance = this.store.instance(owner);
    if (place === 'world' || !instance) return startOf(undefined, undefined);
    const link = this.store.world?.models.find((m) => m.id === instance.model)?.links[0];
    // A pair of eyes counts in the axes of its first picture, and the robot may have stood on a slope.
    const program = (instance.controllers ?? []).find((c) => topic.startsWith(`/${c.path}/`));
    return startOf(instance.start, link?.pose, program?.kind === 'visual_odometry');
  }

  private placeOf(frame: string, owner: string): Place {
    const chosen = this.places[frame];
    const is_told = this.told(frame, owner) !== null;
    if (chosen !== undefined && (chosen !== 'told' || is_told) && this.scene.framePose(frame) === null) return chosen;
    const kinds = [...this.running.values()].filter((l) => l.frame === frame).map((l) => l.kind);
    return placeOf(frame, this.store.instance(owner) ?? null, (f) => this.scene.framePose(f) !== null, kinds, is_told);
  }

  private told(frame: string, owner: string): Told | null {
    for (const each of this.transforms.values()) if (each.owner === owner && each.told?.child === frame) return each.told;
    return null;
  }

  /** Listens to transforms that programs of these robots publish. */
  private listenToTransforms(owners: Set<string>): void {
    const wanted = new Map<string, string>();
    for (const channel of this.client.channels.values()) {
      const first = channel.topic.split('/')[1] ?? '';
      if (channel.schemaName.replace('/msg/', '/') === 'geometry_msgs/TransformStamped' && owners.has(first)) wanted.set(channel.topic, first);
    }
    for (const [topic, each] of this.transforms) if (!wanted.has(topic)) {
      each.stop();
      this.transforms.delete(topic);
    }
    for (const [topic, owner] of wanted) {
      if (this.transforms.has(topic)) continue;
      const each = {owner, stop: () => undefined as void, latest: null as Message | null, told: null as Told | null};
      this.transforms.set(topic, each);
      each.stop = this.client.subscribe(topic, (message) => {
        each.latest = message;
        this.soon();
      });
    }
  }

  private update(): void {
    const found = [...this.client.channels.values()].flatMap((channel): Layer[] => {
      const kind = layerKindOf(channel.schemaName);
      if (kind === null) return [];
      const first = channel.topic.split('/')[1] ?? '';
      const instance = this.store.instance(first);
      const of_device = levelOf(instance, channel.topic);
      if (of_device === 'inactive') return [];
      const owner = instance?.robot ? first : '';
      const label = channel.topic.slice(owner === '' ? 1 : owner.length + 2);
      return [{topic: channel.topic, type: channel.schemaName, kind, owner, label, on: this.isOn(kind, label, of_device === 'active'), color: 0, frame: null, info: '', note: ''}];
    }).sort((a, b) => (a.owner === b.owner ? order[a.kind] - order[b.kind] || (a.label < b.label ? -1 : 1) : a.owner < b.owner ? -1 : 1));
    const list = this.choose(found);
    const taken = new Map<string, number>();
    for (const layer of list) {
      // The same topic of each robot has the same colour; those of one robot differ.
      if (layer.kind === 'map') continue;
      const at = taken.get(layer.label) ?? taken.size;
      taken.set(layer.label, at);
      layer.color = at % LAYER_COLORS.length;
    }
    for (const [topic, layer] of this.running) if (!list.some((l) => l.topic === topic)) this.end(layer);
    const next = list.map((layer) => {
      let run = this.running.get(layer.topic);
      if (!run) {
        run = {...layer, stop: null, latest: null, bytes: null, drawing: null, seen: false};
        this.running.set(layer.topic, run);
      }
      // Topics may be known before the world is, and with it whose they are.
      const other = run.color !== layer.color || run.owner !== layer.owner;
      Object.assign(run, {on: layer.on, color: layer.color, label: layer.label, owner: layer.owner});
      const wants = this.sees(run) || (run.owner === this.held && run.owner !== '');
      if (wants && !run.stop) this.begin(run);
      else if (!wants && run.stop) this.halt(run);
      else if (run.drawing && (other || run.seen !== this.sees(run))) this.draw(run);
      return run;
    });
    this.listenToTransforms(new Set(next.filter((l) => l.stop).map((l) => l.owner).filter((owner) => owner !== '')));
    this.list = next;
    this.onChange.emit();
  }

  private choose(found: Layer[]): Layer[] {
    const selected = this.store.selected()?.instance?.name ?? null;
    const owners = [...new Set(found.map((l) => l.owner))].filter((o) => o !== '');
    const wanted = selected !== null && owners.includes(selected) ? [selected] : found.length <= layers_max ? owners : owners.slice(0, 1);
    this.hidden = owners.length - wanted.length;
    return found.filter((l) => l.owner === '' || wanted.includes(l.owner)).slice(0, 2 * layers_max);
  }

  private isOn(kind: LayerKind, label: string, of_device: boolean): boolean {
    return this.switched[`${kind} ${label}`] ?? onFirst(kind, of_device);
  }

  private sees(layer: Layer): boolean {
    return this.shown && layer.on;
  }

  private begin(layer: Running): void {
    layer.stop = this.client.subscribe(layer.topic, (message) => {
      layer.latest = message;
      this.soon();
    });
  }

  private soon(): void {
    if (this.flushing === 0) this.flushing = requestAnimationFrame(() => this.flush());
  }

  private halt(layer: Running): void {
    layer.stop?.();
    Object.assign(layer, {stop: null, latest: null, bytes: null, drawing: null, seen: false, info: '', note: ''});
    this.scene.setLayer(layer.topic, null, startOf(undefined, undefined), 0);
  }

  private end(layer: Running): void {
    this.halt(layer);
    this.running.delete(layer.topic);
  }

  /** Another world, or another time of it: what was drawn was of the one before. */
  private forget(): void {
    for (const layer of this.running.values()) if (layer.stop) {
      this.halt(layer);
      this.begin(layer);
    }
    for (const each of this.transforms.values()) each.latest = each.told = null;
    this.onChange.emit();
  }

  private flush(): void {
    this.flushing = 0;
    const begin_ms = performance.now();
    let told = this.takeTransforms();
    for (const layer of this.running.values()) {
      const message = layer.latest;
      layer.latest = null;
      if (!message || !layer.stop || sameContent(layer.bytes, message.bytes)) continue;
      layer.bytes = message.bytes;
      const before = `${layer.frame} ${layer.info} ${layer.note}`;
      this.take(layer, message);
      told ||= before !== `${layer.frame} ${layer.info} ${layer.note}`;
    }
    this.scene.addScript(performance.now() - begin_ms);
    if (told) this.onChange.emit();
  }

  /** @return whether there is a frame of which nothing was told before */
  private takeTransforms(): boolean {
    const moved = new Set<string>();
    let fresh = false;
    for (const each of this.transforms.values()) {
      if (each.latest === null) continue;
      const told = toldOf(each.latest.value());
      each.latest = null;
      if (told === null) continue;
      fresh ||= each.told?.child !== told.child;
      if (each.told?.child === told.child && each.told.parent === told.parent && each.told.pose.every((v, i) => v === told.pose[i])) continue;
      each.told = told;
      moved.add(`${each.owner} ${told.child}`);
    }
    for (const layer of this.running.values()) if (layer.drawing && layer.frame !== null && moved.has(`${layer.owner} ${layer.frame}`)) this.draw(layer);
    return fresh;
  }

  private take(layer: Running, message: Message): void {
    const too_long = tooLong(layer.kind, message.bytes.length);
    const value = too_long === null ? message.value() as {header?: {frame_id?: string}} | undefined : undefined;
    const made = too_long !== null ? {drawing: null, info: '', note: too_long} : drawingOf(layer.kind, value, this.scene.map_side_max);
    const fresh_frame = value !== undefined && layer.frame !== (value.header?.frame_id ?? '');
    if (value !== undefined) layer.frame = value.header?.frame_id ?? '';
    Object.assign(layer, made);
    this.draw(layer);
    // A map tells where its frame is: what else is given in it moves there.
    if (fresh_frame && (layer.kind === 'map' || layer.kind === 'particles')) this.placeAll();
  }

  private draw(layer: Running): void {
    layer.seen = this.sees(layer);
    this.scene.setLayer(layer.topic, layer.seen ? layer.drawing : null, this.framePose(layer.frame ?? '', layer.owner, layer.topic), layer.color);
  }

  private placeAll(): void {
    for (const layer of this.running.values()) if (layer.drawing) this.draw(layer);
  }
}

const order: Record<LayerKind, number> = {map: 0, path: 1, particles: 2, pose: 3};
const goal_order: Record<LayerKind, number> = {map: 0, particles: 1, path: 2, pose: 3};

/** Whether a topic is of a device, and then of a level that measures now: others have nothing to say. */
export function levelOf(instance: Instance | undefined, topic: string): 'active' | 'inactive' | null {
  for (const device of instance?.devices ?? []) {
    const found = (device.topics ?? []).find((t) => t.name === topic);
    if (found) return found.level === '' || device.active.includes(found.level) ? 'active' : 'inactive';
  }
  return null;
}

function keyOf(layer: Layer): string {
  return `${layer.kind} ${layer.label}`;
}
