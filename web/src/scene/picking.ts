// What a ray meets first: balls around instances, then their triangles.
import * as THREE from 'three';
import type { Batch, Slot } from './batches';

export interface Hit {
  slot: Slot;
  distance_m: number;
  point: THREE.Vector3;
}

const matrix = new THREE.Matrix4();
const inverse = new THREE.Matrix4();
const local = new THREE.Ray();
const a = new THREE.Vector3();
const b = new THREE.Vector3();
const c = new THREE.Vector3();
const at = new THREE.Vector3();

export function pickSlots(ray: THREE.Ray, batches: Iterable<Batch>): Hit | null {
  let best: Hit | null = null;
  for (const batch of batches) {
    if (!batch.pickable || !batch.mesh.visible) continue;
    const m = batch.matrices;
    const { center, radius } = batch.sphere;
    for (let s = 0; s < batch.slots.length; ++s) {
      const o = 16 * s;
      const x = m[o] * center.x + m[o + 4] * center.y + m[o + 8] * center.z + m[o + 12];
      const y = m[o + 1] * center.x + m[o + 5] * center.y + m[o + 9] * center.z + m[o + 13];
      const z = m[o + 2] * center.x + m[o + 6] * center.y + m[o + 10] * center.z + m[o + 14];
      const scale2 = Math.max(m[o] ** 2 + m[o + 1] ** 2 + m[o + 2] ** 2, m[o + 4] ** 2 + m[o + 5] ** 2 + m[o + 6] ** 2, m[o + 8] ** 2 + m[o + 9] ** 2 + m[o + 10] ** 2);
      const dx = x - ray.origin.x, dy = y - ray.origin.y, dz = z - ray.origin.z;
      const along = dx * ray.direction.x + dy * ray.direction.y + dz * ray.direction.z;
      const aside2 = dx * dx + dy * dy + dz * dz - along * along;
      const reach2 = radius * radius * scale2;
      if (aside2 > reach2 || along < -Math.sqrt(reach2)) continue;
      if (best && along - Math.sqrt(reach2) > best.distance_m) continue;
      const distance_m = meet(ray, batch, s);
      if (distance_m < (best?.distance_m ?? Infinity)) {
        best = { slot: batch.slots[s], distance_m, point: ray.at(distance_m, new THREE.Vector3()) };
      }
    }
  }
  return best;
}

/** Distance along the ray to the nearest triangle of an instance; Infinity: none. */
function meet(ray: THREE.Ray, batch: Batch, s: number): number {
  matrix.fromArray(batch.matrices, 16 * s);
  if (Math.abs(matrix.determinant()) < 1e-18) return Infinity;
  local.copy(ray).applyMatrix4(inverse.copy(matrix).invert());
  const position = batch.geometry.getAttribute('position');
  const index = batch.geometry.index;
  const corners = index ? index.count : position.count;
  let nearest = Infinity;
  for (let i = 0; i + 2 < corners; i += 3) {
    a.fromBufferAttribute(position, index ? index.getX(i) : i);
    b.fromBufferAttribute(position, index ? index.getX(i + 1) : i + 1);
    c.fromBufferAttribute(position, index ? index.getX(i + 2) : i + 2);
    if (local.intersectTriangle(a, b, c, false, at) === null) continue;
    const distance_m = at.applyMatrix4(matrix).distanceTo(ray.origin);
    if (distance_m < nearest) nearest = distance_m;
  }
  return nearest;
}
