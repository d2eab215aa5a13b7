// The 3D view alone, against the mock server: for measuring it and for looking at it. Not part of the page.
import { SceneView } from '../src/scene/scene';

const query = new URLSearchParams(location.search);
const host = document.getElementById('scene') as HTMLElement;
const scene = new SceneView(host, { assetBase: '/assets' });
scene.setTheme(query.get('theme') === 'dark' ? 'dark' : 'light');
scene.setOverlays({ links: query.get('team') !== 'no', batteries: query.get('team') !== 'no' });
const drags: unknown[] = [];
scene.onSelect = (address) => document.body.setAttribute('data-selected', address ?? '');
Object.assign(window, { scene, drags });

const socket = new WebSocket(`ws://${location.host}/`, ['foxglove.websocket.v1']);
socket.binaryType = 'arraybuffer';
const topics = new Map<number, string>();
const services = new Map<string, number>();
let call = 0;
function say(line: string): void {
  const payload = new TextEncoder().encode(JSON.stringify({ line }));
  const bytes = new Uint8Array(17 + payload.length);
  const view = new DataView(bytes.buffer);
  bytes[0] = 2;
  view.setUint32(1, services.get('/sandlot/console') ?? 0, true);
  view.setUint32(5, ++call, true);
  view.setUint32(9, 4, true);
  bytes.set(new TextEncoder().encode('json'), 13);
  bytes.set(payload, 17);
  socket.send(bytes);
}
Object.assign(window, { say });
scene.onDrag = (drag) => {
  drags.push(drag);
  const p = drag.target.map((v) => v.toFixed(4)).join(' ');
  if (drag.mode === 'pull') say(drag.phase === 'end' ? `pull ${drag.name} off` : `pull ${drag.name} ${drag.link} ${drag.point?.join(' ')} ${p}`);
  else if (drag.mode === 'turn') say(`pose ${drag.name} ${p} ${drag.yaw}`);
  else say(`drag ${drag.name} ${p}`);
};

socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
  if (typeof event.data === 'string') {
    const message = JSON.parse(event.data) as { op: string; channels?: { id: number; topic: string }[]; services?: { id: number; name: string }[] };
    message.services?.forEach((s) => services.set(s.name, s.id));
    if (message.op !== 'advertise') return;
    const wanted = (message.channels ?? []).filter((c) => ['/sandlot/world', '/sandlot/poses', '/sandlot/contacts', '/sandlot/deliveries', '/sandlot/batteries'].includes(c.topic) || /^\/rover(_[23])?\/laser\/ranges$/.test(c.topic));
    for (const c of wanted) topics.set(c.id, c.topic);
    socket.send(JSON.stringify({ op: 'subscribe', subscriptions: wanted.map((c) => ({ id: c.id, channelId: c.id })) }));
    return;
  }
  const view = new DataView(event.data);
  if (view.getUint8(0) !== 1) return;
  const topic = topics.get(view.getUint32(1, true)) ?? '';
  const payload = event.data.slice(13);
  if (topic === '/sandlot/world') scene.setWorld(JSON.parse(new TextDecoder().decode(payload)));
  else if (topic === '/sandlot/poses') scene.applyPoses(payload);
  else if (topic === '/sandlot/contacts') scene.setContacts(payload);
  else if (topic === '/sandlot/deliveries') scene.setDeliveries(payload);
  else if (topic === '/sandlot/batteries') scene.setBatteries(payload);
  else if (topic.endsWith('/ranges')) scene.setScan(topic.slice(1, -'/ranges'.length), readScan(payload));
};

/** CDR of sensor_msgs/LaserScan. */
function readScan(bytes: ArrayBuffer): Parameters<SceneView['setScan']>[1] {
  const view = new DataView(bytes);
  let at = 4 + 8 + 4 + view.getUint32(12, true);
  at += (4 - (at % 4)) % 4;
  const f = (n: number): number => view.getFloat32(at + 4 * n, true);
  const count = view.getUint32(at + 28, true);
  return { angle_min: f(0), angle_increment: f(2), range_min: f(5), range_max: f(6), ranges: new Float32Array(bytes.slice(at + 32, at + 32 + 4 * count)) };
}
