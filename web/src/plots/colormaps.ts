// Colour maps as tables of 256 colours, interpolated between a few anchors.

const anchors = {
  // Viridis (S. van der Walt, N. Smith, 2015): perceptually even, readable for the colour-blind.
  viridis: ['440154', '482878', '3e4989', '31688e', '26828e', '1f9e89', '35b779', '6ece58', 'b5de2b', 'fde725'],
  // Turbo (A. Mikhailov, 2019): a rainbow without false edges.
  turbo: ['30123b', '4145ab', '4675ed', '39a2fc', '1bcfd4', '24eca6', '61fc6c', 'a4fc3c', 'd1e834', 'f3c63a', 'fe9b2d', 'f36315', 'd93806', 'b11901', '7a0402'],
  grey: ['000000', 'ffffff'],
} as const;

export type MapName = keyof typeof anchors;
export const mapNames = Object.keys(anchors) as MapName[];

/** Red, green, blue of entry i at 3 i. */
export function colorTable(name: MapName): Uint8Array {
  const stops = anchors[name].map((hex) => [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16)));
  const table = new Uint8Array(256 * 3);
  for (let i = 0; i < 256; i++) {
    const at = (i / 255) * (stops.length - 1);
    const low = Math.min(Math.floor(at), stops.length - 2);
    for (let c = 0; c < 3; c++) {
      const a = stops[low]?.[c] ?? 0;
      const b = stops[low + 1]?.[c] ?? 0;
      table[3 * i + c] = Math.round(a + (b - a) * (at - low));
    }
  }
  return table;
}

/** Colours of values into RGBA pixels; what is not a finite number becomes transparent. */
export function paint(values: ArrayLike<number>, min: number, max: number, table: Uint8Array, pixels: Uint8ClampedArray): void {
  const scale = max > min ? 255 / (max - min) : 0;
  for (let i = 0; i < values.length; i++) {
    const v = values[i] as number;
    const to = 4 * i;
    if (!Number.isFinite(v)) {
      pixels[to] = pixels[to + 1] = pixels[to + 2] = pixels[to + 3] = 0;
      continue;
    }
    const entry = 3 * Math.max(0, Math.min(255, Math.round((v - min) * scale)));
    pixels[to] = table[entry] as number;
    pixels[to + 1] = table[entry + 1] as number;
    pixels[to + 2] = table[entry + 2] as number;
    pixels[to + 3] = 255;
  }
}
