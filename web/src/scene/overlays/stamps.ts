// Many copies of one small geometry, written anew each time: arrows, axes, rings, pyramids.
import * as THREE from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';

export class Stamps {
  mesh: THREE.InstancedMesh;
  matrices: Float32Array;
  private count = 0;

  constructor(
    private readonly parent: THREE.Object3D,
    private readonly geometry: THREE.BufferGeometry,
    private readonly material: THREE.Material,
    private readonly colored = false,
  ) {
    this.mesh = this.make(16);
    this.matrices = this.mesh.instanceMatrix.array as Float32Array;
  }

  set visible(show: boolean) {
    this.mesh.visible = show;
  }

  begin(): void {
    this.count = 0;
  }

  /** Place of the next copy's matrix in `matrices`. */
  next(): number {
    if (this.count === this.mesh.instanceMatrix.count) this.grow();
    return 16 * this.count++;
  }

  /** Color of the copy that next() gave last. */
  color(color: THREE.Color): void {
    if (!this.colored) return;
    this.mesh.setColorAt(this.count - 1, color);
  }

  end(): void {
    this.mesh.count = this.count;
    const attribute = this.mesh.instanceMatrix;
    attribute.clearUpdateRanges();
    attribute.addUpdateRange(0, 16 * this.count);
    attribute.needsUpdate = true;
    if (this.mesh.instanceColor) this.mesh.instanceColor.needsUpdate = true;
  }

  dispose(): void {
    this.parent.remove(this.mesh);
    this.mesh.dispose();
    this.geometry.dispose();
    this.material.dispose();
  }

  private make(capacity: number): THREE.InstancedMesh {
    const mesh = new THREE.InstancedMesh(this.geometry, this.material, capacity);
    mesh.instanceMatrix.setUsage(THREE.DynamicDrawUsage);
    mesh.frustumCulled = false;
    mesh.matrixAutoUpdate = false;
    mesh.count = 0;
    // Colours must be there before the first compile, else the program has no place for them.
    if (this.colored) mesh.setColorAt(0, new THREE.Color());
    this.parent.add(mesh);
    return mesh;
  }

  private grow(): void {
    const old = this.mesh;
    this.mesh = this.make(4 * old.instanceMatrix.count);
    this.mesh.visible = old.visible;
    this.mesh.renderOrder = old.renderOrder;
    this.matrices = this.mesh.instanceMatrix.array as Float32Array;
    this.matrices.set(old.instanceMatrix.array);
    if (old.instanceColor) (this.mesh.instanceColor?.array as Float32Array).set(old.instanceColor.array);
    this.parent.remove(old);
    old.dispose();
  }
}

/** An arrow of length 1 along x. */
export function arrowGeometry(shaft_radius: number, head_radius: number, head: number): THREE.BufferGeometry {
  const shaft = new THREE.CylinderGeometry(shaft_radius, shaft_radius, 1 - head, 10).translate(0, (1 - head) / 2, 0);
  const tip = new THREE.ConeGeometry(head_radius, head, 14).translate(0, 1 - head / 2, 0);
  return (mergeGeometries([shaft, tip]) ?? shaft).rotateZ(-Math.PI / 2);
}

/** Three arrows of length 1, red, green and blue. */
export function axesGeometry(): THREE.BufferGeometry {
  const arms = (['#e5484d', '#46a758', '#3e7bfa'] as const).map((name, axis) => {
    const arm = arrowGeometry(0.03, 0.08, 0.24);
    if (axis === 1) arm.rotateZ(Math.PI / 2);
    if (axis === 2) arm.rotateY(-Math.PI / 2);
    const color = new THREE.Color(name);
    const count = arm.getAttribute('position').count;
    arm.setAttribute('color', new THREE.BufferAttribute(Float32Array.from({ length: 3 * count }, (_, i) => [color.r, color.g, color.b][i % 3]), 3));
    return arm;
  });
  return mergeGeometries(arms) ?? arms[0];
}

/** Writes a matrix that turns x to (dx, dy, dz), which need not be a unit, and scales by `length` along and `width` across. */
export function alongMatrix(out: Float32Array, o: number, x: number, y: number, z: number, dx: number, dy: number, dz: number, length: number, width: number): void {
  const norm = Math.hypot(dx, dy, dz) || 1;
  const ax = dx / norm, ay = dy / norm, az = dz / norm;
  // Any direction across: from the axis that is least along.
  let bx = 0, by = 0, bz = 0;
  if (Math.abs(az) < 0.9) {
    const flat = Math.hypot(ax, ay);
    bx = -ay / flat;
    by = ax / flat;
  } else {
    const flat = Math.hypot(ay, az);
    by = -az / flat;
    bz = ay / flat;
  }
  const cx = ay * bz - az * by, cy = az * bx - ax * bz, cz = ax * by - ay * bx;
  out[o] = ax * length;
  out[o + 1] = ay * length;
  out[o + 2] = az * length;
  out[o + 3] = 0;
  out[o + 4] = bx * width;
  out[o + 5] = by * width;
  out[o + 6] = bz * width;
  out[o + 7] = 0;
  out[o + 8] = cx * width;
  out[o + 9] = cy * width;
  out[o + 10] = cz * width;
  out[o + 11] = 0;
  out[o + 12] = x;
  out[o + 13] = y;
  out[o + 14] = z;
  out[o + 15] = 1;
}
