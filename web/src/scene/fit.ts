// From where a set of points fills the view.
//
// Frame    the world's; azimuth and elevation are headings from what is looked at to the eye, radians.
// Cost     some 20 ns per point and heading: for the first sight of a world and for a key that is pressed.
import * as THREE from 'three';

export interface Fit {
  target: THREE.Vector3;
  azimuth: number;
  distance: number;
  /** How deep in the view the farthest point lies. */
  farthest: number;
}

/** How much of the view's half each side may fill: the upper edge bears buttons. */
const FILL = { side: 0.94, bottom: 0.92, top: 0.84 };
/** Another heading than the first is taken when it brings the farthest nearer by this factor: rows are seen from their side. */
const WORTH_TURNING = 0.85;

/** @param half_height tangent of half of the view's upright angle */
export function fitPoints(points: readonly THREE.Vector3[], azimuths: readonly number[], elevation: number, half_height: number, aspect: number): Fit {
  let best: Fit | null = null;
  for (const azimuth of azimuths) {
    const fit = fitFrom(points, azimuth, elevation, half_height, aspect);
    if (best === null || fit.farthest < WORTH_TURNING * best.farthest) best = fit;
  }
  return best ?? { target: new THREE.Vector3(), azimuth: 0, distance: 8, farthest: 8 };
}

/**
 * The eye goes back until no edge of the view cuts a point off. With x to the right, y up and z towards the eye at (X, Y, Z), a
 * point is left of the right edge, of slope t, when x - X <= t (Z - z), that is X + t Z >= x + t z: so each edge has one point
 * that decides, two opposite edges give a least Z, and what room is left over is shared.
 */
function fitFrom(points: readonly THREE.Vector3[], azimuth: number, elevation: number, half_height: number, aspect: number): Fit {
  const back = new THREE.Vector3(Math.cos(azimuth) * Math.cos(elevation), Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation));
  const right = new THREE.Vector3(-Math.sin(azimuth), Math.cos(azimuth), 0);
  const up = new THREE.Vector3().crossVectors(back, right);
  const side = FILL.side * half_height * aspect;
  const top = FILL.top * half_height;
  const bottom = FILL.bottom * half_height;
  let at_right = -Infinity, at_left = -Infinity, at_top = -Infinity, at_bottom = -Infinity, nearest = -Infinity, deepest = Infinity;
  for (const point of points) {
    const x = point.dot(right), y = point.dot(up), z = point.dot(back);
    at_right = Math.max(at_right, x + side * z);
    at_left = Math.max(at_left, -x + side * z);
    at_top = Math.max(at_top, y + top * z);
    at_bottom = Math.max(at_bottom, -y + bottom * z);
    nearest = Math.max(nearest, z);
    deepest = Math.min(deepest, z);
  }
  if (points.length === 0) return { target: new THREE.Vector3(), azimuth, distance: 8, farthest: 8 };
  const Z = Math.max((at_right + at_left) / (2 * side), (at_top + at_bottom) / (top + bottom), nearest + 0.1);
  const X = (at_right - at_left) / 2;
  const Y = (at_top - top * Z + bottom * Z - at_bottom) / 2;
  // What the view turns about lies as deep as the middle of the points.
  const middle = (nearest + deepest) / 2;
  const target = right.clone().multiplyScalar(X).addScaledVector(up, Y).addScaledVector(back, middle);
  return { target, azimuth, distance: Z - middle, farthest: Z - deepest };
}
