// Ranges of axes.

/** Some room above and below; a constant gets a range of its size. */
export function padded(min: number | null, max: number | null): [number, number] {
  if (min === null || max === null || !Number.isFinite(min) || !Number.isFinite(max)) return [-1, 1];
  const size = max - min;
  const room = size > 1e-9 * Math.max(Math.abs(min), Math.abs(max)) ? size * 0.08 : Math.max(Math.abs(max) * 0.1, 1e-3);
  return [min - room, max + room];
}
