// Lists and grids of numbers as pictures.
import type {Context, Panel} from '../app/context';
import {formatNumber, formatTime, parseNumber} from '../app/format';
import {remember, remembered} from '../app/settings';
import {ticker} from '../app/ticker';
import {h, setText} from '../ui/dom';
import {saveBlob} from '../ui/save';
import {colorTable, MapName, mapNames, paint} from './colormaps';
import {fileName} from './csv';
import {Grid, gridsOf, Waterfall} from './grids';

const waterfall_rows = 240;
const types = /LaserScan|OccupancyGrid|MultiArray|\/Image$|PointCloud$|Range|Joint|Array|Float|Int|UInt|Proximity|Samples/;

export class MatrixPanel implements Panel {
  private readonly topic = h('select', {'aria-label': 'Topic', testid: 'matrix-topic'});
  private readonly field = h('select', {'aria-label': 'List in the message', hidden: true});
  private readonly map = h('select', {'aria-label': 'Colours'}, ...mapNames.map((name) => h('option', {value: name}, name.charAt(0).toUpperCase() + name.slice(1))));
  private readonly auto = h('input', {type: 'checkbox', class: 'switch'});
  private readonly low = h('input', {class: 'number short', 'aria-label': 'Least value'});
  private readonly high = h('input', {class: 'number short', 'aria-label': 'Greatest value'});
  private readonly canvas = h('canvas', {class: 'matrix-canvas', width: 1, height: 1});
  private readonly readout = h('span', {class: 'mono dim readout'});
  private readonly scale = h('canvas', {class: 'matrix-scale', width: 256, height: 1});
  private readonly hint = h('div', {class: 'empty'}, 'Choose a topic with a list of numbers, such as a laser scan');
  readonly element = h('div', {class: 'pane matrix'}, h('div', {class: 'pane-head wrap'}, this.topic, this.field, this.map, h('label', {class: 'inline'}, this.auto, 'Auto'), this.low, this.scale, this.high,
      h('button', {class: 'plain small', on: {click: () => this.save()}}, 'PNG'), this.readout), h('div', {class: 'matrix-area'}, this.canvas, this.hint));
  private stop: (() => void) | null = null;
  private visible = false;
  private chosen = remembered('matrix.topic', '');
  private grid: Grid | null = null;
  private waterfall: Waterfall | null = null;
  private table = colorTable('viridis');
  private image: ImageData | null = null;
  private readonly still = document.createElement('canvas');

  constructor(private readonly context: Context) {
    this.map.value = mapNames.includes(remembered('matrix.map', 'viridis') as MapName) ? remembered('matrix.map', 'viridis') : 'viridis';
    this.auto.checked = true;
    this.useMap();
    this.map.addEventListener('change', () => this.useMap());
    this.topic.addEventListener('change', () => this.choose(this.topic.value));
    this.field.addEventListener('change', () => (this.waterfall = null));
    this.auto.addEventListener('change', () => ticker.request(this.draw));
    for (const input of [this.low, this.high]) input.addEventListener('change', () => {
      this.auto.checked = false;
      ticker.request(this.draw);
    });
    this.canvas.addEventListener('pointermove', (event) => this.hover(event));
    this.canvas.addEventListener('pointerleave', () => setText(this.readout, ''));
    context.client.onChannels.on(() => {
      if (this.visible) ticker.request(this.list);
    });
    context.store.onEpoch.on(() => (this.waterfall = null));
  }

  private useMap(): void {
    this.table = colorTable(this.map.value as MapName);
    remember('matrix.map', this.map.value);
    const paintbrush = this.scale.getContext('2d');
    if (paintbrush) {
      const row = paintbrush.createImageData(256, 1);
      paint(Array.from({length: 256}, (_, i) => i), 0, 255, this.table, row.data);
      paintbrush.putImageData(row, 0, 0);
    }
    ticker.request(this.draw);
  }

  choose(topic: string): void {
    this.chosen = topic;
    remember('matrix.topic', topic);
    this.waterfall = null;
    this.grid = null;
    this.image = null;
    this.field.replaceChildren();
    this.list();
    this.listen();
    ticker.request(this.draw);
  }

  private readonly list = (): void => {
    const names = [...this.context.client.channels.values()].filter((c) => c.encoding === 'cdr' && types.test(c.schemaName) && !c.topic.startsWith('/sandlot/')).map((c) => c.topic).sort().slice(0, 2000);
    if (this.chosen !== '' && !names.includes(this.chosen)) names.unshift(this.chosen);
    this.topic.replaceChildren(h('option', {value: ''}, names.length === 0 ? 'No topics with lists' : 'Topic'), ...names.map((name) => h('option', {value: name}, name)));
    this.topic.value = this.chosen;
  };

  /** For the first look: a scan of the selected robot, else of any. */
  private chooseFirst(): void {
    const robot = this.context.store.selected()?.instance?.name;
    const scans = [...this.context.client.channels.values()].filter((c) => c.schemaName.endsWith('/LaserScan')).map((c) => c.topic).sort();
    const first = scans.find((t) => robot !== undefined && t.startsWith(`/${robot}/`)) ?? scans[0];
    if (first) this.choose(first);
  }

  private listen(): void {
    this.stop?.();
    this.stop = null;
    if (!this.visible || this.chosen === '') return;
    this.stop = this.context.client.subscribe(this.chosen, (message) => {
      const grids = gridsOf(message.value(), message.channel.schemaName);
      const names = grids.map((g) => g.path);
      if (names.join() !== [...this.field.options].map((o) => o.value).join()) {
        this.field.replaceChildren(...names.map((name) => h('option', {value: name}, name)));
        this.field.hidden = names.length < 2;
        const longest = grids.reduce<Grid | null>((best, g) => (best === null || g.values.length > best.values.length ? g : best), null);
        this.field.value = longest?.path ?? '';
      }
      const grid = grids.find((g) => g.path === this.field.value) ?? null;
      if (!grid) return;
      this.grid = grid;
      if (grid.rows === 1) {
        if (this.waterfall?.columns !== grid.columns) this.waterfall = new Waterfall(grid.columns, waterfall_rows);
        this.waterfall.push(Number(message.time_ns) * 1e-9, grid.values);
      } else {
        this.waterfall = null;
      }
      ticker.request(this.draw);
    });
  }

  private values(): ArrayLike<number> {
    return this.waterfall?.values ?? this.grid?.values ?? [];
  }

  private readonly draw = (): void => {
    this.hint.hidden = this.grid !== null;
    this.canvas.hidden = this.grid === null;
    if (!this.visible || !this.grid) return;
    const columns = this.grid.columns;
    const rows = this.waterfall?.rows ?? this.grid.rows;
    const values = this.values();
    if (this.auto.checked) {
      let least = Infinity;
      let most = -Infinity;
      for (let i = 0; i < values.length; i++) {
        const v = values[i] as number;
        if (!Number.isFinite(v)) continue;
        if (v < least) least = v;
        if (v > most) most = v;
      }
      if (document.activeElement !== this.low) this.low.value = formatNumber(least, 4);
      if (document.activeElement !== this.high) this.high.value = formatNumber(most, 4);
      this.range = [least, most];
    } else {
      this.range = [parseNumber(this.low.value) ?? 0, parseNumber(this.high.value) ?? 1];
    }
    if (this.image?.width !== columns || this.image.height !== rows) {
      this.image = new ImageData(columns, rows);
      this.canvas.width = columns;
      this.canvas.height = rows;
      this.canvas.classList.toggle('map', this.waterfall === null);
    }
    paint(values, this.range[0], this.range[1], this.table, this.image.data);
    const paintbrush = this.canvas.getContext('2d');
    if (!paintbrush) return;
    if (this.grid.flip) {
      // Pixels are put as they are, without the transform: through a second canvas the row of the map's origin comes to lie below.
      this.still.width = columns;
      this.still.height = rows;
      this.still.getContext('2d')?.putImageData(this.image, 0, 0);
      paintbrush.clearRect(0, 0, columns, rows);
      paintbrush.save();
      paintbrush.scale(1, -1);
      paintbrush.drawImage(this.still, 0, -rows);
      paintbrush.restore();
    } else {
      paintbrush.putImageData(this.image, 0, 0);
    }
  };

  private range: [number, number] = [0, 1];

  private hover(event: PointerEvent): void {
    if (!this.grid || !this.image) return;
    const box = this.canvas.getBoundingClientRect();
    const x = Math.max(0, Math.min(this.image.width - 1, Math.floor(((event.clientX - box.left) / box.width) * this.image.width)));
    let y = Math.max(0, Math.min(this.image.height - 1, Math.floor(((event.clientY - box.top) / box.height) * this.image.height)));
    if (this.grid.flip) y = this.image.height - 1 - y;
    const value = this.values()[y * this.image.width + x] ?? Number.NaN;
    const when = this.waterfall ? this.waterfall.times[y] ?? Number.NaN : Number.NaN;
    setText(this.readout, this.waterfall ? `[${x}] at ${formatTime(when)}: ${formatNumber(value)}` : `[${x}, ${y}]: ${formatNumber(value)}`);
  }

  private save(): void {
    this.canvas.toBlob((blob) => {
      if (blob) saveBlob(blob, fileName(this.chosen, 'png'));
    });
  }

  setVisible(visible: boolean): void {
    if (visible === this.visible) return;
    this.visible = visible;
    if (visible) this.list();
    if (visible && this.chosen === '') this.chooseFirst();
    this.listen();
    if (visible) ticker.request(this.draw);
  }
}
