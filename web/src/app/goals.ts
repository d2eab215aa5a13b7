// Poses by hand: a place on the ground and a heading, published for the programs of a robot that read such a topic: /ROBOT/goal_pose,
// /ROBOT/initialpose, or whatever they call it.
import type {Client} from '../net/client';
import {Signal} from '../net/signal';
import type {World} from '../protocol';
import {yawOf} from '../scene/poses';
import type {Aim, SceneView} from '../scene/scene';
import {goalMessage, isPoseType, PoseType} from './layer_data';
import type {Layers} from './layers';
import type {Store} from './store';

export interface GoalInput {
  /** "/rover/goal_pose". */
  topic: string;
  type: PoseType;
  /** That read it: "rover/navigator". */
  programs: string[];
}

/** Topics on which a robot is told poses, by its programs and its team's that run; those for goals first. */
export function goalInputs(world: World | null, robot: string): GoalInput[] {
  const instance = world?.instances.find((i) => i.name === robot && i.robot);
  if (!world || !instance) return [];
  const team = (world.teams ?? []).find((t) => t.name === instance.team);
  const found = new Map<string, GoalInput>();
  for (const program of [...(instance.controllers ?? []), ...(team?.programs ?? [])]) {
    if (program.inactive) continue;
    for (const {name, type} of program.inputs ?? []) {
      if (!isPoseType(type)) continue;
      const known = found.get(`${name} ${type}`);
      if (known) known.programs.push(program.path);
      else found.set(`${name} ${type}`, {topic: name, type, programs: [program.path]});
    }
  }
  const first = (input: GoalInput): number => (isGoal(input) ? 0 : 1);
  return [...found.values()].sort((a, b) => first(a) - first(b) || (a.topic < b.topic ? -1 : 1));
}

/** Where to go; else: where it is. */
export function isGoal(input: GoalInput): boolean {
  return input.type === 'geometry_msgs/msg/PoseStamped';
}

/** "goal_pose" of "/rover/goal_pose"; of its team's it is the whole, "/red/goal_pose". */
export function inputName(input: GoalInput, robot: string): string {
  const own = `/${robot}/`;
  return input.topic.startsWith(own) ? input.topic.slice(own.length) : input.topic;
}

export class Goals {
  /** Whom the next pose is for. */
  robot: string | null = null;
  /** What it can be told, and which of these the next pose is. */
  inputs: GoalInput[] = [];
  input: GoalInput | null = null;
  /** Newest status of the program that reads the pose, as it publishes it: "failed: the goal (9, 9) is off the map". Empty: none. */
  status = '';
  /** What can be told, or the status, has changed while the tool is held. */
  readonly onChange = new Signal();
  private publisher: {key: string; publish: (value: unknown) => boolean; close: () => void} | null = null;
  /** Name of what was chosen last: another robot is told the same if it can be. */
  private chosen = '';
  /** The topic of the status. */
  private watched = '';
  private stopWatching = (): void => undefined;

  constructor(private readonly client: Client, private readonly store: Store, private readonly scene: SceneView, private readonly layers: Layers,
              private readonly tell: (text: string, kind?: 'info' | 'warning') => void) {
    store.onEpoch.on(() => scene.showGoal(null));
    // Controllers come and go while the run goes on.
    store.onWorld.on(() => {
      if (this.robot === null) return;
      this.setInputs(goalInputs(store.world, this.robot));
      this.onChange.emit();
    });
  }

  /** The tool is taken up. Null, or why it is of no use, as a sentence. */
  begin(): string | null {
    this.end();
    const {world} = this.store;
    const able = (world?.instances ?? []).filter((i) => i.robot && goalInputs(world, i.name).length > 0).map((i) => i.name);
    const selected = this.store.selected()?.instance;
    const robot = selected?.robot ? selected.name : able.length === 1 ? (able[0] as string) : null;
    if (robot === null) return able.length === 0 ? 'No robot of this run takes goals: no program that runs reads a topic of poses, such as goal_pose.' : 'Select the robot first that shall go somewhere.';
    if (!able.includes(robot)) return `${robot} takes no goals: none of its programs that run reads a topic of poses, such as /${robot}/goal_pose.`;
    this.robot = robot;
    this.setInputs(goalInputs(world, robot));
    this.layers.hold(robot);
    return null;
  }

  /** The tool is put away; the flag stays. */
  end(): void {
    this.robot = this.input = null;
    this.inputs = [];
    this.watch();
    this.layers.hold(null);
  }

  choose(input: GoalInput): void {
    this.chosen = inputName(input, this.robot ?? '');
    this.input = input;
    this.watch();
  }

  aim(aim: Aim): void {
    const {robot, input} = this;
    if (aim.phase === 'cancel' || robot === null || input === null) {
      this.scene.showGoal(null);
      return;
    }
    const yaw_rad = aim.yaw_rad ?? this.usualYaw(robot, aim.at);
    if (aim.phase !== 'end') {
      this.scene.showGoal(aim.at, yaw_rad, aim.pointer);
      return;
    }
    this.scene.showGoal(aim.at, yaw_rad);
    // Where nothing is known of the program: a goal is in the world, so that one which counts from elsewhere refuses it; a first pose is in the
    // program's own frame, which has no name yet, and whose map is the world's.
    const frame = this.layers.goalFrame(robot, input.programs[0] ?? '') ?? (isGoal(input) ? 'world' : '');
    const X_WF = this.layers.framePose(frame, robot);
    const message = goalMessage(input.type, frame, X_WF, aim.at, yaw_rad, this.store.time_s) as {pose: {position?: {x: number; y: number}; pose?: {position: {x: number; y: number}}}};
    if (!this.publisherOf(input).publish(message)) {
      this.tell('The pose could not be sent', 'warning');
      return;
    }
    const {x, y} = (message.pose.pose ?? message.pose).position as {x: number; y: number};
    this.tell(`${robot} ${isGoal(input) ? 'is sent to' : 'is told that it is at'} ${x.toFixed(2)}, ${y.toFixed(2)}${frame === '' ? '' : ` in ${frame}`}`);
  }

  /** Without a drag the robot arrives as it comes: from where it is; and is turned as it is. */
  private usualYaw(robot: string, at: readonly number[]): number {
    const from = this.scene.pose(robot);
    if (!from) return 0;
    if (this.input && !isGoal(this.input)) return yawOf([0, 0, 0, ...from.quaternion], 0);
    return Math.atan2((at[1] ?? 0) - from.position[1], (at[0] ?? 0) - from.position[0]);
  }

  private setInputs(inputs: GoalInput[]): void {
    this.inputs = inputs;
    this.input = inputs.find((i) => i.topic === this.input?.topic && i.type === this.input.type) ?? inputs.find((i) => inputName(i, this.robot ?? '') === this.chosen) ?? inputs[0] ?? null;
    this.watch();
  }

  /** Follows the status of the program that reads the chosen pose, if it publishes one. */
  private watch(): void {
    const programs = this.input?.programs ?? [];
    const topic = [...this.client.channels.values()].find((c) => c.schemaName === 'diagnostic_msgs/msg/DiagnosticStatus' && programs.some((p) => c.topic.startsWith(`/${p}/`)))?.topic ?? '';
    if (topic === this.watched) return;
    this.stopWatching();
    this.stopWatching = () => undefined;
    this.watched = topic;
    this.status = '';
    if (topic === '') return;
    this.stopWatching = this.client.subscribe(topic, (message) => {
      const {message: text} = message.value() as {message: string};
      if (text === this.status) return;
      this.status = text;
      this.onChange.emit();
    });
  }

  private publisherOf(input: GoalInput): {publish: (value: unknown) => boolean} {
    const key = `${input.topic} ${input.type}`;
    if (this.publisher?.key !== key) {
      this.publisher?.close();
      this.publisher = {key, ...this.client.publisher(input.topic, input.type)};
    }
    return this.publisher;
  }
}
