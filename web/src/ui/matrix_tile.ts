// One matrix of an agent: cells coloured around zero, with numbers where they fit. A click plots an element.
import {cellSize, cellText, elementName, nextScale, signedColor, SignedMap, textOn, Weights} from '../plots/weights';
import {h, setText} from './dom';

export class MatrixTile {
  private readonly canvas = h('canvas', {class: 'weights-canvas'});
  private readonly size = h('span', {class: 'faint'});
  private readonly scaleText = h('span', {class: 'faint mono'});
  readonly element: HTMLElement;
  private weights: Weights | null = null;
  private most = 0;
  private cell = {width: 1, height: 1};
  private hovered = -1;

  constructor(readonly name: string, help: string, private readonly plot: (element: number) => void, private readonly tell: (text: string) => void) {
    this.element = h('figure', {class: 'weights-tile', testid: `weights-${name}`}, h('figcaption', {title: help}, h('b', {}, name), this.size, this.scaleText), this.canvas);
    this.canvas.addEventListener('pointermove', (event) => {
      this.hovered = this.at(event);
      this.say();
    });
    this.canvas.addEventListener('pointerleave', () => {
      this.hovered = -1;
      this.tell('');
    });
    this.canvas.addEventListener('click', (event) => {
      const k = this.at(event);
      if (k >= 0) this.plot(k);
    });
  }

  private at(event: PointerEvent | MouseEvent): number {
    const w = this.weights;
    if (!w) return -1;
    const box = this.canvas.getBoundingClientRect();
    const column = Math.floor((event.clientX - box.left) / this.cell.width);
    const row = Math.floor((event.clientY - box.top) / this.cell.height);
    return row >= 0 && column >= 0 && row < w.rows && column < w.columns ? row * w.columns + column : -1;
  }

  private say(): void {
    const w = this.weights;
    if (w && this.hovered >= 0) this.tell(`${elementName(w, this.hovered)} = ${(w.values[this.hovered] as number).toPrecision(6)}`);
  }

  draw(weights: Weights, room: number, height: number, map: SignedMap, line: string): void {
    this.weights = weights;
    this.most = nextScale(this.most, weights.values);
    const cell = (this.cell = cellSize(weights.rows, weights.columns, room, height));
    const width = cell.width * weights.columns;
    const tall = cell.height * weights.rows;
    const scale = devicePixelRatio || 1;
    const canvas = this.canvas;
    if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(tall * scale)) {
      canvas.width = Math.round(width * scale);
      canvas.height = Math.round(tall * scale);
      canvas.style.width = `${width}px`;
      canvas.style.height = `${tall}px`;
    }
    setText(this.size, weights.columns > 1 ? `${weights.rows} × ${weights.columns}` : String(weights.rows));
    setText(this.scaleText, `±${cellText(this.most)}`);
    const paint = canvas.getContext('2d');
    if (!paint) return;
    paint.setTransform(scale, 0, 0, scale, 0, 0);
    paint.font = '11px ui-monospace, Menlo, Consolas, "DejaVu Sans Mono", monospace';
    paint.textAlign = 'center';
    for (let k = 0; k < weights.values.length; k++) {
      const value = weights.values[k] as number;
      const color = signedColor(value, this.most, map);
      const x = (k % weights.columns) * cell.width;
      const y = Math.floor(k / weights.columns) * cell.height;
      paint.fillStyle = `rgb(${color.join(' ')})`;
      paint.fillRect(x, y, cell.width, cell.height);
      if (cell.numbers) {
        paint.fillStyle = textOn(color);
        paint.fillText(cellText(value), x + cell.width / 2, y + cell.height / 2 + 4);
      }
    }
    paint.strokeStyle = line;
    paint.lineWidth = 1;
    if (cell.numbers || Math.min(cell.width, cell.height) > 6) {
      paint.beginPath();
      for (let i = 1; i < weights.rows; i++) paint.moveTo(0, i * cell.height + 0.5), paint.lineTo(width, i * cell.height + 0.5);
      for (let j = 1; j < weights.columns; j++) paint.moveTo(j * cell.width + 0.5, 0), paint.lineTo(j * cell.width + 0.5, tall);
      paint.stroke();
    }
    paint.strokeRect(0.5, 0.5, width - 1, tall - 1);
    this.say();
  }
}
