// The plots, side by side. They are remembered in this browser.
import type {Context, Panel} from '../app/context';
import {remember, remembered} from '../app/settings';
import {h} from '../ui/dom';
import {icon} from '../ui/icons';
import {PlotMemory, PlotWindow} from './plot_window';

const windows_max = 12;

export class PlotsPanel implements Panel {
  readonly windows: PlotWindow[] = [];
  private readonly addButton = h('button', {class: 'plain add-plot', title: 'Another plot', 'aria-label': 'Another plot', testid: 'add-plot'}, icon('plus'), h('span', {}, 'Plot'));
  readonly element = h('div', {class: 'pane plots', 'aria-label': 'Plots'}, this.addButton);
  private visible = false;
  private active: PlotWindow | null = null;
  private started = false;

  constructor(private readonly context: Context) {
    this.addButton.addEventListener('click', () => {
      this.active = this.open({values: [], window_s: 30});
      this.active?.focusInput();
      this.save();
    });
    for (const memory of remembered<PlotMemory[]>('plots', []).slice(0, windows_max)) {
      if (Array.isArray(memory?.values)) this.open(memory);
    }
    if (this.windows.length === 0) this.open({values: [], window_s: 30});
    this.started = true;
  }

  private open(memory: PlotMemory): PlotWindow | null {
    if (this.windows.length >= windows_max) {
      this.context.toast(`No more than ${windows_max} plots at once`, 'warning');
      return null;
    }
    const plot = new PlotWindow(this.context, memory, () => this.save(), (closed) => {
      closed.close();
      this.windows.splice(this.windows.indexOf(closed), 1);
      if (this.active === closed) this.active = null;
      this.save();
    }, (one) => {
      this.active = one;
    });
    this.windows.push(plot);
    this.element.insertBefore(plot.element, this.addButton);
    plot.setVisible(this.visible);
    return plot;
  }

  private save(): void {
    if (this.started) remember('plots', this.windows.map((w) => w.memory()));
  }

  /** To the plot used last; a new one where a third unit would need a third axis. */
  addValue(address: string, unit: string): void {
    let target: PlotWindow | null = this.active ?? this.windows[this.windows.length - 1] ?? null;
    if (target) {
      const units = new Set([...target.values.map((v) => v.unit), unit]);
      if (units.size > 2) target = null;
    }
    target ??= this.open({values: [], window_s: 30});
    this.active = target;
    void target?.add({address, unit});
  }

  /** A plot of its own for values against the first one. */
  addPhase(addresses: string[]): void {
    this.active = this.open({values: addresses.map((address) => ({address, unit: ''})), window_s: 30, phase: true});
    this.save();
  }

  setVisible(visible: boolean): void {
    this.visible = visible;
    for (const plot of this.windows) plot.setVisible(visible);
  }

  themeChanged(): void {
    for (const plot of this.windows) plot.rebuild();
  }
}
