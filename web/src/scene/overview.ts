// What of a world belongs into the first picture of it.
import * as THREE from 'three';
import type { Body } from './bodies';
import { composeMatrix, transform } from './poses';

const flatSize = (points: readonly THREE.Vector3[]): number => {
  const box = new THREE.Box3().setFromPoints(points as THREE.Vector3[]);
  return box.isEmpty() ? 0 : Math.hypot(box.max.x - box.min.x, box.max.y - box.min.y);
};

/** What is wide is seldom a box: an octagon or a landscape is measured by what it is made of, as far as that is few. */
const WIDE_M = 2;
const MOST_POINTS = 2000;

function verticesOf(body: Body): THREE.Vector3[] {
  const points: THREE.Vector3[] = [];
  const matrix = new THREE.Matrix4();
  const columns = new Float32Array(16);
  for (const slot of body.slots) {
    const position = slot.batch.geometry.getAttribute('position');
    const stride = Math.ceil((position.count * body.slots.length) / MOST_POINTS);
    composeMatrix(body.world, 7 * slot.link, slot.local, columns, 0);
    matrix.fromArray(columns);
    for (let i = 0; i < position.count; i += stride) points.push(new THREE.Vector3().fromBufferAttribute(position, i).applyMatrix4(matrix));
  }
  return points;
}

function cornersOf(body: Body): THREE.Vector3[] {
  if (body.is_static && body.radius_m > WIDE_M) return verticesOf(body);
  const { min, max } = body.bounds;
  const at = [0, 0, 0];
  return [0, 1, 2, 3, 4, 5, 6, 7].map((i) => {
    transform(body.world, 0, i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z, at);
    return new THREE.Vector3().fromArray(at);
  });
}

/** Points that the view must hold, and how steeply to look: the height of walls over the width of what they enclose; 0 for open ground. */
export function overviewOf(bodies: Iterable<Body>): { points: THREE.Vector3[]; steepness: number } {
  const all: THREE.Vector3[] = [];
  const moving: THREE.Vector3[] = [];
  let walls_m = 0;
  for (const body of bodies) {
    // Terrain and halls count, a landscape of kilometres does not; nor does a plane, which has no parts.
    if (body.slots.length === 0 || body.radius_m > 60) continue;
    const corners = cornersOf(body);
    all.push(...corners);
    if (!body.is_static) moving.push(...corners);
    else for (const { z } of corners) walls_m = Math.max(walls_m, z);
  }
  // A room around what moves belongs into the picture, a town does not.
  const is_town = moving.length > 0 && flatSize(all) > 2 * Math.max(3, flatSize(moving));
  const points = is_town ? moving : all;
  // One thing alone has some ground around it, what drives in a town more.
  const room_m = is_town ? 3 : 1;
  const box = new THREE.Box3().setFromPoints(points);
  const middle = box.isEmpty() ? new THREE.Vector3() : box.getCenter(new THREE.Vector3());
  for (const [x, y] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) points.push(middle.clone().add(new THREE.Vector3(room_m * x, room_m * y, 0)));
  return { points, steepness: is_town ? 0 : walls_m / Math.max(1, flatSize(all)) };
}

/** Whether something that moves is about to leave the picture. */
export function someLeave(bodies: Iterable<Body>, camera: THREE.Camera): boolean {
  const at = new THREE.Vector3();
  const middle = new Float64Array(3);
  for (const body of bodies) {
    if (body.is_static || body.slots.length === 0) continue;
    body.middle(middle);
    at.fromArray(middle).project(camera);
    if (Math.abs(at.x) > 0.95 || at.y < -0.95 || at.y > 0.9) return true;
  }
  return false;
}
