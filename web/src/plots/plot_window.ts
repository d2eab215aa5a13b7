// One plot: several values over simulated time.
import uPlot from 'uplot';
import type {Context} from '../app/context';
import {formatNumber, unitOf} from '../app/format';
import {ticker} from '../app/ticker';
import {Watch} from '../app/watcher';
import {clear, h, setText} from '../ui/dom';
import {saveBlob} from '../ui/save';
import {icon} from '../ui/icons';
import {Suggestions} from '../ui/overlays';
import {acceptValues, Value} from '../ui/values';
import {fileName, toCsv} from './csv';
import {drawPhase} from './phase';
import {padded} from './scales';
import {PlotData} from './series';

export interface PlotMemory {
  values: Value[];
  window_s: number;
  /** Values against the first one, in place of against time. */
  phase?: boolean;
}

interface Shown extends Value {
  color: string;
  error: string;
}

/** Told apart on dark and on light. */
const colors = ['#4f9dff', '#f2994a', '#2fb67c', '#e5629b', '#a57bf0', '#c9a227', '#27b3c4', '#e06050'];
const rate_hz = 20;
const phase_rate_hz = 50;  // curves need more points than lines over time
const windows_s = [5, 10, 30, 60, 300, 1800];

export class PlotWindow {
  readonly data = new PlotData();
  readonly values: Shown[] = [];
  private window_s: number;
  private paused = false;
  private pausedAt_s = 0;
  private zoom: [number, number] | null = null;
  private watch: Watch | null = null;
  private plot: uPlot | null = null;
  private phase: boolean;
  private readonly phaseCanvas = h('canvas', {class: 'phase-canvas', testid: 'phase-canvas', 'aria-label': 'Values against the first one'});
  private visible = false;
  private readonly legend = h('div', {class: 'plot-legend'});
  private readonly area = h('div', {class: 'plot-area'});
  private readonly hint = h('div', {class: 'empty plot-hint'}, 'Drop a value here, or type an address or an expression above');
  private readonly input = h('input', {class: 'mono', placeholder: 'Add a value: rover.pose.x', 'aria-label': 'Address or expression to plot', testid: 'plot-input'});
  private readonly pauseButton = h('button', {class: 'plain small icon-only', 'aria-label': 'Hold the plot still', title: 'Hold the plot still', 'aria-pressed': 'false'}, icon('pause', 13));
  private readonly fitButton = h('button', {class: 'plain small', hidden: true, title: 'Show the newest again (double click in the plot)'}, 'Back to live');
  private readonly phaseButton = h('button', {class: 'plain small', title: 'Phase plot: values against the first one', 'aria-pressed': 'false', testid: 'plot-phase'}, 'x–y');
  readonly element: HTMLElement;
  private readonly stops: (() => void)[] = [];
  private legendValues: HTMLElement[] = [];

  constructor(private readonly context: Context, memory: PlotMemory, private readonly changed: () => void, private readonly closing: (plot: PlotWindow) => void, private readonly active: (plot: PlotWindow) => void) {
    this.window_s = windows_s.includes(memory.window_s) ? memory.window_s : 30;
    this.phase = memory.phase === true;
    const span = h('select', {class: 'quiet', 'aria-label': 'Length of the window', title: 'Length of the window'}, ...windows_s.map((s) => h('option', {value: s}, s < 60 ? `${s} s` : `${s / 60} min`)));
    span.value = String(this.window_s);
    span.addEventListener('change', () => {
      this.window_s = Number(span.value);
      this.zoom = null;
      this.changed();
      this.draw();
    });
    const button = (name: string, label: string, run: () => void): HTMLElement => h('button', {class: 'plain small icon-only', title: label, 'aria-label': label, on: {click: run}}, icon(name, 13));
    this.element = h('article', {class: 'plot-window', testid: 'plot', on: {pointerdown: () => this.active(this)}},
        h('div', {class: 'plot-head'}, this.input, span, this.fitButton, this.phaseButton, this.pauseButton,
          h('button', {class: 'plain small', title: 'Save the numbers as CSV', testid: 'plot-csv', on: {click: () => this.saveCsv()}}, 'CSV'),
          h('button', {class: 'plain small', title: 'Save the picture as PNG', testid: 'plot-png', on: {click: () => this.savePng()}}, 'PNG'),
          button('close', 'Close the plot', () => this.closing(this))),
        this.legend, this.area, this.hint);
    this.pauseButton.addEventListener('click', () => {
      this.paused = !this.paused;
      this.pausedAt_s = this.data.times.lastTime();
      this.pauseButton.setAttribute('aria-pressed', String(this.paused));
      if (!this.paused) this.zoom = null;
      this.draw();
    });
    this.fitButton.addEventListener('click', () => this.unzoom());
    this.phaseButton.addEventListener('click', () => {
      this.phase = !this.phase;
      this.zoom = null;
      this.rewatch();
      this.build();
      this.changed();
    });
    const suggestions = new Suggestions(this.input, (text) => this.complete(text), (candidate) => {
      this.input.value = candidate;
      if (!candidate.endsWith('/') && !candidate.endsWith('.')) return;
      void suggestions.refresh();
    });
    this.input.addEventListener('keydown', (event) => {
      if (event.key !== 'Enter' || this.input.value.trim() === '') return;
      suggestions.close();
      void this.add({address: this.input.value.trim(), unit: ''}).then((added) => {
        if (added) this.input.value = '';
      });
    });
    acceptValues(this.element, (value) => void this.add(value));
    new ResizeObserver(() => ticker.request(this.resize)).observe(this.area);
    this.stops.push(context.store.onEpoch.on(() => {
      this.data.clear();
      this.zoom = null;
      if (this.values.some((v) => v.error !== '')) this.rewatch();
      this.request();
    }));
    this.stops.push(context.store.onWorld.on(() => {
      // Something that was missing may have come.
      if (this.values.some((v) => v.error !== '')) this.rewatch();
    }));
    for (const value of memory.values) this.take(value);
    this.rewatch();
    this.build();
  }

  private async complete(text: string): Promise<string[]> {
    const match = /[\w/.[\]-]*$/.exec(text);
    const last = match?.[0] ?? '';
    const before = text.slice(0, text.length - last.length);
    const found = await this.context.steer.complete(`show ${last}`);
    return found.map((candidate) => before + candidate);
  }

  /** False when the server does not know such a value; says so. */
  async add(value: Value): Promise<boolean> {
    if (this.values.some((v) => v.address === value.address)) return true;
    const error = await this.probe(value.address);
    if (error !== '') {
      this.context.toast(error, 'warning');
      return false;
    }
    // Of what was typed the unit is not known: values of one unit share an axis.
    const unit = value.unit !== '' ? value.unit : unitOf((await this.context.steer.ask(`show ${value.address}`)).text, value.address);
    if (this.values.some((v) => v.address === value.address)) return true;
    this.take({address: value.address, unit});
    this.rewatch();
    this.build();
    this.changed();
    return true;
  }

  private take(value: Value): void {
    if (typeof value?.address !== 'string') return;
    const color = colors.find((c) => !this.values.some((v) => v.color === c)) ?? colors[this.values.length % colors.length] ?? '#888';
    this.values.push({address: value.address, unit: String(value.unit ?? ''), color, error: ''});
    this.data.addSeries();
  }

  private async probe(address: string): Promise<string> {
    try {
      const answer = await this.context.client.call<{ok: boolean; text: string}>('/sandlot/watch', {values: [address], rate_hz: 1});
      return answer.ok ? '' : answer.text || `${address}: no such value`;
    } catch (error) {
      return error instanceof Error ? error.message : String(error);
    }
  }

  private remove(value: Shown): void {
    const at = this.values.indexOf(value);
    if (at < 0) return;
    this.values.splice(at, 1);
    this.data.removeSeries(at);
    this.rewatch();
    this.build();
    this.changed();
  }

  /** One watch for all values, so that they share their times. One that the server does not know would spoil it: it is found and left out. */
  private rewatch(without: Shown[] = []): void {
    this.watch?.close();
    this.watch = null;
    const good = this.values.filter((v) => !without.includes(v));
    if (good.length === 0) return;
    const places = good.map((v) => this.values.indexOf(v));
    const row = new Float64Array(this.values.length);
    let last_s = Number.NEGATIVE_INFINITY;
    this.watch = new Watch(this.context.client, good.map((v) => v.address), this.phase ? phase_rate_hz : rate_hz, (time_s, values) => {
      if (time_s - last_s > 2 && last_s > this.data.times.lastTime() - 1e-6) this.data.gap();
      last_s = time_s;
      row.fill(Number.NaN);
      places.forEach((place, i) => (row[place] = values[i] ?? Number.NaN));
      for (const v of good) v.error = '';
      this.data.push(time_s, row);
      this.request();
    }, () => {
      void Promise.all(this.values.map(async (v) => {
        v.error = await this.probe(v.address);
      })).then(() => {
        const bad = this.values.filter((v) => v.error !== '');
        if (bad.length > 0 && bad.length < this.values.length && without.length === 0) this.rewatch(bad);
        this.showLegend();
      });
    });
  }

  setVisible(visible: boolean): void {
    this.visible = visible;
    if (visible) this.request();
  }

  focusInput(): void {
    this.input.focus();
  }

  memory(): PlotMemory {
    return {values: this.values.map(({address, unit}) => ({address, unit})), window_s: this.window_s, ...(this.phase ? {phase: true} : {})};
  }

  // --- drawing

  private build(): void {
    this.plot?.destroy();
    this.plot = null;
    this.phaseCanvas.remove();
    this.phaseButton.setAttribute('aria-pressed', String(this.phase));
    this.hint.hidden = this.values.length > 0;
    this.area.hidden = this.values.length === 0;
    this.showLegend();
    if (this.values.length === 0) return;
    if (this.phase) {
      this.area.append(this.phaseCanvas);
      this.draw();
      return;
    }
    const css = getComputedStyle(document.documentElement);
    const grid = {stroke: css.getPropertyValue('--plot-grid'), width: 1};
    const text = css.getPropertyValue('--dim');
    const font = '11px system-ui, sans-serif';
    const units = [...new Set(this.values.map((v) => v.unit))];
    const scales: Record<string, uPlot.Scale> = {x: {time: false, auto: false}};
    const axes: uPlot.Axis[] = [{stroke: text, grid, ticks: {show: false}, font, size: 26, values: (_u, splits) => splits.map((v) => `${Number(v.toFixed(3))} s`)}];
    units.forEach((unit, at) => {
      scales[`y${at}`] = {auto: true, range: (_u, min, max) => padded(min, max)};
      if (at < 2) {
        axes.push({
          scale: `y${at}`, side: at === 0 ? 3 : 1, stroke: text, grid: at === 0 ? grid : {show: false}, ticks: {show: false}, font, labelFont: font,
          size: 52, label: unit || undefined, labelSize: 14, values: (_u, splits) => splits.map((v) => formatNumber(v, 4)),
        });
      }
    });
    this.plot = new uPlot({
      width: Math.max(50, this.area.clientWidth), height: Math.max(40, this.area.clientHeight), legend: {show: false}, scales, axes, pxAlign: false,
      cursor: {drag: {x: true, y: false, setScale: false}, points: {size: 6}, y: false},
      series: [{}, ...this.values.map((v) => ({scale: `y${units.indexOf(v.unit)}`, stroke: v.color, width: 1.5, points: {show: false}, spanGaps: false}))],
      hooks: {
        setSelect: [(u) => {
          if (u.select.width < 4) return;
          this.zoom = [u.posToVal(u.select.left, 'x'), u.posToVal(u.select.left + u.select.width, 'x')];
          u.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
          this.draw();
        }],
        setCursor: [() => this.showValues()],
      },
    }, [[], ...this.values.map(() => [])] as unknown as uPlot.AlignedData, this.area);
    this.plot.over.addEventListener('dblclick', () => this.unzoom());
    this.draw();
  }

  /** Colours of axes are baked in: told when the theme changes. */
  rebuild(): void {
    this.build();
  }

  private unzoom(): void {
    this.zoom = null;
    this.paused = false;
    this.pauseButton.setAttribute('aria-pressed', 'false');
    this.draw();
  }

  private readonly resize = (): void => {
    if (this.phase) this.draw();
    if (!this.plot || this.area.clientWidth === 0) return;
    this.plot.setSize({width: this.area.clientWidth, height: this.area.clientHeight});
    this.draw();
  };

  private request(): void {
    if (this.visible) ticker.request(this.draw);
  }

  private readonly draw = (): void => {
    if ((!this.plot && !this.phase) || !this.visible) return;
    const newest = this.data.times.lastTime();
    const end = this.zoom ? this.zoom[1] : this.paused ? this.pausedAt_s : Number.isNaN(newest) ? this.context.store.time_s : newest;
    // A run that is younger than the window begins at the left edge.
    const born_s = Math.min(this.context.store.status?.begin_s ?? 0, end - 1);
    const begin = this.zoom ? this.zoom[0] : Math.max(end - this.window_s, born_s);
    this.fitButton.hidden = this.zoom === null;
    if (this.phase) {
      this.drawPhase(begin, end);
      return;
    }
    const columns = this.data.columns(begin, end, Math.max(100, this.area.clientWidth));
    this.plot?.batch(() => {
      this.plot?.setData(columns as unknown as uPlot.AlignedData, false);
      this.plot?.setScale('x', {min: begin, max: end});
    });
    this.showValues();
  };

  /** Points as they came: thinned to their extremes they would lie at other times. */
  private drawPhase(begin_s: number, end_s: number): void {
    if (this.values.length === 0 || this.area.clientWidth === 0) return;
    const most = 6000;
    const columns = this.data.columns(begin_s, end_s, most);
    const css = getComputedStyle(document.documentElement);
    const against = this.values[0] as Shown;
    const others = this.values.length > 1 ? this.values.slice(1) : [against];
    drawPhase(this.phaseCanvas, this.area.clientWidth, this.area.clientHeight, {label: against.unit ? `${against.address} [${against.unit}]` : against.address, values: columns[1] ?? []},
        others.map((v, i) => ({color: v.color, label: v.address, values: columns[this.values.length > 1 ? i + 2 : 1] ?? []})),
        {grid: css.getPropertyValue('--plot-grid'), text: css.getPropertyValue('--dim'), font: '11px system-ui, sans-serif'});
    this.showValues();
  }

  private showLegend(): void {
    clear(this.legend);
    this.legendValues = this.values.map((v) => {
      const number = h('span', {class: 'number'}, '–');
      this.legend.append(h('span', {class: `legend-item${v.error ? ' bad' : ''}`, title: v.error || v.address},
          h('i', {style: {background: v.color}}), h('span', {class: 'ellipsis mono'}, v.address), number, h('span', {class: 'unit'}, v.unit),
          h('button', {class: 'plain small icon-only', title: `Remove ${v.address}`, 'aria-label': `Remove ${v.address}`, on: {click: () => this.remove(v)}}, icon('close', 10))));
      return number;
    });
    this.showValues();
  }

  private showValues(): void {
    const index = this.plot?.cursor.idx;
    this.values.forEach((_v, i) => {
      const hovered = index === null || index === undefined || (this.plot?.cursor.left ?? -1) < 0 ? undefined : this.plot?.data[i + 1]?.[index];
      const value = hovered === undefined ? this.data.series[i]?.lastValue() ?? Number.NaN : hovered ?? Number.NaN;
      const cell = this.legendValues[i];
      if (cell) setText(cell, formatNumber(value));
    });
  }

  // --- files

  private saveCsv(): void {
    const names = this.values.map((v) => v.address);
    saveBlob(new Blob([toCsv(this.data, names)], {type: 'text/csv'}), fileName(names[0] ?? 'plot', 'csv'));
  }

  private savePng(): void {
    const source = this.phase ? this.phaseCanvas : this.plot?.ctx.canvas;
    if (!source) return;
    const scale = devicePixelRatio || 1;
    const head = 26 * scale;
    const canvas = h('canvas', {width: source.width, height: source.height + head});
    const paint = canvas.getContext('2d');
    if (!paint) return;
    const css = getComputedStyle(document.documentElement);
    paint.fillStyle = css.getPropertyValue('--panel');
    paint.fillRect(0, 0, canvas.width, canvas.height);
    paint.drawImage(source, 0, head);
    paint.font = `${12 * scale}px system-ui, sans-serif`;
    let x = 10 * scale;
    for (const v of this.values) {
      paint.fillStyle = v.color;
      paint.fillRect(x, 9 * scale, 10 * scale, 10 * scale);
      paint.fillStyle = css.getPropertyValue('--text');
      const text = v.unit ? `${v.address} [${v.unit}]` : v.address;
      paint.fillText(text, x + 15 * scale, 18 * scale);
      x += paint.measureText(text).width + 34 * scale;
    }
    canvas.toBlob((blob) => {
      if (blob) saveBlob(blob, fileName(this.values[0]?.address ?? 'plot', 'png'));
    });
  }

  close(): void {
    this.watch?.close();
    this.plot?.destroy();
    for (const stop of this.stops) stop();
    this.element.remove();
  }
}
