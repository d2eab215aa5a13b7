// Where the links of an instance are, from its base and its joints:
//
//   X_WC = X_WP * X_PC(rest) * X_CJ * motion * inverse(X_CJ)
//
// What does not move is multiplied out once per model, so that a link costs two products per message.
import { Motion, motionOf, type PoseSlot } from '../binary';
import type { Model } from '../protocol';
import { invert, isFinitePose, multiply } from './poses';

/** What all instances of a model share. */
export class Chain {
  readonly links: number;
  readonly motions: Uint8Array;
  /** Links in an order in which parents come first; without the first link. */
  private readonly order: Int32Array;
  private readonly parents: Int32Array;
  /** X_PJ at rest and inverse(X_CJ), 7 numbers per link. */
  private readonly before: Float64Array;
  private readonly after: Float64Array;
  private readonly axes: Float64Array;
  private readonly slide_m_per_rad: Float64Array;
  private readonly rest: Float64Array;
  private readonly moved = new Float64Array(7);
  private readonly motion = new Float64Array(7);

  constructor(model: Model) {
    const count = model.links.length;
    this.links = count;
    this.motions = new Uint8Array(count);
    this.parents = new Int32Array(count).fill(-1);
    this.before = new Float64Array(7 * count);
    this.after = new Float64Array(7 * count);
    this.axes = new Float64Array(3 * count);
    this.slide_m_per_rad = new Float64Array(count);
    this.rest = new Float64Array(7 * count);
    const inverse = new Float64Array(7);
    const relative = new Float64Array(7);
    model.links.forEach((link, i) => {
      this.rest.set(link.pose, 7 * i);
      const joint = i === 0 ? undefined : model.joints[link.joint];
      this.motions[i] = motionOf(joint);
      const parent = model.links[link.parent];
      if (joint === undefined) return;
      if (parent !== undefined && link.parent !== i) {
        this.parents[i] = link.parent;
        invert(parent.pose, 0, inverse, 0);
        multiply(inverse, 0, link.pose, 0, relative, 0);
      } else {
        relative.set(link.pose);
      }
      multiply(relative, 0, joint.pose, 0, this.before, 7 * i);
      invert(joint.pose, 0, this.after, 7 * i);
      const length = Math.hypot(...joint.axis) || 1;
      for (let c = 0; c < 3; ++c) this.axes[3 * i + c] = joint.axis[c] / length;
      this.slide_m_per_rad[i] = joint.thread_pitch_m / (2 * Math.PI) || 0;
    });
    this.order = parentsFirst(this.parents);
  }

  /** Links at rest with the model frame at `pose`: what is drawn before the first message. */
  placeAtRest(pose: readonly number[], world: Float64Array): void {
    for (let i = 0; i < this.links; ++i) multiply(pose as number[], 0, this.rest, 7 * i, world, 7 * i);
  }

  /**
   * Fills `world` (7 numbers per link) from what a message told. False, and nothing changed, when it told a pose that is
   * not finite; `scratch` at least as long as `world`.
   */
  place(slot: PoseSlot, world: Float64Array, scratch: Float64Array, model_pose: readonly number[]): boolean {
    const values = slot.values;
    if (slot.form === 1) {
      for (let i = 0; i < this.links; ++i) if (!isFinitePose(values, 7 * i)) return false;
      world.set(values);
      return true;
    }
    if (!isFinitePose(values, 0)) return false;
    for (let c = 0; c < 7; ++c) scratch[c] = values[c];
    for (let n = 0; n < this.order.length; ++n) {
      const i = this.order[n];
      const at = 7 * i;
      const motion = this.motions[i];
      if (motion === Motion.Free) {
        if (!isFinitePose(values, at)) return false;
        for (let c = 0; c < 7; ++c) scratch[at + c] = values[at + c];
        continue;
      }
      const parent = this.parents[i];
      // To J at rest...
      if (parent < 0) multiply(model_pose as number[], 0, this.before, at, this.moved, 0);
      else multiply(scratch, 7 * parent, this.before, at, this.moved, 0);
      // ... the motion there, and back to C.
      this.motionInJ(i, values, at);
      multiply(this.moved, 0, this.motion, 0, scratch, at);
      multiply(scratch, at, this.after, at, this.moved, 0);
      if (motion === Motion.Turn) {
        this.turn(scratch, at, values, parent);
      } else {
        for (let c = 0; c < 7; ++c) scratch[at + c] = this.moved[c];
      }
      if (!isFinitePose(scratch, at)) return false;
    }
    // `scratch` may be longer, and a view of its part would be an allocation.
    for (let c = 0; c < 7 * this.links; ++c) world[c] = scratch[c];
    return true;
  }

  private motionInJ(i: number, values: Float64Array, at: number): void {
    const m = this.motion;
    m[0] = m[1] = m[2] = m[4] = m[5] = m[6] = 0;
    m[3] = 1;
    const motion = this.motions[i];
    if (motion === Motion.Fixed || motion === Motion.Turn) return;
    const x = this.axes[3 * i], y = this.axes[3 * i + 1], z = this.axes[3 * i + 2];
    const value = values[at];
    const slide_m = motion === Motion.Slide ? value : motion === Motion.Screw ? value * this.slide_m_per_rad[i] : 0;
    m[0] = x * slide_m;
    m[1] = y * slide_m;
    m[2] = z * slide_m;
    if (motion === Motion.Slide) return;
    const s = Math.sin(value / 2);
    m[3] = Math.cos(value / 2);
    m[4] = x * s;
    m[5] = y * s;
    m[6] = z * s;
  }

  /** A ball's record tells the orientation of the child in the parent; J, here at scratch[at], stays where it is. */
  private turn(scratch: Float64Array, at: number, values: Float64Array, parent: number): void {
    const joint_x = scratch[at], joint_y = scratch[at + 1], joint_z = scratch[at + 2];
    const m = this.motion;
    m[0] = m[1] = m[2] = 0;
    for (let c = 3; c < 7; ++c) m[c] = values[at + c];
    if (parent >= 0) {
      multiply(scratch, 7 * parent, m, 0, this.moved, 0);
    } else {
      for (let c = 0; c < 7; ++c) this.moved[c] = m[c];
    }
    // Origin of C: J's place less J's offset in C, which the inverse of inverse(X_CJ) tells.
    invert(this.after, at, m, 0);
    m[3] = 1;
    m[4] = m[5] = m[6] = 0;
    this.moved[0] = this.moved[1] = this.moved[2] = 0;
    multiply(this.moved, 0, m, 0, scratch, at);
    for (let c = 3; c < 7; ++c) scratch[at + c] = this.moved[c];
    scratch[at] = joint_x - scratch[at];
    scratch[at + 1] = joint_y - scratch[at + 1];
    scratch[at + 2] = joint_z - scratch[at + 2];
  }
}

/** Links but the first, parents before children; what is caught in a ring (no sane model) comes last. */
function parentsFirst(parents: Int32Array): Int32Array {
  const done = new Uint8Array(parents.length);
  done[0] = 1;
  const order: number[] = [];
  for (let before = -1; before !== order.length; ) {
    before = order.length;
    for (let i = 1; i < parents.length; ++i) {
      if (done[i] || (parents[i] >= 0 && !done[parents[i]])) continue;
      done[i] = 1;
      order.push(i);
    }
  }
  for (let i = 1; i < parents.length; ++i) if (!done[i]) order.push(i);
  return Int32Array.from(order);
}
