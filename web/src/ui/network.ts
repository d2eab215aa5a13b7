// The network of an agent: sensors on the left, motors in the middle, what its model predicts of the sensors on the right. Lines are as wide
// as the weights are large.
import {edgesOf, elementName, signedColor, SignedMap, Weights} from '../plots/weights';
import {cellText} from '../plots/weights';

export interface NetworkInput {
  controller: Weights | null;  // motors x sensors
  model: Weights | null;       // sensors x motors
  sensors: Weights | null;
  motors: Weights | null;
}

export interface NetworkStyle {
  map: SignedMap;
  line: string;
  text: string;
  dim: string;
  ground: string;
}

interface Place {
  layer: number;
  index: number;
  x: number;
  y: number;
}

export interface NetworkLayout {
  places: Place[];
  radius: number;
  layers: {title: string; name: string; count: number; x: number}[];
}

/** Where nodes are drawn: layers side by side, each spread over the height. */
export function layoutNetwork(sensors: number, motors: number, predicts: boolean, width: number, height: number): NetworkLayout {
  const names = [{title: 'sensors', name: 'x', count: sensors}, {title: 'motors', name: 'y', count: motors}, ...(predicts ? [{title: 'predicted', name: 'x′', count: sensors}] : [])];
  const side = 46;
  const top = 24;
  const most = Math.max(1, sensors, motors);
  const radius = Math.max(2.5, Math.min(11, (height - top - 8) / most / 2 - 1.5));
  const layers = names.map((layer, i) => ({...layer, x: side + ((width - 2 * side) * i) / (names.length - 1)}));
  const places: Place[] = [];
  layers.forEach((layer, l) => {
    for (let i = 0; i < layer.count; i++) places.push({layer: l, index: i, x: layer.x, y: top + ((height - top - 6) * (i + 0.5)) / layer.count});
  });
  return {places, radius, layers};
}

/** The node under a point, in the order of the places; -1: none. */
export function nodeAt(layout: NetworkLayout, x: number, y: number): number {
  const reach = Math.max(8, layout.radius + 3);
  let best = -1;
  let distance = reach * reach;
  layout.places.forEach((p, i) => {
    const d = (p.x - x) ** 2 + (p.y - y) ** 2;
    if (d < distance) {
      distance = d;
      best = i;
    }
  });
  return best;
}

export function drawNetwork(canvas: HTMLCanvasElement, width: number, height: number, input: NetworkInput, style: NetworkStyle, hovered: number): NetworkLayout {
  const scale = devicePixelRatio || 1;
  if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
  }
  const sensors = input.controller?.columns ?? input.sensors?.rows ?? 0;
  const motors = input.controller?.rows ?? input.motors?.rows ?? 0;
  const layout = layoutNetwork(sensors, motors, input.model !== null, width, height);
  const paint = canvas.getContext('2d');
  if (!paint) return layout;
  paint.setTransform(scale, 0, 0, scale, 0, 0);
  paint.clearRect(0, 0, width, height);
  const first = [0, sensors, sensors + motors];
  const at = (layer: number, index: number): Place => layout.places[(first[layer] as number) + index] as Place;
  const chosen = hovered >= 0 ? layout.places[hovered] : undefined;

  const draw = (weights: Weights | null, layer: number): void => {
    if (!weights) return;
    const edges = edgesOf(weights);
    const most = Math.abs(edges[edges.length - 1]?.weight ?? 1);
    const widest = Math.max(1.5, Math.min(7, layout.radius));
    const pass = (lit: boolean): void => {
      for (const edge of edges) {
        const a = at(layer, edge.from);
        const b = at(layer + 1, edge.to);
        const touches = chosen === a || chosen === b;
        if (chosen ? touches !== lit : lit) continue;
        const share = Math.abs(edge.weight) / most;
        const [red, green, blue] = signedColor(edge.weight, Math.abs(edge.weight), style.map);
        paint.strokeStyle = `rgb(${red} ${green} ${blue})`;
        paint.globalAlpha = chosen ? (touches ? 1 : 0.08) : 0.25 + 0.7 * share;
        paint.lineWidth = Math.max(0.4, widest * share);
        paint.beginPath();
        const bend = (b.x - a.x) * 0.4;
        paint.moveTo(a.x, a.y);
        paint.bezierCurveTo(a.x + bend, a.y, b.x - bend, b.y, b.x, b.y);
        paint.stroke();
      }
    };
    pass(false);
    pass(true);
    paint.globalAlpha = 1;
  };
  draw(input.controller, 0);
  draw(input.model, 1);

  paint.font = '11px system-ui, sans-serif';
  paint.textAlign = 'center';
  paint.fillStyle = style.dim;
  for (const layer of layout.layers) paint.fillText(layer.title, layer.x, 12);
  const ends = layout.layers.length - 1;
  layout.places.forEach((place, k) => {
    const values = place.layer === 0 ? input.sensors : place.layer === 1 ? input.motors : null;
    const value = values?.values[place.index];
    const [red, green, blue] = value === undefined ? style.map.zero : signedColor(value, 1, style.map);
    paint.fillStyle = value === undefined ? style.ground : `rgb(${red} ${green} ${blue})`;
    paint.strokeStyle = style.line;
    paint.lineWidth = k === hovered ? 2.5 : 1;
    paint.beginPath();
    paint.arc(place.x, place.y, layout.radius, 0, 2 * Math.PI);
    paint.fill();
    paint.stroke();
    if (layout.radius < 5 && k !== hovered) return;
    paint.fillStyle = style.text;
    paint.textAlign = place.layer === 0 ? 'right' : place.layer === ends ? 'left' : 'center';
    const beside = layout.radius + 6;
    const label = `${layout.layers[place.layer]?.name ?? ''}${place.index}`;
    if (place.layer === 0) paint.fillText(label, place.x - beside, place.y + 4);
    else if (place.layer === ends) paint.fillText(label, place.x + beside, place.y + 4);
    else if (k === hovered || (height - 30) / Math.max(1, motors) > 2 * layout.radius + 13) paint.fillText(label, place.x, place.y - beside + 2);
  });
  return layout;
}

/** "y1 = 0.42: C[1,0] 1.1, C[1,1] −0.3": a node and its connections. */
export function describeNode(layout: NetworkLayout, k: number, input: NetworkInput): string {
  const place = layout.places[k];
  if (!place) return '';
  const values = place.layer === 0 ? input.sensors : place.layer === 1 ? input.motors : null;
  const value = values?.values[place.index];
  const weights = place.layer === 2 ? input.model : input.controller;
  const parts: string[] = [];
  if (weights)
    for (const edge of edgesOf(weights, 0).reverse()) {
      if ((place.layer === 0 ? edge.from : edge.to) !== place.index || parts.length === 6) continue;
      parts.push(`${elementName(weights, edge.to * weights.columns + edge.from)} ${cellText(edge.weight)}`);
    }
  const name = `${layout.layers[place.layer]?.name ?? ''}${place.index}`;
  return `${name}${value === undefined ? '' : ` = ${cellText(value)}`}${parts.length > 0 ? `: ${parts.join(', ')}` : ''}`;
}
