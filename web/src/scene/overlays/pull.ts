// The spring between what is pulled and the pointer.
import * as THREE from 'three';
import { alongMatrix } from './stamps';

export class PullLine {
  private readonly bar: THREE.Mesh;
  private readonly knob: THREE.Mesh;
  private readonly material = new THREE.MeshBasicMaterial({ color: '#ff8a1f', depthTest: false, transparent: true, opacity: 0.95, toneMapped: false, fog: false });
  private readonly matrix = new Float32Array(16);

  constructor(private readonly parent: THREE.Object3D) {
    this.bar = new THREE.Mesh(new THREE.CylinderGeometry(0.5, 0.5, 1, 8).translate(0, 0.5, 0).rotateZ(-Math.PI / 2), this.material);
    this.knob = new THREE.Mesh(new THREE.SphereGeometry(1, 16, 12), this.material);
    for (const mesh of [this.bar, this.knob]) {
      mesh.matrixAutoUpdate = false;
      mesh.frustumCulled = false;
      mesh.visible = false;
      mesh.renderOrder = 15;
      parent.add(mesh);
    }
  }

  /** @param reach_m of the camera: the line is as thick in the view wherever that is */
  show(from: readonly number[], to: THREE.Vector3, reach_m: number): void {
    const width_m = reach_m * 0.004;
    const dx = to.x - from[0], dy = to.y - from[1], dz = to.z - from[2];
    alongMatrix(this.matrix, 0, from[0], from[1], from[2], dx, dy, dz, Math.hypot(dx, dy, dz) || 1e-6, width_m);
    this.bar.matrix.fromArray(this.matrix);
    this.knob.matrix.makeScale(2 * width_m, 2 * width_m, 2 * width_m).setPosition(to);
    this.bar.visible = this.knob.visible = true;
    this.bar.matrixWorldNeedsUpdate = this.knob.matrixWorldNeedsUpdate = true;
  }

  hide(): void {
    this.bar.visible = this.knob.visible = false;
  }

  dispose(): void {
    this.parent.remove(this.bar, this.knob);
    this.bar.geometry.dispose();
    this.knob.geometry.dispose();
    this.material.dispose();
  }
}
