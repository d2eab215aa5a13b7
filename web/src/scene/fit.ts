// From where a set of points fills the view.
//
// Frame    the world's; azimuth and elevation are headings from what is looked at to the eye, radians.
// Cost     some microseconds per point and heading: for the first sight of a world and for a key that is pressed.
import * as THREE from 'three';

export interface Fit {
  target: THREE.Vector3;
  azimuth: number;
  distance: number;
}

/** How much of the view's half each side may fill: the upper edge bears buttons. */
const FILL = { side: 0.94, bottom: 0.92, top: 0.84 };
/** Another heading than the first is taken when it brings things nearer by this factor. */
const WORTH_TURNING = 0.85;
const STEPS = 12;

/** @param half_height tangent of half of the view's upright angle */
export function fitPoints(points: readonly THREE.Vector3[], azimuths: readonly number[], elevation: number, half_height: number, aspect: number): Fit {
  let best: Fit | null = null;
  for (const azimuth of azimuths) {
    const fit = fitFrom(points, azimuth, elevation, half_height, aspect);
    if (best === null || fit.distance < WORTH_TURNING * best.distance) best = fit;
  }
  return best ?? { target: new THREE.Vector3(), azimuth: 0, distance: 8 };
}

function fitFrom(points: readonly THREE.Vector3[], azimuth: number, elevation: number, half_height: number, aspect: number): Fit {
  const back = new THREE.Vector3(Math.cos(azimuth) * Math.cos(elevation), Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation));
  const right = new THREE.Vector3(-Math.sin(azimuth), Math.cos(azimuth), 0);
  const up = new THREE.Vector3().crossVectors(back, right);
  const box = new THREE.Box3().setFromPoints(points as THREE.Vector3[]);
  const target = box.getCenter(new THREE.Vector3());
  const at = new THREE.Vector3();
  let distance = Math.max(0.5, box.getSize(at).length());
  for (let step = 0; step < STEPS; ++step) {
    // The extent that the points have in the view, in halves of it.
    let low_x = Infinity, high_x = -Infinity, low_y = Infinity, high_y = -Infinity;
    for (const point of points) {
      at.copy(point).sub(target);
      const depth = Math.max(0.05 * distance, distance - at.dot(back));
      const x = at.dot(right) / (depth * half_height * aspect);
      const y = at.dot(up) / (depth * half_height);
      low_x = Math.min(low_x, x);
      high_x = Math.max(high_x, x);
      low_y = Math.min(low_y, y);
      high_y = Math.max(high_y, y);
    }
    const shift_x = (low_x + high_x) / 2;
    const shift_y = (low_y + high_y) / 2 - (FILL.top - FILL.bottom) / 2;
    target.addScaledVector(right, shift_x * half_height * aspect * distance).addScaledVector(up, shift_y * half_height * distance);
    // Things that are near grow faster than the distance shrinks: half of the way at a time.
    const fills = Math.max((high_x - low_x) / (2 * FILL.side), (high_y - low_y) / (FILL.top + FILL.bottom));
    distance *= Math.min(2, Math.max(0.5, 1 + 0.6 * (fills - 1)));
  }
  return { target, azimuth, distance };
}
