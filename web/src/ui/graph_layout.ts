// Places the nodes of a directed graph in layers, left to right, with few crossings. After K. Sugiyama, S. Tagawa, M. Toda, Methods for
// visual understanding of hierarchical system structures (1981): break cycles, layer by longest path, order by means of neighbours.

export interface GraphNode {
  id: string;
  width: number;
}

export interface Placed {
  x: number;
  y: number;
  layer: number;
}

export interface Layout {
  places: Map<string, Placed>;
  width: number;
  height: number;
}

export function layoutGraph(nodes: GraphNode[], edges: [string, string][], row_px = 34, gap_px = 90): Layout {
  const ids = new Set(nodes.map((n) => n.id));
  const next = new Map<string, string[]>(nodes.map((n) => [n.id, []]));
  const before = new Map<string, string[]>(nodes.map((n) => [n.id, []]));
  const seen = new Set<string>();
  const sane = edges.filter(([a, b]) => {
    const key = JSON.stringify([a, b]);
    if (a === b || !ids.has(a) || !ids.has(b) || seen.has(key)) return false;
    seen.add(key);
    return true;
  });
  for (const [a, b] of withoutCycles(nodes, sane)) {
    next.get(a)?.push(b);
    before.get(b)?.push(a);
  }
  const layers = layersOf(nodes, next, before);
  order(layers, next, before);
  const places = new Map<string, Placed>();
  const tallest = Math.max(1, ...layers.map((l) => l.length));
  const widths = new Map(nodes.map((n) => [n.id, n.width]));
  let x = 0;
  layers.forEach((layer, at) => {
    const top = ((tallest - layer.length) * row_px) / 2;
    layer.forEach((id, i) => places.set(id, {x, y: top + i * row_px, layer: at}));
    x += Math.max(0, ...layer.map((id) => widths.get(id) ?? 0)) + gap_px;
  });
  return {places, width: Math.max(0, x - gap_px), height: tallest * row_px};
}

/** Edges that lead back to a node on the way are turned round. Iterative: chains may be long. */
function withoutCycles(nodes: GraphNode[], edges: [string, string][]): [string, string][] {
  const out = new Map<string, string[]>();
  for (const [a, b] of edges) out.set(a, [...(out.get(a) ?? []), b]);
  const state = new Map<string, 'open' | 'done'>();
  const turned = new Set<string>();
  for (const {id} of nodes) {
    if (state.has(id)) continue;
    const stack: {id: string; at: number}[] = [{id, at: 0}];
    state.set(id, 'open');
    while (stack.length > 0) {
      const top = stack[stack.length - 1] as {id: string; at: number};
      const child = (out.get(top.id) ?? [])[top.at++];
      if (child === undefined) {
        state.set(top.id, 'done');
        stack.pop();
      } else if (state.get(child) === 'open') {
        turned.add(JSON.stringify([top.id, child]));
      } else if (!state.has(child)) {
        state.set(child, 'open');
        stack.push({id: child, at: 0});
      }
    }
  }
  return edges.map(([a, b]) => (turned.has(JSON.stringify([a, b])) ? [b, a] : [a, b]));
}

function layersOf(nodes: GraphNode[], next: Map<string, string[]>, before: Map<string, string[]>): string[][] {
  const missing = new Map(nodes.map((n) => [n.id, before.get(n.id)?.length ?? 0]));
  const depth = new Map<string, number>();
  const ready = nodes.filter((n) => missing.get(n.id) === 0).map((n) => n.id);
  const layers: string[][] = [];
  for (let i = 0; i < ready.length; i++) {
    const id = ready[i] as string;
    const at = depth.get(id) ?? 0;
    (layers[at] ??= []).push(id);
    for (const child of next.get(id) ?? []) {
      depth.set(child, Math.max(depth.get(child) ?? 0, at + 1));
      const left = (missing.get(child) ?? 1) - 1;
      missing.set(child, left);
      if (left === 0) ready.push(child);
    }
  }
  return layers.map((l) => l ?? []);
}

function order(layers: string[][], next: Map<string, string[]>, before: Map<string, string[]>): void {
  const at = new Map<string, number>();
  const number = (): void => layers.forEach((layer) => layer.forEach((id, i) => at.set(id, i / Math.max(1, layer.length))));
  number();
  for (let pass = 0; pass < 6; pass++) {
    const neighbours = pass % 2 === 0 ? before : next;
    for (const layer of pass % 2 === 0 ? layers : [...layers].reverse()) {
      const mean = new Map(layer.map((id) => {
        const list = neighbours.get(id) ?? [];
        return [id, list.length === 0 ? at.get(id) ?? 0 : list.reduce((sum, n) => sum + (at.get(n) ?? 0), 0) / list.length];
      }));
      layer.sort((a, b) => (mean.get(a) ?? 0) - (mean.get(b) ?? 0) || (a < b ? -1 : 1));
      layer.forEach((id, i) => at.set(id, i / Math.max(1, layer.length)));
    }
  }
  number();
}
