// How sure a position is, as an ellipse on the ground: two standard deviations along its axes. In a plane that is 86 % of all cases.

/** Standard deviations that an ellipse shows. */
export const SIGMAS = 2;

export interface Ellipse {
  /** Semi-axes: two standard deviations. */
  major_m: number;
  minor_m: number;
  /** Of the major axis, from x. */
  turn_rad: number;
}

/** Of a position: nine numbers, row by row; null: nothing is said. `why` then has the reason, as a sentence's end, where there is something wrong. */
export interface Spread {
  covariance: Float64Array | null;
  why: string;
}

/** The covariance of the position in one of a pose. @param c  row-major 6x6: x y z and turns about them */
export function spreadOf(c: ArrayLike<number>): Spread {
  const none = (why: string): Spread => ({ covariance: null, why });
  if (c.length < 36) return none(`its covariance has ${c.length} numbers instead of 36`);
  const m = new Float64Array(9);
  for (let i = 0; i < 3; ++i) for (let k = 0; k < 3; ++k) m[3 * i + k] = (c[6 * i + k] + c[6 * k + i]) / 2;
  const [xx, xy, , , yy] = m;
  if (!Number.isFinite(xx + xy + yy)) return none('its covariance is not finite');
  if (xx < 0 || yy < 0) return none('its covariance has a negative variance');
  // By ROS's convention of messages: not known.
  if (xx === 0 && yy === 0) return none('');
  // Rounding of the sender, single precision too, is no fault.
  if (xy * xy > xx * yy * (1 + 1e-5)) return none('its covariance is that of nothing: x and y depend on each other by more than they vary');
  // Heights are often not estimated, and what they say then does not spoil the rest.
  if (!Number.isFinite(m[2] + m[5] + m[8]) || m[8] < 0) m[2] = m[5] = m[6] = m[7] = m[8] = 0;
  return { covariance: m, why: '' };
}

/** @param c  of a position in the plane: xx, xy, yy */
export function ellipseOf(xx: number, xy: number, yy: number): Ellipse {
  const middle = (xx + yy) / 2;
  const half = Math.hypot((xx - yy) / 2, xy);
  return { major_m: SIGMAS * Math.sqrt(middle + half), minor_m: SIGMAS * Math.sqrt(Math.max(0, middle - half)), turn_rad: half > 0 ? 0.5 * Math.atan2(2 * xy, xx - yy) : 0 };
}

/** The ellipse on the ground of a covariance in a frame that is turned, or tilted. @param frame  pose of the frame in the world: x y z qw qx qy qz */
export function groundEllipse(covariance: ArrayLike<number>, frame: ArrayLike<number>): Ellipse {
  const [w, x, y, z] = [frame[3], frame[4], frame[5], frame[6]];
  const rows = [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
  ];
  const between = (a: number[], b: number[]): number => {
    let sum = 0;
    for (let i = 0; i < 3; ++i) for (let k = 0; k < 3; ++k) sum += a[i] * covariance[3 * i + k] * b[k];
    return sum;
  };
  return ellipseOf(between(rows[0], rows[0]), between(rows[0], rows[1]), between(rows[1], rows[1]));
}
