// Exact numbers as text: every double reads back as itself. Empty cells where there is none (docs/values.md).
import type {PlotData} from './series';

export function cell(text: string): string {
  return /[",\n\r]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
}

export function number(value: number): string {
  if (Number.isNaN(value)) return '';
  return value === Infinity ? 'inf' : value === -Infinity ? '-inf' : String(value);
}

export function toCsv(data: PlotData, names: string[]): string {
  const lines = [['time', ...names].map(cell).join(',')];
  for (let i = 0; i < data.times.length; i++) lines.push([number(data.times.time(i)), ...data.series.map((s) => number(s.value(i)))].join(','));
  return `${lines.join('\n')}\n`;
}

/** "hypot(a.x, b.x)" becomes a name that files may have. */
export function fileName(text: string, extension: string): string {
  const safe = text.replace(/[^\w.-]+/g, '-').replace(/^-+|-+$/g, '').slice(0, 60);
  return `${safe || 'plot'}.${extension}`;
}
