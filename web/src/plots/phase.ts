// Phase plots: values against a value. The newest part of the curves is strong, the oldest pale.
import {formatNumber} from '../app/format';
import {padded} from './scales';

export interface PhaseCurve {
  color: string;
  label: string;
  values: ArrayLike<number | null>;
}

export interface PhaseStyle {
  grid: string;
  text: string;
  font: string;
}

export interface PhaseScales {
  x: [number, number];
  y: [number, number];
}

function rangeOf(lists: ArrayLike<number | null>[]): [number, number] {
  let low = Infinity;
  let high = -Infinity;
  for (const list of lists)
    for (let i = 0; i < list.length; i++) {
      const v = list[i];
      if (v === null || v === undefined || !Number.isFinite(v)) continue;
      if (v < low) low = v;
      if (v > high) high = v;
    }
  return low > high ? [-1, 1] : padded(low, high);
}

/** Ranges of the axes: the first list is horizontal. */
export function phaseScales(columns: ArrayLike<number | null>[]): PhaseScales {
  return {x: rangeOf(columns.slice(0, 1)), y: rangeOf(columns.slice(1))};
}

/** Strength of point i of n. */
export function fading(i: number, n: number): number {
  return n < 2 ? 1 : 0.12 + 0.88 * (i / (n - 1)) ** 2;
}

/** Round steps, at most `most` of them in the range. */
export function roundTicks([low, high]: [number, number], most: number): number[] {
  const raw = (high - low) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((f) => f * power).find((s) => s >= raw) ?? raw;
  const ticks: number[] = [];
  for (let k = Math.ceil(low / step); k * step <= high && ticks.length < 100; k++) ticks.push(k * step);
  return ticks;
}

/** Draws curves of `y` lists against `x` into a canvas of CSS size width x height. */
export function drawPhase(canvas: HTMLCanvasElement, width: number, height: number, x: {label: string; values: ArrayLike<number | null>}, curves: PhaseCurve[], style: PhaseStyle): void {
  const scale = devicePixelRatio || 1;
  if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
  }
  const paint = canvas.getContext('2d');
  if (!paint) return;
  paint.setTransform(scale, 0, 0, scale, 0, 0);
  paint.clearRect(0, 0, width, height);
  const left = 52;
  const bottom = 34;
  const box = {x: left, y: 8, width: Math.max(10, width - left - 12), height: Math.max(10, height - bottom - 8)};
  const scales = phaseScales([x.values, ...curves.map((c) => c.values)]);
  const px = (v: number): number => box.x + ((v - scales.x[0]) / (scales.x[1] - scales.x[0])) * box.width;
  const py = (v: number): number => box.y + box.height - ((v - scales.y[0]) / (scales.y[1] - scales.y[0])) * box.height;
  paint.font = style.font;
  paint.fillStyle = style.text;
  paint.strokeStyle = style.grid;
  paint.lineWidth = 1;
  paint.textAlign = 'center';
  for (const tick of roundTicks(scales.x, Math.max(2, box.width / 80))) {
    paint.beginPath();
    paint.moveTo(Math.round(px(tick)) + 0.5, box.y);
    paint.lineTo(Math.round(px(tick)) + 0.5, box.y + box.height);
    paint.stroke();
    paint.fillText(formatNumber(tick, 4), px(tick), box.y + box.height + 14);
  }
  paint.textAlign = 'right';
  for (const tick of roundTicks(scales.y, Math.max(2, box.height / 40))) {
    paint.beginPath();
    paint.moveTo(box.x, Math.round(py(tick)) + 0.5);
    paint.lineTo(box.x + box.width, Math.round(py(tick)) + 0.5);
    paint.stroke();
    paint.fillText(formatNumber(tick, 4), box.x - 6, py(tick) + 4);
  }
  paint.textAlign = 'center';
  paint.fillText(x.label, box.x + box.width / 2, height - 4, box.width);

  paint.save();
  paint.beginPath();
  paint.rect(box.x, box.y, box.width, box.height);
  paint.clip();
  paint.lineWidth = 1.5;
  paint.lineJoin = 'round';
  const n = x.values.length;
  const pieces = 24;  // each of one strength
  for (const curve of curves) {
    paint.strokeStyle = curve.color;
    for (let piece = 0; piece < pieces; piece++) {
      const from = Math.floor((n * piece) / pieces);
      const to = Math.min(n - 1, Math.floor((n * (piece + 1)) / pieces));
      paint.globalAlpha = fading(to, n);
      paint.beginPath();
      let open = false;
      for (let i = from; i <= to; i++) {
        const a = x.values[i];
        const b = curve.values[i];
        if (a === null || a === undefined || b === null || b === undefined) {
          open = false;
          continue;
        }
        if (open) paint.lineTo(px(a), py(b));
        else paint.moveTo(px(a), py(b));
        open = true;
      }
      paint.stroke();
    }
    paint.globalAlpha = 1;
    for (let i = n - 1; i >= 0; i--) {
      const a = x.values[i];
      const b = curve.values[i];
      if (a === null || a === undefined || b === null || b === undefined) continue;
      paint.fillStyle = curve.color;
      paint.beginPath();
      paint.arc(px(a), py(b), 3.5, 0, 2 * Math.PI);
      paint.fill();
      break;
    }
  }
  paint.restore();
}
