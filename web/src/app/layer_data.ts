// What layers draw, made of messages: nothing here knows the page or the scene.
import type {Drawing} from '../scene/overlays/layers';
import type {Instance, Pose} from '../protocol';
import {ellipseOf, spreadOf} from '../scene/ellipse';
import {invert, multiply, transform, yawOf} from '../scene/poses';

export type LayerKind = 'map' | 'path' | 'particles' | 'pose';

export const cells_max = 4_000_000;
export const poses_max = 10_000;
export const particles_max = 5_000;
/** Longer messages are not even read. */
const bytes_max: Record<LayerKind, number> = {map: cells_max + 4096, path: 16 << 20, particles: 8 << 20, pose: 1 << 16};
/** A position that is less sure than this is not known: programs that measure none say 1e6 and the like. */
const known_m = 200;

export function layerKindOf(type: string): LayerKind | null {
  const name = type.replace('/msg/', '/');
  return name === 'nav_msgs/OccupancyGrid' ? 'map' : name === 'nav_msgs/Path' ? 'path' : name === 'geometry_msgs/PoseArray' ? 'particles'
    : name === 'nav_msgs/Odometry' || name === 'geometry_msgs/PoseWithCovarianceStamped' ? 'pose' : null;
}

export interface Made {
  drawing: Drawing | null;
  /** In a few words, for the legend. */
  info: string;
  /** Why something is left out; empty: all is drawn. */
  note: string;
}

const nothing = (note: string): Made => ({drawing: null, info: '', note});

/** What is said of a message that is too long to be read; null: it is read. */
export function tooLong(kind: LayerKind, bytes: number): string | null {
  return bytes <= bytes_max[kind] ? null : `Not drawn: a message of ${(bytes / 1e6).toFixed(1)} MB, more than ${(bytes_max[kind] / 1e6).toFixed(1)} MB`;
}

interface RosPose {
  position: {x: number; y: number; z: number};
  orientation: {x: number; y: number; z: number; w: number};
}

function poseOf(pose: RosPose, out: Float64Array, at: number): boolean {
  const {position: p, orientation: q} = pose;
  out[at] = p.x;
  out[at + 1] = p.y;
  out[at + 2] = p.z;
  const norm = Math.hypot(q.w, q.x, q.y, q.z);
  // A pose without an orientation, as some programs send: not turned.
  if (norm > 1e-6) for (const [i, v] of [q.w, q.x, q.y, q.z].entries()) out[at + 3 + i] = v / norm;
  else out.set([1, 0, 0, 0], at + 3);
  return Number.isFinite(p.x + p.y + p.z + norm);
}

/** Every n-th of a list, with the last one, so that at most `most` remain. */
export function thinned<T>(list: readonly T[], most: number): T[] {
  if (list.length <= most) return [...list];
  const every = Math.ceil((list.length - 1) / (most - 1));
  const kept = list.filter((_, i) => i % every === 0);
  if ((list.length - 1) % every !== 0) kept.push(list[list.length - 1] as T);
  return kept;
}

function posesOf(kind: 'path' | 'particles', poses: readonly RosPose[]): Made {
  const most = kind === 'path' ? poses_max : particles_max;
  // Of particles the order says nothing, so any n-th do; a path keeps its end.
  const kept = kind === 'path' ? thinned(poses, most) : poses.filter((_, i) => i % Math.ceil(poses.length / most) === 0);
  const values = new Float64Array(7 * kept.length);
  let count = 0;
  for (const pose of kept) if (poseOf(pose, values, 7 * count)) ++count;
  const what = kind === 'path' ? 'poses' : 'particles';
  const bad = kept.length - count;
  const note = [kept.length < poses.length ? `${kept.length} of ${poses.length} ${what} are drawn` : '', bad > 0 ? `${bad} of them ${bad === 1 ? 'is' : 'are'} not finite and left out` : ''].filter((text) => text !== '').join('; ');
  return {drawing: {kind, poses: values.subarray(0, 7 * count)}, info: `${poses.length} ${poses.length === 1 ? what.slice(0, -1) : what}`, note};
}

const metres = (m: number): string => (m >= 10 ? `${m.toFixed(0)} m` : m >= 0.1 ? `${m.toFixed(2)} m` : `${(100 * m).toFixed(1)} cm`);

/** @param value  a message as the readers give it; null drawing: there is nothing to be drawn, and why */
export function drawingOf(kind: LayerKind, value: unknown, side_max = 16384): Made {
  const message = (value ?? {}) as Record<string, unknown>;
  if (kind === 'path') return posesOf('path', ((message.poses ?? []) as {pose: RosPose}[]).map((p) => p.pose));
  if (kind === 'particles') return posesOf('particles', (message.poses ?? []) as RosPose[]);
  const place = new Float64Array(7);
  if (kind === 'map') {
    const info = message.info as {resolution: number; width: number; height: number; origin: RosPose} | undefined;
    const data = message.data as ArrayLike<number> | undefined;
    if (!info || !data) return nothing('Not drawn: no map');
    const {width, height, resolution} = info;
    const size = `${width} × ${height}, ${metres(resolution)}`;
    if (width * height > cells_max) return nothing(`Not drawn: ${width} × ${height} cells are more than ${cells_max / 1e6} million`);
    if (Math.max(width, height) > side_max) return nothing(`Not drawn: a side of ${Math.max(width, height)} cells; this browser draws ${side_max}`);
    if (width * height === 0) return nothing(`Not drawn: a map of ${width} × ${height} cells`);
    if (!(resolution > 0) || !Number.isFinite(resolution)) return nothing(`Not drawn: its cells have a side of ${resolution} m`);
    if (data.length !== width * height) return nothing(`Not drawn: ${data.length} cells for ${size}`);
    if (!poseOf(info.origin, place, 0)) return nothing('Not drawn: its origin is not finite');
    const cells = data instanceof Int8Array ? new Uint8Array(data.buffer, data.byteOffset, data.length) : Uint8Array.from(data as number[], (v) => v & 255);
    return {drawing: {kind: 'map', width, height, resolution_m: resolution, origin: place, cells}, info: size, note: ''};
  }
  const with_covariance = message.pose as {pose: RosPose; covariance: ArrayLike<number>} | undefined;
  if (!with_covariance || !poseOf(with_covariance.pose, place, 0)) return nothing('Not drawn: its position is not finite');
  const all = with_covariance.covariance ?? [];
  const {covariance, why} = spreadOf(all);
  const deviation_m = covariance === null ? 0 : ellipseOf(covariance[0] as number, covariance[1] as number, covariance[4] as number).major_m;
  const unknown = deviation_m > known_m;
  const heading_rad = 2 * Math.sqrt(all[35] ?? 0);
  return {
    drawing: {kind: 'pose', pose: place, covariance: unknown ? null : covariance, heading_rad: heading_rad > 0 && heading_rad < Math.PI / 2 ? heading_rad : 0},
    info: why !== '' ? 'no ellipse' : covariance === null ? '' : unknown ? 'unsure' : `± ${metres(deviation_m)}`,
    note: why === '' ? '' : `Drawn without an ellipse: ${why}`,
  };
}

/** Whether two messages say the same but for their time: behind the four bytes of CDR's header stands the stamp, of eight. */
export function sameContent(a: Uint8Array | null, b: Uint8Array): boolean {
  if (a === null || a.length !== b.length || a.length < 12) return false;
  // Eight bytes at a time where both lie alike, which a map of millions of cells is worth.
  let i = 12;
  while (i < a.length && (a.byteOffset + i) % 8 !== 0) {
    if (a[i] !== b[i]) return false;
    ++i;
  }
  if ((a.byteOffset - b.byteOffset) % 8 === 0) {
    const words = (a.length - i) >> 3;
    const x = new BigUint64Array(a.buffer, a.byteOffset + i, words);
    const y = new BigUint64Array(b.buffer, b.byteOffset + i, words);
    for (let w = 0; w < words; ++w) if (x[w] !== y[w]) return false;
    i += 8 * words;
  }
  for (; i < a.length; ++i) if (a[i] !== b[i]) return false;
  return true;
}

// --- frames

/** Where a frame's origin is: in the world's, on a body of it, where the robot was when it began, or as a TransformStamped says. */
export type Place = 'world' | 'start' | 'body' | 'told';

/**
 * The world has the frames `world`, `<robot>/<link>` and `<robot>/<device>`. Others are what programs count from: `odom` is where the robot
 * began, unless a program tells where it is, as one that localises does. Any other is the world's if particles or a map are given in it, since
 * those are made of the world; but not by the map of a frame named after the robot, such as `mario/map`, which is made where a filter of its own
 * believes it to be. Else it begins with the robot, too.
 * @param kinds  of the layers that are given in the frame
 */
export function placeOf(frame: string, owner: Instance | null, bodies: (frame: string) => boolean, kinds: readonly LayerKind[], is_told = false): Place {
  if (frame === '' || frame === 'world') return 'world';
  if (bodies(frame)) return 'body';
  if (is_told) return 'told';
  if (!owner?.start) return 'world';
  const last = frame.slice(frame.lastIndexOf('/') + 1);
  const of_world = kinds.includes('particles') || (kinds.includes('map') && !frame.startsWith(`${owner.name}/`));
  return /^odom/.test(last) || !of_world ? 'start' : 'world';
}

const identity = Float64Array.of(0, 0, 0, 1, 0, 0, 0);

/**
 * The pose in the world of what began with the robot: upright, with the heading of its first link, as programs count that know what is level.
 * @param tilted  as the link stood: of those that do not know
 */
export function startOf(start: Pose | undefined, first_link: Pose | undefined, tilted = false): Float64Array {
  if (!start) return identity;
  const out = new Float64Array(7);
  multiply(start, 0, first_link ?? [...identity], 0, out, 0);
  if (tilted) return out;
  const yaw = yawOf(out, 0);
  out.set([Math.cos(yaw / 2), 0, 0, Math.sin(yaw / 2)], 3);
  return out;
}

/** What a geometry_msgs/TransformStamped tells of its child frame. */
export interface Told {
  parent: string;
  child: string;
  pose: Float64Array;
}

/** Null: it tells nothing that can be used. */
export function toldOf(value: unknown): Told | null {
  const {header, child_frame_id, transform} = (value ?? {}) as {header?: {frame_id?: string}; child_frame_id?: string; transform?: {translation: RosPose['position']; rotation: RosPose['orientation']}};
  if (!header?.frame_id || !child_frame_id || header.frame_id === child_frame_id || !transform) return null;
  const pose = new Float64Array(7);
  return poseOf({position: transform.translation, orientation: transform.rotation}, pose, 0) ? {parent: header.frame_id, child: child_frame_id, pose} : null;
}

// --- goals

/** Topics that people may give a pose on. */
export type PoseType = 'geometry_msgs/msg/PoseStamped' | 'geometry_msgs/msg/PoseWithCovarianceStamped';

export function isPoseType(type: string): type is PoseType {
  return type === 'geometry_msgs/msg/PoseStamped' || type === 'geometry_msgs/msg/PoseWithCovarianceStamped';
}

/** How unsure a place is that somebody has pointed at: 0.5 m, 15 degrees, as RViz says. */
const pointed_variance_m2 = 0.25;
const pointed_variance_rad2 = 0.06853891945200942;

/** A pose on the ground as a message of a type, in a frame that lies at `X_WF`. */
export function goalMessage(type: PoseType, frame_id: string, X_WF: Float64Array, at: readonly number[], yaw_rad: number, time_s: number): unknown {
  const X_FW = new Float64Array(7);
  invert(X_WF, 0, X_FW, 0);
  const point = [0, 0, 0];
  transform(X_FW, 0, at[0] ?? 0, at[1] ?? 0, at[2] ?? 0, point);
  const turned = new Float64Array(7);
  multiply(X_FW, 0, [0, 0, 0, Math.cos(yaw_rad / 2), 0, 0, Math.sin(yaw_rad / 2)], 0, turned, 0);
  const yaw = yawOf(turned, 0);
  const sec = Math.floor(time_s);
  const header = {stamp: {sec, nanosec: Math.floor((time_s - sec) * 1e9)}, frame_id};
  const pose = {position: {x: point[0], y: point[1], z: point[2]}, orientation: {x: 0, y: 0, z: Math.sin(yaw / 2), w: Math.cos(yaw / 2)}};
  if (type === 'geometry_msgs/msg/PoseStamped') return {header, pose};
  const covariance = new Array<number>(36).fill(0);
  covariance[0] = covariance[7] = pointed_variance_m2;
  covariance[35] = pointed_variance_rad2;
  return {header, pose: {pose, covariance}};
}
