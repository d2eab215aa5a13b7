// Matrices of agents as pictures: what can be decided without a document, so that it can be tested.

/** A matrix or vector of an agent: "C" with its elements row after row. */
export interface Weights {
  name: string;
  rows: number;
  columns: number;
  values: ArrayLike<number>;
}

export type Rgb = [number, number, number];

/** Colours of a map around zero: `zero` is the ground it is drawn on. */
export interface SignedMap {
  zero: Rgb;
  positive: Rgb;
  negative: Rgb;
}

export const signedMaps: Record<'dark' | 'light', SignedMap> = {
  dark: {zero: [28, 32, 39], positive: [255, 150, 66], negative: [72, 150, 255]},
  light: {zero: [255, 255, 255], positive: [209, 92, 12], negative: [29, 95, 219]},
};

/** A value within +-most; what is not a finite number is grey. */
export function signedColor(value: number, most: number, map: SignedMap): Rgb {
  if (!Number.isFinite(value)) return [128, 128, 128];
  const share = most > 0 ? Math.min(1, Math.abs(value) / most) : 0;
  const end = value < 0 ? map.negative : map.positive;
  return [0, 1, 2].map((i) => Math.round((map.zero[i] as number) + ((end[i] as number) - (map.zero[i] as number)) * share)) as Rgb;
}

/** Black or white, whichever is easier to read on a colour. */
export function textOn([r, g, b]: Rgb): string {
  const linear = (c: number): number => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4);
  return 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b) > 0.18 ? '#000000' : '#ffffff';
}

/** The end of the scale: follows growth at once and shrinks slowly, so that colours do not flicker. */
export function nextScale(before: number, values: ArrayLike<number>): number {
  let most = 0;
  for (let i = 0; i < values.length; i++) {
    const size = Math.abs(values[i] as number);
    if (Number.isFinite(size) && size > most) most = size;
  }
  return Math.max(most, before * 0.98, 1e-6);
}

/** Cells of a matrix in so much room: numbers in them where they can be read, else squares. */
export function cellSize(rows: number, columns: number, width: number, height: number): {width: number; height: number; numbers: boolean} {
  const numbers = rows * 16 <= height && columns * 44 <= width;
  if (numbers) return {width: 44, height: rows > 6 ? 16 : Math.max(16, Math.min(24, Math.floor(height / rows))), numbers};
  const side = Math.max(3, Math.min(22, Math.floor(height / rows), Math.floor(width / columns)));
  return {width: side, height: side, numbers};
}

/** Two or three digits that fit into a cell. */
export function cellText(value: number): string {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  const text = size >= 1e4 ? value.toExponential(0).replace('e+', 'e') : size >= 100 ? value.toFixed(0) : size >= 10 ? value.toFixed(1) : value.toFixed(2);
  return /^-0(\.0+)?$/.test(text) ? text.slice(1) : text;
}

/** "C[1,2]", "h[3]": element k, counted row after row. */
export function elementName(of: Weights, k: number): string {
  return of.columns > 1 ? `${of.name}[${Math.floor(k / of.columns)},${k % of.columns}]` : `${of.name}[${k}]`;
}

/** A matrix from a message of type MultiArray; null where it is none, or empty. */
export function weightsOf(name: string, message: unknown): Weights | null {
  const m = message as {layout?: {dim?: {size: number}[]}; data?: ArrayLike<number>};
  const length = m?.data?.length ?? 0;
  const dims = (m?.layout?.dim ?? []).map((d) => Number(d.size));
  const columns = dims[1] ?? 1;
  const rows = dims[0] ?? length;
  if (length === 0 || rows * columns !== length) return null;
  return {name, rows, columns, values: m.data as ArrayLike<number>};
}

export interface Edge {
  from: number;
  to: number;
  weight: number;
}

/** A matrix as connections: column j leads to row i. Those below `least` of the largest are left out. */
export function edgesOf(of: Weights, least = 0.02): Edge[] {
  const edges: Edge[] = [];
  let most = 0;
  for (let k = 0; k < of.values.length; k++) most = Math.max(most, Math.abs(of.values[k] as number) || 0);
  if (most === 0) return edges;
  for (let i = 0; i < of.rows; i++)
    for (let j = 0; j < of.columns; j++) {
      const weight = of.values[i * of.columns + j] as number;
      if (Math.abs(weight) >= least * most) edges.push({from: j, to: i, weight});
    }
  // The strong ones are drawn last, over the others.
  return edges.sort((a, b) => Math.abs(a.weight) - Math.abs(b.weight));
}

/** Matrices first, the known ones in the order of the equations; then vectors. */
export function orderOf(a: Weights, b: Weights): number {
  const known = ['C', 'A', 'S', 'h', 'b', 'H', 'x', 'y', 'xi', 'v'];
  const place = (w: Weights): number => (w.columns > 1 ? 0 : 100) + (known.includes(w.name) ? known.indexOf(w.name) : 50);
  return place(a) - place(b) || (a.name < b.name ? -1 : 1);
}
