// The panels of all robots that have one, side by side. Only those in view are drawn.
import type {Context, Panel} from '../app/context';
import type {Instance} from '../protocol';
import {clear, h} from './dom';
import {hasPanel, RobotPanel} from './robot_panel';

const panels_max = 200;

export class RobotPanelsPane implements Panel {
  readonly element = h('div', {class: 'pane robot-panels', 'aria-label': 'Panels of the robots'});
  private readonly panels = new Map<Element, RobotPanel>();
  private shown = '';
  private visible = false;
  private readonly observer = new IntersectionObserver((entries) => {
    for (const entry of entries) this.panels.get(entry.target)?.setVisible(this.visible && entry.isIntersecting);
  });

  constructor(private readonly context: Context) {
    context.store.onWorld.on(() => this.list());
    context.store.onRole.on(() => this.panels.forEach((panel) => panel.steering()));
  }

  private list(): void {
    if (!this.visible) return;
    const robots = (this.context.store.world?.instances ?? []).filter(hasPanel).slice(0, panels_max);
    const key = JSON.stringify(robots.map((r) => [r.name, (r.devices ?? []).map((d) => d.path)]));
    if (key === this.shown) return;
    this.shown = key;
    this.close();
    if (robots.length === 0) this.element.append(h('div', {class: 'empty'}, 'No robot here has a screen, keys or a speaker'));
    for (const robot of robots) this.add(robot);
  }

  private add(robot: Instance): void {
    const panel = new RobotPanel(this.context, robot, true);
    this.panels.set(panel.element, panel);
    this.element.append(panel.element);
    this.observer.observe(panel.element);
  }

  private close(): void {
    this.panels.forEach((panel) => panel.close());
    this.panels.clear();
    this.observer.disconnect();
    clear(this.element);
  }

  setVisible(visible: boolean): void {
    if (visible === this.visible) return;
    this.visible = visible;
    this.shown = '';
    if (visible) this.list();
    else this.close();
  }
}
