// Decoders of the binary channels of docs/viewer_protocol.md: poses, contacts, deliveries, charges.
//
// They allocate nothing per record: they write into arrays that their caller keeps. Hostile or damaged bytes give `false`,
// never an exception and never a read beyond the message.

import type {Joint} from './protocol';

/** How a record tells the pose of a link behind the first. */
export const enum Motion {
  Fixed = 0,
  Angle = 1,
  Slide = 2,
  Screw = 3,
  Turn = 4,
  Free = 5,
}

/** The motion that a link's joint allows; `joint` undefined: no joint carries it. */
export function motionOf(joint: Joint | undefined): Motion {
  switch (joint?.type) {
    case 'revolute':
    case 'continuous':
      return Motion.Angle;
    case 'prismatic':
      return Motion.Slide;
    case 'screw':
      return Motion.Screw;
    case 'ball':
    case 'universal':
      return Motion.Turn;
    case 'fixed':
      return Motion.Fixed;
    default:
      return Motion.Free;
  }
}

/** Where the decoder puts what it read of one instance: what it expects and what it found. */
export interface PoseSlot {
  /** Per link, in the model's order; the first counts as Free. */
  motions: Uint8Array;
  /**
   * Seven numbers per link: Angle, Screw [rad] and Slide [m] use the first, Turn the last four (w x y z),
   * Free all as a Pose in the world.
   */
  values: Float64Array;
  /** 0: `motions` holds; 1: every link is Free in this message. */
  form: number;
}

export interface PosesHeader {
  key_frame: boolean;
  epoch: number;
  revision: number;
  tick: number;
  time_s: number;
  count: number;
}

export function emptyPosesHeader(): PosesHeader {
  return { key_frame: false, epoch: 0, revision: 0, tick: 0, time_s: 0, count: 0 };
}

const POSES_HEADER_BYTES = 28;
const TURN = (2 * Math.PI) / 65536;

/** Reads the header alone, so that a message of another world can be put away. */
export function readPosesHeader(view: DataView, header: PosesHeader): boolean {
  if (view.byteLength < POSES_HEADER_BYTES || view.getUint8(0) !== 1) return false;
  header.key_frame = (view.getUint8(1) & 1) !== 0;
  header.epoch = view.getUint16(2, true);
  header.revision = view.getUint32(4, true);
  header.tick = readU64(view, 8);
  header.time_s = readI64(view, 16) * 1e-9;
  header.count = view.getUint32(24, true);
  return true;
}

/**
 * Decodes a message of /sandlot/poses. `slotOf` gives the place for an instance; undefined: not known here, which
 * ends the message (a record does not tell its length) and gives false. `moved` is told each instance read.
 */
export function decodePoses(
  bytes: ArrayBuffer | Uint8Array,
  header: PosesHeader,
  slotOf: (id: number) => PoseSlot | undefined,
  moved: (id: number, slot: PoseSlot) => void,
): boolean {
  const view = viewOf(bytes);
  if (!readPosesHeader(view, header)) return false;
  const end = view.byteLength;
  let at = POSES_HEADER_BYTES;
  for (let record = 0; record < header.count; ++record) {
    if (at + 23 > end) return false;
    const id = view.getUint32(at, true);
    const form = view.getUint8(at + 4);
    const slot = slotOf(id);
    if (slot === undefined || form > 1) return false;
    at += 5;
    slot.form = form;
    const motions = slot.motions;
    const values = slot.values;
    for (let link = 0; link < motions.length; ++link) {
      const to = link * 7;
      const motion = link === 0 || form === 1 ? Motion.Free : motions[link];
      if (at + MOTION_BYTES[motion] > end) return false;
      switch (motion) {
        case Motion.Free:
          values[to] = view.getFloat32(at, true);
          values[to + 1] = view.getFloat32(at + 4, true);
          values[to + 2] = view.getFloat32(at + 8, true);
          readSmallestThree(view, at + 12, values, to + 3);
          break;
        case Motion.Angle:
          values[to] = view.getUint16(at, true) * TURN;
          break;
        case Motion.Slide:
        case Motion.Screw:
          values[to] = view.getFloat32(at, true);
          break;
        case Motion.Turn:
          readSmallestThree(view, at, values, to + 3);
          break;
      }
      at += MOTION_BYTES[motion];
    }
    moved(id, slot);
  }
  return at === end;
}

/** Bytes of a record's part, by Motion. */
const MOTION_BYTES = [0, 2, 4, 4, 6, 18];

/** An orientation from 48 bits, into values[to ...] as w x y z. */
export function readSmallestThree(view: DataView, at: number, values: Float64Array, to: number): void {
  const low = view.getUint32(at, true);
  const high = view.getUint16(at + 4, true);
  const left_out = low & 3;
  const scale = Math.SQRT2 / 32767;
  // 15 bits each: bits 2 to 16, 17 to 31, 32 to 46.
  const a = ((low >>> 2) & 0x7fff) * scale - Math.SQRT1_2;
  const b = ((low >>> 17) & 0x7fff) * scale - Math.SQRT1_2;
  const c = (high & 0x7fff) * scale - Math.SQRT1_2;
  const rest = Math.sqrt(Math.max(0, 1 - a * a - b * b - c * c));
  values[to] = left_out === 0 ? rest : a;
  values[to + 1] = left_out === 1 ? rest : left_out === 0 ? a : b;
  values[to + 2] = left_out === 2 ? rest : left_out === 3 ? c : b;
  values[to + 3] = left_out === 3 ? rest : c;
}

/** What /sandlot/contacts says: 7 numbers per contact (point, unit normal, depth). */
export interface Contacts {
  tick: number;
  time_s: number;
  count: number;
  /** Grows as needed and is kept. */
  values: Float32Array;
}

export function emptyContacts(): Contacts {
  return { tick: 0, time_s: 0, count: 0, values: new Float32Array(7 * 64) };
}

const CONTACTS_HEADER_BYTES = 20;

export function decodeContacts(bytes: ArrayBuffer | Uint8Array, contacts: Contacts): boolean {
  const view = viewOf(bytes);
  contacts.count = 0;
  if (view.byteLength < CONTACTS_HEADER_BYTES) return false;
  const count = view.getUint32(16, true);
  if (view.byteLength !== CONTACTS_HEADER_BYTES + count * 28) return false;
  contacts.tick = readU64(view, 0);
  contacts.time_s = readI64(view, 8) * 1e-9;
  if (contacts.values.length < count * 7) contacts.values = new Float32Array(count * 14);
  for (let i = 0; i < count * 7; ++i) {
    contacts.values[i] = view.getFloat32(CONTACTS_HEADER_BYTES + i * 4, true);
  }
  contacts.count = count;
  return true;
}

/** What /sandlot/deliveries says: per link 6 numbers (sender, receiver, medium, deliveries, channel, strength). */
export interface Deliveries {
  tick: number;
  time_s: number;
  count: number;
  /** Grows as needed and is kept. */
  values: Float64Array;
}

export function emptyDeliveries(): Deliveries {
  return { tick: 0, time_s: 0, count: 0, values: new Float64Array(6 * 64) };
}

const COUNTED_HEADER_BYTES = 20;
const DELIVERY_BYTES = 20;

export function decodeDeliveries(bytes: ArrayBuffer | Uint8Array, deliveries: Deliveries): boolean {
  const view = viewOf(bytes);
  deliveries.count = 0;
  if (view.byteLength < COUNTED_HEADER_BYTES) return false;
  const count = view.getUint32(16, true);
  if (view.byteLength !== COUNTED_HEADER_BYTES + count * DELIVERY_BYTES) return false;
  deliveries.tick = readU64(view, 0);
  deliveries.time_s = readI64(view, 8) * 1e-9;
  if (deliveries.values.length < count * 6) deliveries.values = new Float64Array(count * 12);
  const values = deliveries.values;
  for (let i = 0, at = COUNTED_HEADER_BYTES; i < count * 6; i += 6, at += DELIVERY_BYTES) {
    values[i] = view.getUint32(at, true);
    values[i + 1] = view.getUint32(at + 4, true);
    values[i + 2] = view.getUint16(at + 8, true);
    values[i + 3] = view.getUint16(at + 10, true);
    values[i + 4] = view.getInt32(at + 12, true);
    values[i + 5] = view.getFloat32(at + 16, true);
  }
  deliveries.count = count;
  return true;
}

/** What /sandlot/batteries says. */
export interface Batteries {
  tick: number;
  time_s: number;
  count: number;
  /** Of the instances. These lists grow as needed and are kept. */
  ids: Uint32Array;
  /** Shares, 0 to 1; 0: nothing is left. */
  charges: Float32Array;
}

export function emptyBatteries(): Batteries {
  return { tick: 0, time_s: 0, count: 0, ids: new Uint32Array(64), charges: new Float32Array(64) };
}

export function decodeBatteries(bytes: ArrayBuffer | Uint8Array, batteries: Batteries): boolean {
  const view = viewOf(bytes);
  batteries.count = 0;
  if (view.byteLength < COUNTED_HEADER_BYTES) return false;
  const count = view.getUint32(16, true);
  if (view.byteLength !== COUNTED_HEADER_BYTES + count * 8) return false;
  batteries.tick = readU64(view, 0);
  batteries.time_s = readI64(view, 8) * 1e-9;
  if (batteries.ids.length < count) {
    batteries.ids = new Uint32Array(count * 2);
    batteries.charges = new Float32Array(count * 2);
  }
  for (let i = 0, at = COUNTED_HEADER_BYTES; i < count; ++i, at += 8) {
    batteries.ids[i] = view.getUint32(at, true);
    const charge = view.getFloat32(at + 4, true);
    batteries.charges[i] = Number.isFinite(charge) ? charge : 0;
  }
  batteries.count = count;
  return true;
}

function viewOf(bytes: ArrayBuffer | Uint8Array): DataView {
  return bytes instanceof ArrayBuffer
    ? new DataView(bytes)
    : new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
}

/** Exact below 2^53, which is 285 million years of ticks of a microsecond or 104 days in nanoseconds. */
function readU64(view: DataView, at: number): number {
  return view.getUint32(at, true) + view.getUint32(at + 4, true) * 4294967296;
}

function readI64(view: DataView, at: number): number {
  return view.getUint32(at, true) + view.getInt32(at + 4, true) * 4294967296;
}
