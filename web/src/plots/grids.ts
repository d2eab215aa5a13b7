// Finds the arrays in a message that a picture can be made of.

export interface Grid {
  path: string;
  columns: number;
  rows: number;     // 1: a row that is drawn over time, as a waterfall
  values: ArrayLike<number>;
  flip: boolean;    // row 0 is below, as in maps
}

const cells_max = 4_000_000;

export function gridsOf(message: unknown, schemaName: string): Grid[] {
  const grids: Grid[] = [];
  const m = message as Record<string, unknown>;
  if (typeof m !== 'object' || m === null) return grids;
  if (schemaName.endsWith('OccupancyGrid') && typeof m.info === 'object') {
    const info = m.info as {width?: number; height?: number};
    add(grids, 'data', m.data, info.width, info.height, true);
    return grids;
  }
  if (/\/Image$/.test(schemaName)) {
    const image = imageOf(m);
    if (image) grids.push(image);
    return grids;
  }
  if (/MultiArray$/.test(schemaName)) {
    const dims = ((m.layout as {dim?: {size: number}[]})?.dim ?? []).map((d) => Number(d.size));
    const columns = dims[dims.length - 1];
    add(grids, 'data', m.data, columns, columns ? lengthOf(m.data) / columns : undefined, false);
    return grids;
  }
  visit(m, '', 0, grids);
  return grids;
}

function visit(value: Record<string, unknown>, path: string, depth: number, grids: Grid[]): void {
  if (depth > 4 || grids.length > 32) return;
  for (const [key, item] of Object.entries(value)) {
    const name = path === '' ? key : `${path}.${key}`;
    if (ArrayBuffer.isView(item) || Array.isArray(item)) add(grids, name, item, undefined, undefined, false);
    else if (typeof item === 'object' && item !== null) visit(item as Record<string, unknown>, name, depth + 1, grids);
  }
}

function lengthOf(values: unknown): number {
  return ArrayBuffer.isView(values) || Array.isArray(values) ? (values as ArrayLike<number>).length : 0;
}

function add(grids: Grid[], path: string, values: unknown, columns: number | undefined, rows: number | undefined, flip: boolean): void {
  const length = lengthOf(values);
  const list = values as ArrayLike<number>;
  if (length < 2 || typeof list[0] !== 'number') return;
  if (columns && rows && Number.isInteger(columns) && Number.isInteger(rows) && columns * rows === length && length <= cells_max) {
    grids.push({path, columns, rows, values: list, flip: flip});
  } else {
    grids.push({path, columns: length, rows: 1, values: list, flip: false});
  }
}

/** Images of one channel as they are, of three as their luminance. */
function imageOf(m: Record<string, unknown>): Grid | null {
  const width = Number(m.width);
  const height = Number(m.height);
  const step = Number(m.step);
  const encoding = String(m.encoding);
  const data = m.data;
  if (!(data instanceof Uint8Array) || !(width > 0 && height > 0 && width * height <= cells_max)) return null;
  const kinds: Record<string, [number, (view: DataView, at: number) => number]> = {
    mono8: [1, (v, at) => v.getUint8(at)], '8UC1': [1, (v, at) => v.getUint8(at)], mono16: [2, (v, at) => v.getUint16(at, m.is_bigendian !== 1)], '16UC1': [2, (v, at) => v.getUint16(at, m.is_bigendian !== 1)],
    '32FC1': [4, (v, at) => v.getFloat32(at, m.is_bigendian !== 1)],
    rgb8: [3, (v, at) => 0.2126 * v.getUint8(at) + 0.7152 * v.getUint8(at + 1) + 0.0722 * v.getUint8(at + 2)],
    bgr8: [3, (v, at) => 0.2126 * v.getUint8(at + 2) + 0.7152 * v.getUint8(at + 1) + 0.0722 * v.getUint8(at)],
  };
  const kind = kinds[encoding];
  if (!kind) return null;
  const [bytes, read] = kind;
  const row_bytes = step >= width * bytes ? step : width * bytes;
  if (data.byteLength < row_bytes * (height - 1) + width * bytes) return null;
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  const values = new Float32Array(width * height);
  for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) values[y * width + x] = read(view, y * row_bytes + x * bytes);
  return {path: 'data', columns: width, rows: height, values, flip: false};
}

/** The last rows of a list that comes again and again. Not-a-number where there is none yet. */
export class Waterfall {
  readonly values: Float32Array;
  readonly times: Float64Array;
  count = 0;

  constructor(readonly columns: number, readonly rows: number) {
    this.values = new Float32Array(columns * rows).fill(Number.NaN);
    this.times = new Float64Array(rows).fill(Number.NaN);
  }

  /** The newest row is the first. */
  push(time_s: number, row: ArrayLike<number>): void {
    this.values.copyWithin(this.columns, 0, this.columns * (this.rows - 1));
    this.times.copyWithin(1, 0, this.rows - 1);
    for (let i = 0; i < this.columns; i++) this.values[i] = row[i] ?? Number.NaN;
    this.times[0] = time_s;
    this.count = Math.min(this.rows, this.count + 1);
  }
}
