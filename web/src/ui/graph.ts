// Who talks to whom, drawn as layers: programs and devices that publish, their topics, those who listen.
import type {Context, Panel} from '../app/context';
import type {ConnectionGraph} from '../net/client';
import {ticker} from '../app/ticker';
import {clear, h, svg} from './dom';
import {layoutGraph} from './graph_layout';
import {icon} from './icons';

const nodes_max = 400;

interface Drawn {
  nodes: Map<string, {label: string; topic: boolean}>;
  edges: [string, string][];
}

/** Nodes "n:" and topics "t:" whose names, or whose neighbours' names, hold the filter; of one robot when it is given. */
export function graphOf(graph: ConnectionGraph, filter: string, own: boolean, robot = ''): Drawn {
  const text = filter.trim().toLowerCase();
  const nodes = new Map<string, {label: string; topic: boolean}>();
  const edges: [string, string][] = [];
  const topics = new Set([...graph.publishedTopics.keys(), ...graph.subscribedTopics.keys()]);
  for (const topic of topics) {
    if (!own && topic.startsWith('/sandlot/')) continue;
    const from = graph.publishedTopics.get(topic) ?? [];
    const to = graph.subscribedTopics.get(topic) ?? [];
    if (text !== '' && ![topic, ...from, ...to].some((name) => name.toLowerCase().includes(text))) continue;
    if (robot !== '' && ![topic.slice(1), ...from, ...to].some((name) => name === robot || name.startsWith(`${robot}/`))) continue;
    nodes.set(`t:${topic}`, {label: topic, topic: true});
    for (const id of from) {
      nodes.set(`n:${id}`, {label: id, topic: false});
      edges.push([`n:${id}`, `t:${topic}`]);
    }
    for (const id of to) {
      nodes.set(`n:${id}`, {label: id, topic: false});
      edges.push([`t:${topic}`, `n:${id}`]);
    }
  }
  return {nodes, edges};
}

export class GraphPanel implements Panel {
  private readonly search = h('input', {type: 'search', placeholder: 'Filter', 'aria-label': 'Filter the graph'});
  private readonly quiet = h('input', {type: 'checkbox', class: 'switch'});
  private readonly selected = h('input', {type: 'checkbox', class: 'switch'});
  private readonly own = h('input', {type: 'checkbox', class: 'switch'});
  private readonly area = h('div', {class: 'graph-area', tabindex: '0'});
  readonly element = h('div', {class: 'pane graph'}, h('div', {class: 'pane-head'}, h('div', {class: 'search grow'}, icon('search', 14), this.search),
      h('label', {class: 'inline', title: 'Only what the selected robot says and hears'}, this.selected, 'Selected robot'), h('label', {class: 'inline', title: 'Topics that nobody listens to'}, this.quiet, 'Unheard topics'), h('label', {class: 'inline', title: 'What the page itself listens to'}, this.own, 'Sandlot’s own')), this.area);
  private stop: (() => void) | null = null;
  private graph: ConnectionGraph | null = null;

  constructor(private readonly context: Context) {
    this.quiet.checked = true;
    this.selected.checked = true;
    context.store.onSelection.on(() => {
      if (this.stop && this.selected.checked) ticker.request(this.draw);
    });
    for (const input of [this.search, this.quiet, this.selected, this.own]) input.addEventListener('input', this.draw);
  }

  private readonly draw = (): void => {
    if (!this.graph) return;
    let {nodes, edges} = graphOf(this.graph, this.search.value, this.own.checked, this.selected.checked ? this.context.store.selected()?.instance?.name ?? '' : '');
    if (!this.quiet.checked) {
      const heard = new Set(edges.filter(([a]) => a.startsWith('t:')).map(([a]) => a));
      edges = edges.filter(([a, b]) => heard.has(a) || heard.has(b));
      const used = new Set(edges.flat());
      nodes = new Map([...nodes].filter(([id]) => used.has(id)));
    }
    clear(this.area);
    if (nodes.size === 0) {
      this.area.append(h('div', {class: 'empty'}, this.search.value ? 'Nothing matches' : 'Nobody talks yet'));
      return;
    }
    if (nodes.size > nodes_max) {
      this.area.append(h('div', {class: 'empty'}, `${nodes.size} nodes and topics: filter for a robot to see its part`));
      return;
    }
    const widthOf = (label: string): number => Math.min(280, label.length * 6.7 + 22);
    const layout = layoutGraph([...nodes].map(([id, n]) => ({id, width: widthOf(n.label)})), edges);
    const margin = 14;
    const picture = svg('svg', {width: layout.width + 2 * margin, height: layout.height + 2 * margin, class: 'graph-picture', role: 'img', 'aria-label': `${nodes.size} nodes and topics`});
    const lines = svg('g', {class: 'edges'});
    const boxes = svg('g');
    picture.append(lines, boxes);
    const drawnEdges: {element: SVGElement; a: string; b: string}[] = [];
    for (const [a, b] of edges) {
      const from = layout.places.get(a);
      const to = layout.places.get(b);
      if (!from || !to) continue;
      const forwards = from.layer < to.layer;
      const x0 = from.x + margin + (forwards ? widthOf(nodes.get(a)?.label ?? '') : 0);
      const x1 = to.x + margin + (forwards ? 0 : widthOf(nodes.get(b)?.label ?? ''));
      const y0 = from.y + margin + 12;
      const y1 = to.y + margin + 12;
      const bend = (x1 - x0) / 2;
      const element = svg('path', {d: `M${x0} ${y0}C${x0 + bend} ${y0} ${x1 - bend} ${y1} ${x1} ${y1}`, class: forwards ? '' : 'back'});
      drawnEdges.push({element, a, b});
      lines.append(element);
    }
    for (const [id, node] of nodes) {
      const place = layout.places.get(id);
      if (!place) continue;
      const width = widthOf(node.label);
      const label = node.label.length > 40 ? `${node.label.slice(0, 39)}…` : node.label;
      const box = svg('g', {class: node.topic ? 'topic' : 'node', transform: `translate(${place.x + margin} ${place.y + margin})`}, svg('title', {}, node.label),
          svg('rect', {width, height: 24, rx: node.topic ? 12 : 5}), svg('text', {x: 11, y: 16}, label));
      box.addEventListener('pointerenter', () => drawnEdges.forEach((e) => e.element.classList.toggle('lit', e.a === id || e.b === id)));
      box.addEventListener('pointerleave', () => drawnEdges.forEach((e) => e.element.classList.remove('lit')));
      box.addEventListener('click', () => {
        if (!node.topic && this.context.store.find(node.label)) this.context.store.select(node.label);
      });
      boxes.append(box);
    }
    this.area.append(picture);
  };

  setVisible(visible: boolean): void {
    if (visible === (this.stop !== null)) return;
    if (visible) {
      this.stop = this.context.client.subscribeGraph((graph) => {
        this.graph = graph;
        ticker.request(this.draw);
      });
      this.graph ??= this.context.client.graph;
      ticker.request(this.draw);
    } else {
      this.stop?.();
      this.stop = null;
    }
  }
}
