// Where a robot is sent: a flag with an arrow for the heading; with a line to the pointer while the hand still aims.
import * as THREE from 'three';
import { Darts } from './darts';
import { Ribbons } from './ribbons';

const POLE_M = 0.7;
const ORDER = 150;

export class GoalFlag {
  private readonly color = { value: new THREE.Color('#0c9a57') };
  private readonly dart: Darts;
  private readonly lines: Ribbons;

  constructor(parent: THREE.Object3D) {
    this.dart = new Darts(parent, 1, this.color, ORDER, 0.7, 26);
    this.lines = new Ribbons(parent, this.color, ORDER + 4);
    this.hide();
  }

  setTheme(theme: 'light' | 'dark'): void {
    this.color.value.set(theme === 'light' ? '#0c8a4e' : '#3ddb8e');
  }

  /** @param pointer  where the hand is; null: the goal stands */
  show(at: readonly number[], yaw_rad: number, pointer: readonly number[] | null): void {
    const [x, y, z] = at;
    this.dart.set([x, y, z + 0.03, yaw_rad]);
    this.lines.begin();
    if (pointer) {
      this.lines.add(x, y, z + 0.03, pointer[0], pointer[1], pointer[2] + 0.03, 2.5);
    } else {
      const top = z + POLE_M;
      const [tip_x, tip_y] = [x + 0.3 * Math.cos(yaw_rad), y + 0.3 * Math.sin(yaw_rad)];
      this.lines.add(x, y, z, x, y, top, 2.5);
      this.lines.add(x, y, top, tip_x, tip_y, top - 0.11, 2.5);
      this.lines.add(tip_x, tip_y, top - 0.11, x, y, top - 0.22, 2.5);
    }
    this.lines.end();
  }

  hide(): void {
    this.dart.set([]);
    this.lines.begin();
    this.lines.end();
  }

  dispose(): void {
    this.dart.dispose();
    this.lines.dispose();
  }
}
