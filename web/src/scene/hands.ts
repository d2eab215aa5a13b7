// Pointers: what turns the view, what selects, and what takes hold of a body.
//
//   left drag        orbits; on the selected body, or with the move tool, moves; with the pull tool or ctrl, pulls
//   right drag       pans; with the move tool on a body, turns it
//   middle, shift    pan
//   while moving     shift: up and down; alt: turn
//   touch            one finger orbits, two zoom and pan, a long press selects and drags
//   goal tool        left press or one finger: where; drag: the heading; release: sent
import * as THREE from 'three';

export type Tool = 'orbit' | 'move' | 'pull' | 'goal';
export type DragMode = 'move' | 'turn' | 'pull';

export interface Drag {
  name: string;
  link: string;
  mode: DragMode;
  phase: 'start' | 'move' | 'end';
  target: [number, number, number];
  yaw?: number;
  /** In the link: where it was grabbed. */
  point?: [number, number, number];
}

/** A place on the ground with a heading that a hand points out. */
export interface Aim {
  phase: 'start' | 'move' | 'end' | 'cancel';
  at: [number, number, number];
  /** Where the hand is. */
  pointer: [number, number, number];
  /** Null: it was not dragged. */
  yaw_rad: number | null;
}

/** What can be taken hold of, as the scene knows it. */
export interface Grip {
  name: string;
  link: string;
  /** Where the ray met it, in the world and in the link. */
  at: THREE.Vector3;
  in_link: [number, number, number];
  /** Pose of its first link. */
  base: THREE.Vector3;
  yaw_rad: number;
}

export interface HandsHost {
  ray(x: number, y: number): THREE.Ray;
  /** A body that may be dragged. */
  grip(x: number, y: number): Grip | null;
  isSelected(name: string): boolean;
  selectAt(x: number, y: number): void;
  frameAt(x: number, y: number): void;
  hoverAt(x: number, y: number): void;
  leave(): void;
  orbit(dx: number, dy: number): void;
  pan(dx: number, dy: number): void;
  zoom(factor: number, x: number, y: number): void;
  drag(drag: Drag): void;
  /** What is under a place of the view; null: the sky. */
  groundAt(x: number, y: number): THREE.Vector3 | null;
  aim(aim: Aim): void;
  viewDirection(): THREE.Vector3;
}

const CLICK_PX = 5;
const LONG_PRESS_MS = 450;
const DRAGS_PER_S = 30;

interface Held {
  grip: Grip;
  mode: DragMode;
  plane: THREE.Plane;
  offset: THREE.Vector3;
  target: THREE.Vector3;
  yaw: number;
  begun: boolean;
}

export class Hands {
  tool: Tool = 'orbit';
  /** What the pointer that is down does. */
  private held: Held | null = null;
  private gesture: 'none' | 'orbit' | 'pan' | 'drag' | 'aim' = 'none';
  private aimed: Aim | null = null;
  private readonly pointers = new Map<number, { x: number; y: number }>();
  private down = { x: 0, y: 0, time_ms: 0 };
  private strayed = false;
  private press_timer = 0;
  private last_sent_ms = 0;
  private pending_timer = 0;
  private last_click = { x: 0, y: 0, time_ms: 0 };
  private pinch_px = 0;
  private hover_timer = 0;
  private readonly hit = new THREE.Vector3();
  private readonly off: (() => void)[] = [];

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly host: HandsHost,
  ) {
    const on = <K extends keyof HTMLElementEventMap>(type: K, handler: (event: HTMLElementEventMap[K]) => void, options?: AddEventListenerOptions): void => {
      canvas.addEventListener(type, handler as EventListener, options);
      this.off.push(() => canvas.removeEventListener(type, handler as EventListener, options));
    };
    on('pointerdown', (e) => this.onDown(e));
    on('pointermove', (e) => this.onMove(e));
    on('pointerup', (e) => this.onUp(e));
    on('pointercancel', (e) => this.onCancel(e));
    on('pointerleave', () => this.host.leave());
    on('wheel', (e) => this.onWheel(e), { passive: false });
    on('contextmenu', (e) => e.preventDefault());
  }

  get isDragging(): boolean {
    return this.gesture === 'drag';
  }

  /** The line of a pull, from the grabbed point (in the link) to the target; null: nothing is pulled. */
  get pull(): { name: string; link: string; in_link: [number, number, number]; target: THREE.Vector3 } | null {
    const held = this.held;
    return held?.begun && held.mode === 'pull' ? { name: held.grip.name, link: held.grip.link, in_link: held.grip.in_link, target: held.target } : null;
  }

  dispose(): void {
    for (const off of this.off) off();
    window.clearTimeout(this.press_timer);
    window.clearTimeout(this.pending_timer);
    window.clearTimeout(this.hover_timer);
  }

  private place(event: MouseEvent): { x: number; y: number } {
    const box = this.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  private onDown(event: PointerEvent): void {
    const at = this.place(event);
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, at);
    if (this.pointers.size === 2) {
      this.endDrag();
      this.endAim('cancel');
      this.gesture = 'pan';
      this.pinch_px = this.spread();
      window.clearTimeout(this.press_timer);
      return;
    }
    if (this.pointers.size > 2) return;
    this.down = { ...at, time_ms: event.timeStamp };
    this.strayed = false;
    const touch = event.pointerType === 'touch';
    if (this.tool === 'goal' && event.button === 0 && !event.shiftKey) {
      const at = this.host.groundAt(this.down.x, this.down.y)?.toArray() ?? null;
      this.gesture = 'aim';
      if (at) this.host.aim((this.aimed = { phase: 'start', at, pointer: at, yaw_rad: null }));
      return;
    }
    const grip = touch || event.button === 1 ? null : this.host.grip(at.x, at.y);
    const pulls = this.tool === 'pull' || event.ctrlKey || event.metaKey;
    this.gesture = event.button === 2 || event.button === 1 || (event.shiftKey && !grip) ? 'pan' : 'orbit';
    if (grip && event.button === 0 && (pulls || this.tool === 'move' || this.host.isSelected(grip.name))) {
      this.take(grip, pulls ? 'pull' : event.altKey ? 'turn' : 'move');
    } else if (grip && event.button === 2 && this.tool === 'move') {
      this.take(grip, 'turn');
    }
    if (touch) {
      this.press_timer = window.setTimeout(() => {
        if (this.strayed || this.pointers.size !== 1) return;
        this.host.selectAt(at.x, at.y);
        const found = this.host.grip(at.x, at.y);
        if (found) this.take(found, this.tool === 'pull' ? 'pull' : 'move');
        navigator.vibrate?.(12);
      }, LONG_PRESS_MS);
    }
  }

  private onMove(event: PointerEvent): void {
    const at = this.place(event);
    const before = this.pointers.get(event.pointerId);
    if (before === undefined) {
      // Hovering: at most so often, since it asks every triangle nearby.
      if (this.hover_timer === 0 && event.pointerType !== 'touch') {
        this.hover_timer = window.setTimeout(() => {
          this.hover_timer = 0;
          this.host.hoverAt(at.x, at.y);
        }, 50);
      }
      return;
    }
    const dx = at.x - before.x;
    const dy = at.y - before.y;
    if (this.pointers.size === 2) {
      this.pointers.set(event.pointerId, at);
      const spread = this.spread();
      const middle = this.middle();
      // Each finger reports by itself: half of the way each.
      this.host.pan(dx / 2, dy / 2);
      if (spread > 10 && this.pinch_px > 10) this.host.zoom(this.pinch_px / spread, middle.x, middle.y);
      this.pinch_px = spread;
      return;
    }
    this.pointers.set(event.pointerId, at);
    if (!this.strayed && Math.hypot(at.x - this.down.x, at.y - this.down.y) < CLICK_PX) return;
    this.strayed = true;
    window.clearTimeout(this.press_timer);
    if (this.gesture === 'aim') this.moveAim(at);
    else if (this.held) this.moveHeld(at, event);
    else if (this.gesture === 'orbit') this.host.orbit(dx, dy);
    else if (this.gesture === 'pan') this.host.pan(dx, dy);
  }

  private onUp(event: PointerEvent): void {
    const at = this.place(event);
    const was_alone = this.pointers.size === 1;
    this.pointers.delete(event.pointerId);
    window.clearTimeout(this.press_timer);
    const was_aim = this.gesture === 'aim';
    const was_drag = this.gesture === 'drag' && this.held?.begun;
    this.endDrag();
    this.endAim('end');
    this.gesture = this.pointers.size > 0 ? 'orbit' : 'none';
    if (this.strayed || was_drag || was_aim || !was_alone || event.button > 0) return;
    if (event.timeStamp - this.down.time_ms > LONG_PRESS_MS && event.pointerType === 'touch') return;
    const again = event.timeStamp - this.last_click.time_ms < 350 && Math.hypot(at.x - this.last_click.x, at.y - this.last_click.y) < 8;
    this.last_click = { ...at, time_ms: again ? 0 : event.timeStamp };
    if (again) this.host.frameAt(at.x, at.y);
    else this.host.selectAt(at.x, at.y);
  }

  private onCancel(event: PointerEvent): void {
    this.pointers.delete(event.pointerId);
    window.clearTimeout(this.press_timer);
    this.endDrag();
    this.endAim('cancel');
    this.gesture = 'none';
  }

  /** What was begun with the goal tool is given up. */
  giveUp(): void {
    this.endAim('cancel');
  }

  private moveAim(at: { x: number; y: number }): void {
    const aim = this.aimed;
    if (aim === null) return;
    // On the level of the goal: what stands behind it, or a slope, does not turn it.
    const met = this.meet(this.host.ray(at.x, at.y), new THREE.Plane(new THREE.Vector3(0, 0, 1), -aim.at[2]));
    if (!met || Math.hypot(met.x - aim.at[0], met.y - aim.at[1]) < 1e-3) return;
    aim.phase = 'move';
    aim.pointer = [met.x, met.y, met.z];
    aim.yaw_rad = Math.atan2(met.y - aim.at[1], met.x - aim.at[0]);
    this.host.aim(aim);
  }

  private endAim(phase: 'end' | 'cancel'): void {
    const aim = this.aimed;
    this.aimed = null;
    if (aim) this.host.aim({ ...aim, phase });
  }

  private onWheel(event: WheelEvent): void {
    event.preventDefault();
    const at = this.place(event);
    // Lines and pages as pixels; a mouse's notch is some 100 of them.
    const px = event.deltaY * (event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? 400 : 1);
    this.host.zoom(Math.exp(Math.min(200, Math.max(-200, px)) * 0.0014), at.x, at.y);
  }

  private take(grip: Grip, mode: DragMode): void {
    const normal = mode === 'pull' ? this.host.viewDirection().negate() : new THREE.Vector3(0, 0, 1);
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, grip.at);
    this.held = { grip, mode, plane, offset: grip.base.clone().sub(grip.at), target: mode === 'pull' ? grip.at.clone() : grip.base.clone(), yaw: grip.yaw_rad, begun: false };
    this.gesture = 'drag';
  }

  private moveHeld(at: { x: number; y: number }, event: PointerEvent): void {
    const held = this.held;
    if (held === null) return;
    const ray = this.host.ray(at.x, at.y);
    if (held.mode === 'turn' || (held.mode === 'move' && event.altKey)) {
      held.mode = 'turn';
      // About the body's middle: by the angle that the pointer goes around it on the ground, as seen from above.
      const met = this.meet(ray, held.plane);
      if (met) held.yaw = held.grip.yaw_rad + Math.atan2(met.y - held.grip.base.y, met.x - held.grip.base.x) - Math.atan2(held.grip.at.y - held.grip.base.y, held.grip.at.x - held.grip.base.x);
    } else if (held.mode === 'move' && event.shiftKey) {
      // Upright plane that faces the eye: only the height is taken from it.
      const facing = this.host.viewDirection().setZ(0);
      if (facing.lengthSq() < 1e-6) return;
      const upright = new THREE.Plane().setFromNormalAndCoplanarPoint(facing.normalize(), held.target.clone().sub(held.offset));
      const met = this.meet(ray, upright);
      if (met) {
        held.target.z = met.z + held.offset.z;
        held.plane.constant = -met.z;
      }
    } else {
      const met = this.meet(ray, held.plane);
      if (met) {
        if (held.mode === 'pull') held.target.copy(met);
        else held.target.set(met.x + held.offset.x, met.y + held.offset.y, held.target.z);
      }
    }
    if (!held.begun) {
      held.begun = true;
      this.tell(held, 'start');
    } else {
      this.tellSoon(held);
    }
  }

  /** Where the ray meets the plane, in reason: near the horizon a pixel would be kilometres. */
  private meet(ray: THREE.Ray, plane: THREE.Plane): THREE.Vector3 | null {
    const met = ray.intersectPlane(plane, this.hit);
    return met && met.distanceTo(ray.origin) < 500 ? met : null;
  }

  private tellSoon(held: Held): void {
    const wait_ms = this.last_sent_ms + 1000 / DRAGS_PER_S - performance.now();
    if (wait_ms <= 0) {
      this.tell(held, 'move');
    } else if (this.pending_timer === 0) {
      this.pending_timer = window.setTimeout(() => {
        this.pending_timer = 0;
        if (this.held === held) this.tell(held, 'move');
      }, wait_ms);
    }
  }

  private endDrag(): void {
    const held = this.held;
    this.held = null;
    window.clearTimeout(this.pending_timer);
    this.pending_timer = 0;
    if (held?.begun) this.tell(held, 'end');
  }

  private tell(held: Held, phase: Drag['phase']): void {
    this.last_sent_ms = performance.now();
    const { x, y, z } = held.target;
    const drag: Drag = { name: held.grip.name, link: held.grip.link, mode: held.mode, phase, target: [x, y, z] };
    if (held.mode === 'turn') drag.yaw = held.yaw;
    if (held.mode === 'pull') drag.point = held.grip.in_link;
    this.host.drag(drag);
  }

  private spread(): number {
    const [a, b] = [...this.pointers.values()];
    return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  }

  private middle(): { x: number; y: number } {
    const [a, b] = [...this.pointers.values()];
    return a && b ? { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 } : { x: 0, y: 0 };
  }
}
