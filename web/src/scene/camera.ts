// Where the eye is. A rig keeps a goal (target, azimuth, elevation, distance) and goes there smoothly; modes set the goal.
//
// Frame: azimuth is the heading from the target to the eye about z, elevation its angle above the ground, radians.
import * as THREE from 'three';
import { fitPoints } from './fit';

export type CameraMode = 'orbit' | 'static' | 'follow' | 'tv' | 'race' | 'top' | 'robot';

/** What a mode that keeps to a robot needs to know of it. */
export interface Subject {
  position: THREE.Vector3;
  yaw_rad: number;
  radius_m: number;
  /** World pose of its camera, or of its front: eye and orientation (x forward, z up). */
  eye: THREE.Vector3;
  forward: THREE.Vector3;
  up: THREE.Vector3;
}

interface View {
  target: THREE.Vector3;
  azimuth: number;
  elevation: number;
  distance: number;
}

const UP = new THREE.Vector3(0, 0, 1);
const FOV_DEG = 45;
const NEAREST_M = 0.08;
const FARTHEST_M = 1500;
/** Of what is missing to the goal, e-fold per this time. */
const GLIDE_S = 0.09;
const FLIGHT_S = 0.22;

export class CameraRig {
  readonly perspective = new THREE.PerspectiveCamera(FOV_DEG, 1, 0.05, 4000);
  readonly orthographic = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 4000);
  mode: CameraMode = 'orbit';
  private readonly goal: View = { target: new THREE.Vector3(0, 0, 0.2), azimuth: -2.2, elevation: 0.46, distance: 8 };
  private readonly now: View = { target: new THREE.Vector3(0, 0, 0.2), azimuth: -2.2, elevation: 0.46, distance: 8 };
  private flight_s = 0;
  private race_yaw = 0;
  private readonly stand = new THREE.Vector3();
  private stand_age_s = Infinity;
  private fov_deg = FOV_DEG;
  private readonly eye = new THREE.Vector3();
  private readonly look = new THREE.Vector3();
  private readonly eye_quaternion = new THREE.Quaternion();
  private readonly basis = new THREE.Matrix4();
  private aspect = 1;
  /** How much of the way from one mode's view to the next is done. */
  private blend = 1;
  private readonly blend_position = new THREE.Vector3();
  private readonly blend_quaternion = new THREE.Quaternion();
  private blend_fov = FOV_DEG;

  constructor() {
    this.perspective.up.copy(UP);
    this.orthographic.up.set(0, 1, 0);
  }

  get camera(): THREE.PerspectiveCamera | THREE.OrthographicCamera {
    return this.mode === 'top' ? this.orthographic : this.perspective;
  }

  get focus(): THREE.Vector3 {
    return this.now.target;
  }

  /** How far the eye is from what it looks at. */
  get reach_m(): number {
    return this.now.distance;
  }

  setAspect(aspect: number): void {
    this.aspect = aspect;
  }

  setMode(mode: CameraMode, subject: Subject | null): void {
    if (this.mode !== 'top') {
      this.blend_position.copy(this.perspective.position);
      this.blend_quaternion.copy(this.perspective.quaternion);
      this.blend_fov = this.perspective.fov;
      this.blend = mode === 'top' ? 1 : 0;
    }
    const was = this.mode;
    this.mode = mode;
    this.stand_age_s = Infinity;
    if (mode === 'top' && (was === 'race' || was === 'tv' || was === 'robot')) {
      // Their distance is that of a chase; a plan wants some surroundings.
      this.goal.target.copy(this.now.target);
      this.goal.distance = this.now.distance = Math.max(8, this.goal.distance);
    }
    if (subject) {
      this.race_yaw = subject.yaw_rad;
      if (mode === 'follow') {
        this.goal.target.copy(subject.position);
        this.goal.distance = Math.min(this.goal.distance, Math.max(3, 12 * subject.radius_m));
      }
    }
  }

  /** Goes to where a ball fills the view. */
  frame(center: THREE.Vector3, radius_m: number): void {
    this.goal.target.copy(center);
    const half = ((FOV_DEG / 2) * Math.PI) / 180;
    const fit = Math.min(1, this.aspect);
    this.goal.distance = clamp((1.15 * radius_m) / Math.sin(Math.atan(Math.tan(half) * fit)), 4 * NEAREST_M, FARTHEST_M);
    this.goal.elevation = clamp(this.goal.elevation, 0.25, 1.1);
    this.flight_s = FLIGHT_S * 5;
    this.leaveRobot();
  }

  private leaveRobot(): void {
    if (this.mode === 'static' || this.mode === 'robot' || this.mode === 'tv' || this.mode === 'race') this.setMode('orbit', null);
  }

  /**
   * Goes to where these points fill the view, round the world where that brings them much nearer. `steepness`: height of
   * the walls by the width of the place; who looks into a house looks from above. `keep_heading`: from where it looks now.
   * @return how far away that is
   */
  frameAll(points: readonly THREE.Vector3[], steepness = 0, keep_heading = false): number {
    const azimuths = keep_heading ? [this.goal.azimuth] : [-2.2, -Math.PI, -Math.PI / 2, -2.7, -1.1];
    // A view that stands upright has room for what is seen from further above.
    const elevation = Math.min(1.1, (this.aspect < 1 ? 0.8 : 0.5) + 3 * steepness);
    const fit = fitPoints(points, azimuths, elevation, Math.tan(((FOV_DEG / 2) * Math.PI) / 180), this.aspect);
    this.goal.target.copy(fit.target);
    this.goal.azimuth = fit.azimuth;
    this.goal.elevation = elevation;
    this.goal.distance = clamp(fit.distance, 4 * NEAREST_M, FARTHEST_M);
    this.flight_s = FLIGHT_S * 5;
    this.leaveRobot();
    return this.goal.distance;
  }

  /** There at once: for the first sight of a world. */
  settle(): void {
    this.copy(this.goal, this.now);
    this.blend = 1;
  }

  /** Turns by a drag of so many pixels. */
  orbit(dx: number, dy: number): void {
    if (this.mode === 'top') return;
    if (this.mode === 'static' || this.mode === 'robot' || this.mode === 'tv' || this.mode === 'race') return;
    this.goal.azimuth -= dx * 0.0055;
    this.goal.elevation = clamp(this.goal.elevation + dy * 0.0055, -0.2, 1.5);
  }

  /** Shifts the target so that the ground keeps under the pointer; `height_px` of the view. */
  pan(dx: number, dy: number, height_px: number): void {
    if (this.mode !== 'orbit' && this.mode !== 'top') return;
    const per_px = (2 * Math.tan(((FOV_DEG / 2) * Math.PI) / 180) * this.now.distance) / height_px;
    if (this.mode === 'top') {
      this.goal.target.x -= dx * per_px;
      this.goal.target.y += dy * per_px;
    } else {
      const c = Math.cos(this.now.azimuth), s = Math.sin(this.now.azimuth);
      const lift = Math.max(0.25, Math.sin(Math.abs(this.now.elevation)));
      this.goal.target.x += (dx * s - (dy * c) / lift) * per_px;
      this.goal.target.y += (-dx * c - (dy * s) / lift) * per_px;
    }
    this.now.target.copy(this.goal.target);
  }

  /** Nearer (factor < 1) or farther, about the point under the cursor when there is one. */
  zoom(factor: number, about: THREE.Vector3 | null): void {
    if (this.mode === 'static' || this.mode === 'robot' || this.mode === 'tv') return;
    const before = this.goal.distance;
    this.goal.distance = clamp(before * factor, NEAREST_M, FARTHEST_M);
    if (about && (this.mode === 'orbit' || this.mode === 'top')) {
      const keep = this.goal.distance / before;
      this.goal.target.sub(about).multiplyScalar(keep).add(about);
    }
  }

  /**
   * One step of time. `is_hidden(eye, subject)`: something stands between them. True while the view still changes.
   */
  update(dt_s: number, subject: Subject | null, is_hidden: (from: THREE.Vector3, to: THREE.Vector3) => boolean): boolean {
    this.flight_s = Math.max(0, this.flight_s - dt_s);
    const glide = 1 - Math.exp(-dt_s / (this.flight_s > 0 ? FLIGHT_S : GLIDE_S));
    const camera = this.perspective;
    this.fov_deg = FOV_DEG;
    let changes = false;
    switch (this.mode) {
      case 'follow':
        if (subject) this.goal.target.copy(subject.position);
        changes = this.glideTo(glide);
        this.lookFromView();
        break;
      case 'race':
        if (subject) {
          this.goal.target.copy(subject.position);
          const turned = wrap(subject.yaw_rad - this.race_yaw);
          this.race_yaw += turned * (1 - Math.exp(-dt_s / 0.35));
          changes = Math.abs(turned) > 1e-3;
          this.now.target.lerp(subject.position, 1 - Math.exp(-dt_s / 0.06));
          this.now.azimuth = this.goal.azimuth = this.race_yaw + Math.PI;
          this.goal.elevation = this.now.elevation += (0.36 - this.now.elevation) * glide;
          const back = clamp(7 * subject.radius_m, 0.8, 30);
          this.goal.distance = this.now.distance += (back - this.now.distance) * glide;
        }
        this.lookFromView();
        this.look.z += subject ? subject.radius_m : 0;
        break;
      case 'tv':
        changes = this.television(dt_s, subject, is_hidden);
        break;
      case 'robot':
        if (subject) {
          this.eye.copy(subject.eye);
          this.look.copy(subject.eye).add(subject.forward);
          this.now.target.copy(subject.position);
          this.fov_deg = 70;
        } else {
          this.lookFromView();
        }
        break;
      case 'static':
        break;
      case 'top':
        changes = this.glideTo(glide);
        this.placeTop();
        return changes;
      default:
        changes = this.glideTo(glide);
        this.lookFromView();
    }
    const up = this.mode === 'robot' && subject ? subject.up : UP;
    this.basis.lookAt(this.eye, this.look, up);
    this.eye_quaternion.setFromRotationMatrix(this.basis);
    if (this.mode !== 'static') {
      camera.position.copy(this.eye);
      camera.quaternion.copy(this.eye_quaternion);
    }
    changes = this.blendIn(dt_s) || changes;
    // As far away as may be: thin things that lie on each other need all of the depth there is.
    const near = clamp(this.now.distance * 0.05, 0.01, 4);
    if (camera.fov !== this.fov_deg || camera.aspect !== this.aspect || Math.abs(camera.near - near) > near * 0.2) {
      camera.fov = this.fov_deg;
      camera.aspect = this.aspect;
      camera.near = near;
      camera.updateProjectionMatrix();
    }
    camera.updateMatrixWorld();
    return changes;
  }

  private glideTo(glide: number): boolean {
    const { now, goal } = this;
    const before = now.distance;
    now.target.lerp(goal.target, glide);
    now.azimuth += wrap(goal.azimuth - now.azimuth) * glide;
    now.elevation += (goal.elevation - now.elevation) * glide;
    now.distance *= Math.exp(Math.log(goal.distance / now.distance) * glide);
    return (
      now.target.distanceToSquared(goal.target) > (1e-4 * before) ** 2 ||
      Math.abs(wrap(goal.azimuth - now.azimuth)) > 1e-4 ||
      Math.abs(goal.elevation - now.elevation) > 1e-4 ||
      Math.abs(goal.distance / now.distance - 1) > 1e-4
    );
  }

  private lookFromView(): void {
    const { target, azimuth, elevation, distance } = this.now;
    const flat = Math.cos(elevation) * distance;
    this.eye.set(target.x + Math.cos(azimuth) * flat, target.y + Math.sin(azimuth) * flat, target.z + Math.sin(elevation) * distance);
    // Not below the ground that most worlds have, as long as what is looked at is above it.
    if (target.z > -0.5) this.eye.z = Math.max(this.eye.z, 0.04);
    this.look.copy(target);
  }

  private placeTop(): void {
    const camera = this.orthographic;
    const half = Math.tan(((FOV_DEG / 2) * Math.PI) / 180) * this.now.distance;
    camera.top = half;
    camera.bottom = -half;
    camera.right = half * this.aspect;
    camera.left = -camera.right;
    camera.position.set(this.now.target.x, this.now.target.y, this.now.target.z + 200);
    camera.rotation.set(0, 0, 0);
    camera.near = 0.1;
    camera.far = 1000;
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
  }

  /** A stand beside the track that turns and zooms, and gives way to a better one when the robot is far or hidden. */
  private television(dt_s: number, subject: Subject | null, is_hidden: (from: THREE.Vector3, to: THREE.Vector3) => boolean): boolean {
    if (!subject) {
      this.lookFromView();
      return false;
    }
    this.stand_age_s += dt_s;
    const reach = clamp(18 * subject.radius_m, 4, 60);
    const away = this.stand.distanceTo(subject.position);
    const is_new = this.stand_age_s === Infinity;
    if (is_new || (this.stand_age_s > 1.5 && (away > 1.8 * reach || is_hidden(this.stand, subject.position)))) {
      this.chooseStand(subject, reach, is_hidden);
      this.now.target.copy(subject.position);
    }
    this.eye.copy(this.stand);
    this.now.target.lerp(subject.position, 1 - Math.exp(-dt_s / 0.12));
    this.look.copy(this.now.target);
    const size = clamp(this.eye.distanceTo(subject.position), 0.5, 1e3);
    this.now.distance = size;
    this.fov_deg = clamp((2 * Math.atan((4.5 * subject.radius_m) / size) * 180) / Math.PI, 6, 50);
    return this.now.target.distanceToSquared(subject.position) > 1e-6;
  }

  private chooseStand(subject: Subject, reach: number, is_hidden: (from: THREE.Vector3, to: THREE.Vector3) => boolean): void {
    // Ahead and to a side first, then around: the first from which it is seen.
    const candidate = new THREE.Vector3();
    for (let n = 0; n < 12; ++n) {
      const heading = subject.yaw_rad + 0.7 + (n * 2.39996) * (n > 0 ? 1 : 0);
      const distance = reach * (n < 6 ? 0.75 : 0.4);
      candidate.set(subject.position.x + Math.cos(heading) * distance, subject.position.y + Math.sin(heading) * distance, subject.position.z + 0.28 * distance);
      this.stand.copy(candidate);
      if (!is_hidden(candidate, subject.position)) break;
    }
    this.stand_age_s = 0;
  }

  private blendIn(dt_s: number): boolean {
    if (this.blend >= 1) return false;
    this.blend = Math.min(1, this.blend + dt_s / 0.5);
    if (this.mode === 'static') return false;
    const t = this.blend * this.blend * (3 - 2 * this.blend);
    const camera = this.perspective;
    camera.position.lerpVectors(this.blend_position, this.eye, t);
    camera.quaternion.slerpQuaternions(this.blend_quaternion, this.eye_quaternion, t);
    this.fov_deg = this.blend_fov + (this.fov_deg - this.blend_fov) * t;
    return true;
  }

  private copy(from: View, to: View): void {
    to.target.copy(from.target);
    to.azimuth = from.azimuth;
    to.elevation = from.elevation;
    to.distance = from.distance;
  }
}

const clamp = (v: number, low: number, high: number): number => Math.min(high, Math.max(low, v));
const wrap = (angle: number): number => Math.atan2(Math.sin(angle), Math.cos(angle));
