// What docs/viewer_protocol.md says, as types. Its binary channels are in binary.ts.

/** [x, y, z, qw, qx, qy, qz], metres. */
export type Pose = [number, number, number, number, number, number, number];
export type Vector = [number, number, number];
/** Red, green, blue, alpha, 0 to 1. */
export type Color = [number, number, number, number];

export type Shape =
  | { type: 'box'; size: Vector }
  | { type: 'sphere'; radius: number }
  | { type: 'cylinder' | 'capsule' | 'cone'; radius: number; length: number }
  | { type: 'barrel'; radius: number; length: number; profile: number }
  | { type: 'plane'; normal: Vector }
  | { type: 'ellipsoid'; radii: Vector }
  | { type: 'mesh'; mesh: string; scale?: Vector }
  | { type: 'heightmap'; grid: string };

export interface Material {
  diffuse: Color;
  specular?: Color;
  emissive?: Color;
  shininess?: number;
  /** Id of an asset, "t2"; absent or empty: none. */
  texture?: string;
  /** The colours of the mesh's parts count, not `diffuse`. */
  from_mesh?: boolean;
}

export interface Visual {
  name: string;
  pose: Pose;
  shape: Shape;
  material: Material;
  cast_shadows?: boolean;
}

export interface Collision {
  name: string;
  pose: Pose;
  shape: Shape;
}

export interface Light {
  type: 'directional' | 'point' | 'spot';
  name: string;
  pose: Pose;
  color: Color;
  cast_shadows: boolean;
  range_m: number;
  constant: number;
  linear: number;
  quadratic: number;
  inner_rad: number;
  outer_rad: number;
}

export interface Link {
  name: string;
  /** In the model frame, all joints at 0. */
  pose: Pose;
  /** Index of the parent link; -1: the world, or none. */
  parent: number;
  /** Index of the joint that carries this link; -1: none. */
  joint: number;
  visuals: Visual[];
  collisions: Collision[];
  lights?: Light[];
}

export type JointType = 'revolute' | 'continuous' | 'prismatic' | 'ball' | 'universal' | 'screw' | 'fixed';

export interface Joint {
  name: string;
  type: JointType;
  parent: number;
  child: number;
  /** Of J in the child link. */
  pose: Pose;
  /** In J. */
  axis: Vector;
  lower: number | null;
  upper: number | null;
  /** Metres per turn. */
  thread_pitch_m: number;
}

export interface Model {
  id: string;
  name: string;
  static: boolean;
  links: Link[];
  joints: Joint[];
}

export interface Topic {
  name: string;
  type: string;
  level: string;
}

export interface Device {
  name: string;
  /** "rover/laser". */
  path: string;
  kind: string;
  /** Index of the link that carries it. */
  link: number;
  /** In the link. */
  pose: Pose;
  active: string[];
  topics: Topic[];
  commands: Topic[];
}

/** A program, a medium or a rule: it has keys and values, and no place in the scene. */
export interface Part {
  name: string;
  /** "rover/controller", "red/coach", "media/air", "rules/goals". */
  path: string;
  kind: string;
  /** Of a program that was stopped, or is not started yet. */
  inactive?: boolean;
  /** Topics that clients may publish for a program: "/rover/goal_pose", "geometry_msgs/msg/PoseStamped". */
  inputs?: {name: string; type: string}[];
}

export interface Team {
  name: string;
  programs: Part[];
}

export interface Instance {
  id: number;
  name: string;
  original: string;
  model: string;
  robot: boolean;
  team: string;
  /** Of the model frame, when the world was told. */
  pose: Pose;
  /** Of the model frame when the run, or the robot, began; robots only. */
  start?: Pose;
  devices: Device[];
  controllers: Part[];
}

export interface Field {
  path: string;
  type: string;
  unit: string;
  help: string;
  min: number | null;
  max: number | null;
  tunable: boolean;
  default: string;
  choices: string[];
  length: number;
}

export interface Level {
  name: string;
  message: string;
  command: string;
  help: string;
}

export interface Kind {
  help: string;
  levels: Level[];
  fields: Field[];
}

/** An area on the ground that rules and sensors know; it has no body. */
export interface Marker {
  name: string;
  color: [number, number, number, number];
  /** Whether it is painted on the ground, where cameras see it. */
  painted: boolean;
  /** Simple polygons that together cover the area; they may overlap. */
  outlines: [number, number, number][][];
}

/** A part of the ground with a surface of its own. */
export interface Zone {
  name: string;
  centre: Vector;
  radius_m: number;
  /** Of one that is not round. */
  corners: Vector[];
  friction: number;
  rolling_resistance_m: number;
  belt_velocity: Vector;
  hole: boolean;
}

/** What the run (team '') or a team is judged by. */
export interface Criterion {
  team: string;
  /** Of its present value. */
  address: string;
  value: string;
  success?: string;
}

export interface World {
  revision: number;
  epoch: number;
  name: string;
  engine: string;
  step_s: number;
  seed: number;
  gravity: Vector;
  ambient: Color;
  background: Color;
  lights: Light[];
  zones?: Zone[];
  markers?: Marker[];
  media?: Part[];
  rules?: Part[];
  criteria?: Criterion[];
  teams?: Team[];
  models: Model[];
  instances: Instance[];
  /** Of devices and programs by their names, of others as "media/shout" and "rules/goals". */
  kinds: Record<string, Kind>;
}

export type RunState = 'playing' | 'paused' | 'seeking' | 'ended' | 'failed';

export interface Status {
  state: RunState;
  time_s: number;
  tick: number;
  step_s: number;
  /** null: as fast as possible. */
  speed: number | null;
  real_time_factor: number;
  late_ticks: number;
  reason: string;
  begin_s: number;
  end_s: number | null;
  kept_from_s?: number;
  history_s: number[];
  target_s: number | null;
  may_steer: boolean;
  may_rewind: boolean;
  why_not: string;
  replay: boolean;
  recording: { file: string; messages: number; bytes: number } | null;
  viewers: number;
  epoch: number;
  dropped_frames: number;
}

export interface Command {
  tick: number;
  time_s: number;
  source: 'admin' | 'robot' | 'program';
  id: number;
  sequence: number;
  kind: string;
  target: string;
  text: string;
  refused: boolean;
  why: string;
}

export interface Commands {
  commands: Command[];
}

/** Seconds; of the latest thousand. */
export interface Durations {
  last: number;
  mean: number;
  p99: number;
  max: number;
}

/** A program that a client in lockstep answers for. */
export interface AnsweredProgram {
  path: string;
  control_period_s: number;
  deadline_s: number;
  steps: number;
  misses: number;
  /** Since the step that it has not answered was sent; null: it has answered all. */
  waiting_s: number | null;
  /** From a step sent to its answer. */
  latency_s: Durations | null;
  /** From a step sent to the next. */
  step_s: Durations | null;
  /** All latencies: counts per bin from `first_s` on, `per_decade` bins to a factor of ten. */
  latencies: { first_s: number; per_decade: number; counts: number[] };
}

export interface ClientRow {
  id: number;
  protocol: string;
  address: string;
  name: string;
  role: string;
  drives: string;
  robots: string[];
  mode: 'watching' | 'free' | 'lockstep';
  connected_s: number;
  bytes_in: number;
  bytes_out: number;
  messages: number;
  messages_per_s: number;
  commands: number;
  commands_per_s: number;
  dropped: number;
  refused: number;
  stops: number;
  programs: AnsweredProgram[];
}

/** A program outside the simulation's process: a client answers for it, or a process that the run has started. */
export interface OutsideProgram {
  path: string;
  kind: string;
  is_client: boolean;
  connected: boolean;
  started: boolean;
  answers: number;
  misses: number;
}

/** What /sandlot/clients says: to administrators all, to others themselves. */
export interface Clients {
  clients: ClientRow[];
  programs: OutsideProgram[];
}
