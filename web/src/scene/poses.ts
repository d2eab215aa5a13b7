// Poses as seven numbers in flat arrays (x y z qw qx qy qz): three's objects would cost an allocation or a virtual
// call per link, and a thousand robots have thousands of links.

export type Numbers = Float64Array | number[];

/** out[o ...] = a[i ...] * b[j ...]. `out` must not be `a` or `b` at the same place. */
export function multiply(a: Numbers, i: number, b: Numbers, j: number, out: Numbers, o: number): void {
  const qw = a[i + 3], qx = a[i + 4], qy = a[i + 5], qz = a[i + 6];
  const x = b[j], y = b[j + 1], z = b[j + 2];
  // v + 2 q x (q x v + w v), with the inner product first.
  const tx = 2 * (qy * z - qz * y), ty = 2 * (qz * x - qx * z), tz = 2 * (qx * y - qy * x);
  out[o] = a[i] + x + qw * tx + (qy * tz - qz * ty);
  out[o + 1] = a[i + 1] + y + qw * ty + (qz * tx - qx * tz);
  out[o + 2] = a[i + 2] + z + qw * tz + (qx * ty - qy * tx);
  const pw = b[j + 3], px = b[j + 4], py = b[j + 5], pz = b[j + 6];
  out[o + 3] = qw * pw - qx * px - qy * py - qz * pz;
  out[o + 4] = qw * px + qx * pw + qy * pz - qz * py;
  out[o + 5] = qw * py - qx * pz + qy * pw + qz * px;
  out[o + 6] = qw * pz + qx * py - qy * px + qz * pw;
}

export function invert(a: Numbers, i: number, out: Numbers, o: number): void {
  const w = a[i + 3], x = -a[i + 4], y = -a[i + 5], z = -a[i + 6];
  const px = -a[i], py = -a[i + 1], pz = -a[i + 2];
  const tx = 2 * (y * pz - z * py), ty = 2 * (z * px - x * pz), tz = 2 * (x * py - y * px);
  out[o] = px + w * tx + (y * tz - z * ty);
  out[o + 1] = py + w * ty + (z * tx - x * tz);
  out[o + 2] = pz + w * tz + (x * ty - y * tx);
  out[o + 3] = w;
  out[o + 4] = x;
  out[o + 5] = y;
  out[o + 6] = z;
}

/** A point of the frame at pose[i ...] in the frame around it, into out[0..2]. */
export function transform(pose: Numbers, i: number, x: number, y: number, z: number, out: Numbers): void {
  const qw = pose[i + 3], qx = pose[i + 4], qy = pose[i + 5], qz = pose[i + 6];
  const tx = 2 * (qy * z - qz * y), ty = 2 * (qz * x - qx * z), tz = 2 * (qx * y - qy * x);
  out[0] = pose[i] + x + qw * tx + (qy * tz - qz * ty);
  out[1] = pose[i + 1] + y + qw * ty + (qz * tx - qx * tz);
  out[2] = pose[i + 2] + z + qw * tz + (qx * ty - qy * tx);
}

export function isFinitePose(pose: Numbers, i: number): boolean {
  // One sum tells all seven: it is finite only if each of them is (or two infinities cancel, which gives NaN).
  return Number.isFinite(pose[i] + pose[i + 1] + pose[i + 2] + pose[i + 3] + pose[i + 4] + pose[i + 5] + pose[i + 6]);
}

/** Heading about z of an orientation, radians. */
export function yawOf(pose: Numbers, i: number): number {
  const w = pose[i + 3], x = pose[i + 4], y = pose[i + 5], z = pose[i + 6];
  return Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
}

/**
 * Writes (pose[i ...] as a 4x4) * local to out[o ...], column-major as WebGL wants it.
 * `local`: 12 numbers, three columns of the linear part (with scale) and the translation.
 */
export function composeMatrix(pose: Numbers, i: number, local: Float64Array, out: Float32Array, o: number): void {
  const w = pose[i + 3], x = pose[i + 4], y = pose[i + 5], z = pose[i + 6];
  const r00 = 1 - 2 * (y * y + z * z), r01 = 2 * (x * y - w * z), r02 = 2 * (x * z + w * y);
  const r10 = 2 * (x * y + w * z), r11 = 1 - 2 * (x * x + z * z), r12 = 2 * (y * z - w * x);
  const r20 = 2 * (x * z - w * y), r21 = 2 * (y * z + w * x), r22 = 1 - 2 * (x * x + y * y);
  for (let c = 0; c < 4; ++c) {
    const a = local[3 * c], b = local[3 * c + 1], d = local[3 * c + 2];
    const to = o + 4 * c;
    out[to] = r00 * a + r01 * b + r02 * d;
    out[to + 1] = r10 * a + r11 * b + r12 * d;
    out[to + 2] = r20 * a + r21 * b + r22 * d;
    out[to + 3] = 0;
  }
  out[o + 12] += pose[i];
  out[o + 13] += pose[i + 1];
  out[o + 14] += pose[i + 2];
  out[o + 15] = 1;
}

/** The 12 numbers that composeMatrix() wants, from a pose and a scale. */
export function localMatrix(pose: Numbers, sx: number, sy: number, sz: number): Float64Array {
  const m = new Float32Array(16);
  composeMatrix(pose, 0, Float64Array.of(sx, 0, 0, 0, sy, 0, 0, 0, sz, 0, 0, 0), m, 0);
  return Float64Array.of(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10], m[12], m[13], m[14]);
}
