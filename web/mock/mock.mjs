// A stand-in for the server while the page is developed: speaks enough of docs/viewer_protocol.md, simulates nothing.
//
//   node mock/mock.mjs [--port 8123] [--robots 3] [--dist DIR] [--paused] [--match]     a made-up match instead of the hall
import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { WebSocketServer } from 'ws';
import { CdrReader, CdrWriter, Writer } from './bytes.mjs';
import { decisionMessage, decisionsUntil, makeMatch, moveMatch, playerMessage, stateMessage, trackUntil } from './match.mjs';
import { clientsMessage } from './clients.mjs';
import { SCHEMAS, SERVICES } from './schemas.mjs';
import { cratePng } from './texture.mjs';
import { driven, hillGrid, makeWorld, posesMessage, rockMesh, scan } from './world.mjs';

function option(name, fallback) {
  const at = process.argv.indexOf(`--${name}`);
  return at < 0 ? fallback : process.argv[at + 1];
}
const port = Number(option('port', '8123'));
const robots = Number(option('robots', '3'));
const dist = option('dist', fileURLToPath(new URL('../dist/', import.meta.url)));

const match = process.argv.includes('--match');
const world = match ? makeMatch() : makeWorld(robots);
const step_s = world.json.step_s;
const run = { tick: 0, playing: !process.argv.includes('--paused'), speed: 1, target_s: null };
const parameters = new Map([['sandlot.speed', 1], ['sandlot.paused', false]]);
for (const body of world.bodies.filter((b) => b.robot)) {
  parameters.set(`${body.name}/laser.noise.white`, 0.01);
  parameters.set(`${body.name}/controller.speed`, 0.5);
  parameters.set(`${body.name}/controller.turn`, 'left');
  parameters.set(`${body.name}/controller.avoid`, true);
}
for (const [name, value] of [['media/breeze.density', 1.225], ['media/air.threshold', 30], ['red/coach.spacing', 1]]) parameters.set(name, value);
const commands = [];
const touched = new Set();

// Channels ------------------------------------------------------------------------------------------------------------

const channels = [];
function channel(topic, encoding, schemaName, schema = '', schemaEncoding = '') {
  const made = { id: channels.length + 1, topic, encoding, schemaName, schema, schemaEncoding };
  channels.push(made);
  return made;
}
const json = (topic, name) => channel(topic, 'json', name, '{"type":"object"}', 'jsonschema');
const cdr = (topic, type) => channel(topic, 'cdr', type, SCHEMAS[type], 'ros2msg');
const world_channel = json('/sandlot/world', 'sandlot.World');
const poses_channel = channel('/sandlot/poses', 'sandlot-poses', 'sandlot.Poses');
const status_channel = json('/sandlot/status', 'sandlot.Status');
const commands_channel = json('/sandlot/commands', 'sandlot.Commands');
const contacts_channel = channel('/sandlot/contacts', 'sandlot-contacts', 'sandlot.Contacts');
const deliveries_channel = channel('/sandlot/deliveries', 'sandlot-deliveries', 'sandlot.Deliveries');
const batteries_channel = channel('/sandlot/batteries', 'sandlot-batteries', 'sandlot.Batteries');
const clients_channel = json('/sandlot/clients', 'sandlot.Clients');
const clock_channel = cdr('/clock', 'rosgraph_msgs/msg/Clock');
const log_channel = cdr('/rosout', 'rcl_interfaces/msg/Log');
const scan_channels = world.bodies.filter((b) => b.robot && !match).map((body) => ({ body, channel: cdr(`/${body.name}/laser/ranges`, 'sensor_msgs/msg/LaserScan') }));
// Robots repeat what the referee told them: their topics come first here, and the page should take the referee's.
const told_channel = match ? cdr('/cyan1/referee/state', 'sandlot_msgs/msg/RefereeState') : null;
const state_channel = match ? cdr('/rules/referee/state', 'sandlot_msgs/msg/RefereeState') : null;
const decision_channel = match ? cdr('/rules/referee/decision', 'sandlot_msgs/msg/RefereeDecision') : null;
const player_channels = match ? world.bodies.filter((b) => b.robot).map((body) => ({ body, id: cdr(`/${body.name}/player/state`, 'sandlot_msgs/msg/PlayerState').id })) : [];
if (match) cdr('/cyan2/eye/image/compressed', 'sensor_msgs/msg/CompressedImage');
let next_watch = 1;

// Clients -------------------------------------------------------------------------------------------------------------

const clients = new Set();
let next_client = 1;
const http = createServer(serve);
const sockets = new WebSocketServer({
  server: http,
  handleProtocols: (offered) => ['foxglove.websocket.v1', 'foxglove.sdk.v1'].find((p) => offered.has(p)) ?? false,
});

function sendMessage(client, channel_id, payload) {
  for (const [subscription, id] of client.subscriptions) {
    if (id !== channel_id || client.socket.bufferedAmount > 8 << 20) continue;
    const head = new Writer().u8(1).u32(subscription).u64(BigInt(Math.round(run.tick * step_s * 1e9)));
    client.socket.send(Buffer.concat([head.buffer(), Buffer.from(payload)]));
  }
}
function publish(channel_id, make) {
  let payload;
  for (const client of clients) {
    if (![...client.subscriptions.values()].includes(channel_id)) continue;
    payload ??= make();
    sendMessage(client, channel_id, payload);
  }
}
const sendJson = (client, value) => client.socket.send(JSON.stringify(value));

sockets.on('connection', (socket, request) => {
  const role = new URL(request.url, 'http://x').searchParams.get('role') === 'spectator' ? 'spectator' : 'admin';
  const client = { id: next_client++, socket, role, subscriptions: new Map(), published: new Map(), watches: [] };
  clients.add(client);
  sendJson(client, {
    op: 'serverInfo', name: 'sandlot mock', capabilities: ['clientPublish', 'time', 'parameters', 'parametersSubscribe', 'services', 'connectionGraph', 'assets'],
    supportedEncodings: ['cdr', 'json'], metadata: { ROS_DISTRO: 'humble', sandlot_version: 'mock', sandlot_role: role, sandlot_client: String(client.id) }, sessionId: `mock ${process.pid}`,
  });
  sendJson(client, { op: 'advertise', channels });
  sendJson(client, {
    op: 'advertiseServices',
    services: SERVICES.map((s, i) => ({
      id: i + 1, name: s.name, type: s.type,
      request: { encoding: 'cdr', schemaName: `${s.type}_Request`, schemaEncoding: 'ros2msg', schema: s.request },
      response: { encoding: 'cdr', schemaName: `${s.type}_Response`, schemaEncoding: 'ros2msg', schema: s.response },
    })),
  });
  socket.on('message', (data, is_binary) => {
    try {
      if (is_binary) onBinary(client, data);
      else onText(client, JSON.parse(data.toString()));
    } catch (error) {
      sendJson(client, { op: 'status', level: 2, message: String(error) });
    }
  });
  socket.on('close', () => clients.delete(client));
  socket.on('error', () => socket.terminate());
});

const asParameter = ([name, value]) => ({ name, value });

function onText(client, message) {
  switch (message.op) {
    case 'subscribe':
      for (const { id, channelId } of message.subscriptions) {
        client.subscriptions.set(id, channelId);
        if (channelId === world_channel.id) sendMessage(client, channelId, JSON.stringify(world.json));
        if (channelId === poses_channel.id) sendMessage(client, channelId, posesMessage(world, run.tick));
        if (channelId === batteries_channel.id) sendMessage(client, channelId, batteriesMessage());
        if (channelId === state_channel?.id) sendMessage(client, channelId, stateMessage(run.tick * step_s));
        if (channelId === status_channel.id) sendMessage(client, channelId, JSON.stringify(status()));
      }
      break;
    case 'unsubscribe':
      message.subscriptionIds.forEach((id) => client.subscriptions.delete(id));
      break;
    case 'getParameters':
      sendJson(client, {
        op: 'parameterValues', id: message.id,
        parameters: [...parameters].filter(([n]) => message.parameterNames.length === 0 || message.parameterNames.includes(n)).map(asParameter),
      });
      break;
    case 'setParameters':
      for (const { name, value } of message.parameters) {
        if (client.role === 'spectator') sendJson(client, { op: 'status', level: 2, message: 'a spectator may only look' });
        else if (name.endsWith('noise.white') && value > 1) sendJson(client, { op: 'status', level: 2, message: `${name}: ${value} is not in 0 to 1 m` });
        else setParameter(name, value);
      }
      sendJson(client, { op: 'parameterValues', id: message.id, parameters: message.parameters.map(({ name }) => ({ name, value: parameters.get(name) })) });
      break;
    case 'subscribeConnectionGraph':
      sendJson(client, {
        op: 'connectionGraphUpdate', removedTopics: [], removedServices: [],
        publishedTopics: scan_channels.map(({ body }) => ({ name: `/${body.name}/laser/ranges`, publisherIds: [`${body.name}/laser`] })),
        subscribedTopics: scan_channels.map(({ body }) => ({ name: `/${body.name}/laser/ranges`, subscriberIds: [`${body.name}/controller`] })),
        advertisedServices: SERVICES.map((s) => ({ name: s.name, providerIds: ['sandlot'] })),
      });
      break;
    case 'advertise':
      message.channels.forEach((c) => client.published.set(c.id, c));
      break;
    case 'unadvertise':
      message.channelIds.forEach((id) => client.published.delete(id));
      break;
    case 'fetchAsset': {
      const bytes = asset(message.uri.replace('sandlot://', '/assets/'));
      const error = bytes ? '' : 'no such asset';
      client.socket.send(Buffer.concat([new Writer().u8(4).u32(message.requestId).u8(bytes ? 0 : 1).u32(error.length).bytes(Buffer.from(error)).buffer(), bytes ?? Buffer.alloc(0)]));
      break;
    }
    default:
  }
}

function setParameter(name, value) {
  if (!parameters.has(name)) return;
  parameters.set(name, value);
  if (name === 'sandlot.paused') run.playing = !value;
  if (name === 'sandlot.speed') run.speed = value === 0 ? null : value;
  log('parameter', name, `${name} = ${value}`);
  for (const client of clients) sendJson(client, { op: 'parameterValues', parameters: [{ name, value }] });
}

function onBinary(client, data) {
  if (data[0] === 1) {
    const topic = client.published.get(data.readUInt32LE(1))?.topic;
    if (topic) log('command', topic, `${data.length - 5} bytes`);
    return;
  }
  if (data[0] !== 2) return;
  const service = data.readUInt32LE(1);
  const call = data.readUInt32LE(5);
  const length = data.readUInt32LE(9);
  const encoding = data.subarray(13, 13 + length).toString();
  const payload = Buffer.from(data.subarray(13 + length));
  const respond = (value, encode) => {
    const body = encoding === 'json' ? Buffer.from(JSON.stringify(value)) : encode(new CdrWriter()).buffer();
    client.socket.send(Buffer.concat([new Writer().u8(3).u32(service).u32(call).u32(length).bytes(Buffer.from(encoding)).buffer(), body]));
  };
  const request = encoding === 'json' ? JSON.parse(payload.toString() || '{}') : undefined;
  switch (SERVICES[service - 1]?.name) {
    case '/sandlot/console': {
      const answer = consoleLine(client, (request?.line ?? new CdrReader(payload).string()).trim());
      respond(answer, (w) => w.bool(answer.ok).string(answer.text));
      break;
    }
    case '/sandlot/complete': {
      const candidates = complete(request?.line ?? new CdrReader(payload).string());
      respond({ candidates }, (w) => { w.u32(candidates.length); candidates.forEach((c) => w.string(c)); return w; });
      break;
    }
    case '/sandlot/decisions':
      respond({ decisions: decisionsUntil(world, run.tick * step_s) }, (w) => w.u32(0));
      break;
    case '/sandlot/match_track':
      respond(trackUntil(world, match ? run.tick * step_s : 0), (w) => w.u32(0).u32(0).u32(0).u32(0).u32(0).u32(0));
      break;
    case '/sandlot/watch': {
      const reader = request ? undefined : new CdrReader(payload);
      const values = request?.values ?? reader.strings();
      const rate_hz = request?.rate_hz ?? reader.f64();
      const made = { id: 100000 + next_watch, topic: `/sandlot/watch/${next_watch++}`, encoding: 'cdr', schemaName: 'sandlot_msgs/msg/Samples', schema: SCHEMAS['sandlot_msgs/msg/Samples'], schemaEncoding: 'ros2msg' };
      client.watches.push({ id: made.id, values, period_s: rate_hz > 0 ? 1 / rate_hz : step_s, due_s: 0 });
      sendJson(client, { op: 'advertise', channels: [made] });
      respond({ ok: true, text: '', topic: made.topic }, (w) => w.bool(true).string('').string(made.topic));
      break;
    }
    case '/sandlot/disconnect_client':
    case '/sandlot/restart_program': {
      const answer = { ok: false, text: 'a made-up client does nothing' };
      respond(answer, (w) => w.bool(answer.ok).string(answer.text));
      break;
    }
    default:
      sendJson(client, { op: 'serviceCallFailure', serviceId: service, callId: call, message: 'no such service' });
  }
}

// The run -------------------------------------------------------------------------------------------------------------

function log(kind, target, text, refused = false, why = '') {
  commands.push({ tick: run.tick, time_s: run.tick * step_s, source: 'admin', id: 1, sequence: commands.length, kind, target, text, refused, why });
  publish(commands_channel.id, () => JSON.stringify({ commands: [commands.at(-1)] }));
}

function bodyNamed(name) {
  const body = world.bodies.find((b) => b.name === name);
  if (!body) throw new Error(`nothing is named ${name}`);
  return body;
}

/** Puts a body somewhere; a rover goes on in circles about the new place. */
function place(body, x, y, z, yaw) {
  if (body.circle) {
    const at = driven(body, run.tick * step_s);
    body.circle.x += x - at.x;
    body.circle.y += y - at.y;
    if (yaw !== undefined) body.circle.phase += yaw - at.yaw;
  } else {
    body.pose = [x, y, z ?? body.pose[2], ...(yaw === undefined ? body.pose.slice(3) : [Math.cos(yaw / 2), 0, 0, Math.sin(yaw / 2)])];
  }
  touched.add(body.id);
}

function consoleLine(client, line) {
  const [verb, ...words] = line.split(/\s+/);
  try {
    if (client.role === 'spectator' && !['help', 'list', 'show'].includes(verb)) throw new Error('a spectator may only look');
    const numbers = words.slice(1).map(Number);
    switch (verb) {
      case 'pause': run.playing = false; break;
      case 'run': run.playing = true; break;
      case 'step': run.playing = false; run.tick += Number(words[0] ?? 1); break;
      case 'speed': run.speed = words[0] === 'max' ? null : Number(words[0]); break;
      case 'reset':
        run.tick = 0;
        ++world.json.epoch;
        publish(world_channel.id, () => JSON.stringify(world.json));
        break;
      case 'jump':
        if (run.tick > Math.round(Number(words[0]) / step_s)) {
          ++world.json.epoch;
          publish(world_channel.id, () => JSON.stringify(world.json));
        }
        run.tick = Math.round(Number(words[0]) / step_s);
        if (match) playMatch(run.tick * step_s);
        publish(poses_channel.id, () => posesMessage(world, run.tick));
        break;
      case 'pose': place(bodyNamed(words[0]), numbers[0], numbers[1], numbers[2], numbers[5] ?? numbers[3]); break;
      case 'drag': place(bodyNamed(words[0]), numbers[0], numbers[1], numbers[2]); break;
      case 'pull':
        if (words[1] !== 'off') place(bodyNamed(words[0]), Number(words[5]), Number(words[6]), Math.max(0, Number(words[7])));
        break;
      case 'remove': {
        const body = bodyNamed(words[0]);
        world.bodies.splice(world.bodies.indexOf(body), 1);
        world.json.instances = world.json.instances.filter((i) => i.id !== body.id);
        ++world.json.revision;
        publish(world_channel.id, () => JSON.stringify(world.json));
        break;
      }
      case 'set': setParameter(words[0], Number.isNaN(Number(words[1])) ? words[1] : Number(words[1])); return { ok: true, text: `${words[0]} = ${words[1]}` };
      case 'list': return { ok: true, text: list(words) };
      case 'help': return { ok: true, text: 'pause run step speed reset jump pose drag pull remove set list' };
      default: throw new Error(`${verb} is no command; try help`);
    }
    log(verb, words[0] ?? '', line);
    sendNow();
    return { ok: true, text: '' };
  } catch (error) {
    log(verb, words[0] ?? '', line, true, error.message);
    return { ok: false, text: error.message };
  }
}

function list(words) {
  const what = words.find((w) => !w.startsWith('--')) ?? 'entities';
  if (what === 'models') return JSON.stringify(['models/rover/model.sdf', 'models/crate/model.sdf'].map((name) => ({ name, help: 'A model.' })));
  if (what.includes('/')) {
    return JSON.stringify([
      { address: `${what}.ranges`, unit: 'm', help: 'Distances.', value: null, count: 181 },
      { address: `${what}.ranges[0]`, unit: 'm', help: 'First distance.', value: 1.2, count: 0 },
    ]);
  }
  return JSON.stringify(world.bodies.map((b) => ({ name: b.name })));
}

function complete(line) {
  const verbs = ['pause', 'run', 'step', 'speed', 'reset', 'jump', 'pose', 'drag', 'pull', 'set', 'level', 'add', 'remove', 'store', 'load', 'record', 'list', 'show'];
  const words = line.split(' ');
  const all = words.length < 2 ? verbs : [...world.bodies.map((b) => b.name), ...parameters.keys()];
  return all.filter((c) => c.startsWith(words.at(-1))).slice(0, 100);
}

function status() {
  return {
    state: run.playing ? 'playing' : 'paused', time_s: run.tick * step_s, tick: run.tick, step_s, speed: run.speed, real_time_factor: run.playing ? (run.speed ?? 25) * 0.998 : 0,
    late_ticks: 0, reason: '', begin_s: 0, end_s: null, history_s: Array.from({ length: Math.min(20, Math.floor(run.tick * step_s) + 1) }, (_, i) => i),
    target_s: null, may_steer: true, may_rewind: true, why_not: '', replay: false, recording: null, viewers: clients.size, epoch: world.json.epoch, dropped_frames: 0,
  };
}

/** Any number that is watched: made up from its address so that each has a curve of its own. */
function watched(address) {
  if (address.endsWith('.criterion')) return Math.floor((run.tick * step_s) / (address.startsWith('red') ? 15 : 25));
  const seed = [...address].reduce((sum, c) => (sum * 31 + c.charCodeAt(0)) % 997, 7);
  return Math.sin(run.tick * step_s * (0.5 + (seed % 10) / 5) + seed);
}

function sendNow() {
  publish(poses_channel.id, () => posesMessage(world, run.tick));
  publish(status_channel.id, () => JSON.stringify(status()));
}

const FRAME_MS = 1000 / 30;
let frame = 0;
setInterval(() => {
  ++frame;
  if (run.playing) run.tick += Math.max(1, Math.round(((run.speed ?? 25) * FRAME_MS) / 1000 / step_s));
  const time_s = run.tick * step_s;
  if (match && run.playing) playMatch(time_s);
  if (run.playing) publish(poses_channel.id, () => posesMessage(world, run.tick, match || frame % 60 === 0 ? undefined : new Set(world.bodies.filter((b) => b.circle || touched.has(b.id)).map((b) => b.id))));
  touched.clear();
  if (frame % 6 === 0) publish(status_channel.id, () => JSON.stringify(status()));
  if (frame % 15 === 0) publish(clients_channel.id, () => JSON.stringify(clientsMessage([...clients].map((c) => c.id), world.bodies.filter((b) => b.robot).map((b) => b.name), time_s)));
  if (frame % 6 === 0 || run.playing) {
    const time = new Writer().u8(2).u64(BigInt(Math.round(time_s * 1e9))).buffer();
    for (const client of clients) client.socket.send(time);
  }
  if (!run.playing) return;
  publish(clock_channel.id, () => new CdrWriter().time(time_s).buffer());
  publish(contacts_channel.id, contactsMessage);
  if (frame % 8 === 0) publish(deliveries_channel.id, deliveriesMessage);
  if (frame % 6 === 0) publish(batteries_channel.id, batteriesMessage);
  if (frame % 30 === 0) {
    publish(log_channel.id, () => new CdrWriter().time(time_s).u8([20, 30, 40][(frame / 30) % 3]).string('mock').string(`second ${time_s.toFixed(2)} has passed`).string('').string('').u32(0).buffer());
  }
  if (frame % 3 === 0) for (const { body, channel: { id } } of scan_channels) publish(id, () => scanMessage(body, time_s));
  for (const client of clients) {
    for (const watch of client.watches) {
      if (time_s < watch.due_s && time_s > watch.due_s - 1) continue;
      watch.due_s = time_s + watch.period_s;
      const w = new CdrWriter().time(time_s).u32(watch.values.length);
      watch.values.forEach((v) => w.f64(watched(v)));
      sendMessage(client, watch.id, w.buffer());
    }
  }
}, FRAME_MS);

let told_s = 0;
function playMatch(time_s) {
  moveMatch(world, time_s);
  for (const decision of decisionsUntil(world, time_s)) if (decision.at_s > told_s) publish(decision_channel.id, () => decisionMessage(decision));
  told_s = time_s;
  if (frame % 6 !== 0 && run.playing) return;
  publish(state_channel.id, () => stateMessage(time_s));
  publish(told_channel.id, () => stateMessage(time_s, true));
  for (const { body, id } of player_channels) publish(id, () => playerMessage(world, body, time_s));
}

function scanMessage(body, time_s) {
  const beams = 181;
  const w = new CdrWriter().time(time_s).string(`${body.name}/laser`);
  w.f32(-2.0944).f32(2.0944).f32(4.1888 / (beams - 1)).f32(0).f32(0.1).f32(0.05).f32(8).u32(beams);
  scan(world, body, time_s, beams).forEach((r) => w.f32(r));
  return w.u32(0).buffer();
}

function contactsMessage() {
  const rovers = world.bodies.filter((b) => b.circle).slice(0, 200);
  const w = new Writer().u64(BigInt(run.tick)).i64(BigInt(Math.round(run.tick * step_s * 1e9))).u32(rovers.length * 2);
  for (const body of rovers) {
    const at = driven(body, run.tick * step_s);
    for (const side of [-0.19, 0.19]) {
      w.f32(at.x - side * Math.sin(at.yaw)).f32(at.y + side * Math.cos(at.yaw)).f32(0).f32(0).f32(0).f32(1).f32(0.0005);
    }
  }
  return w.arrayBuffer();
}

const robotBodies = world.bodies.filter((b) => b.robot);
const counted = (count) => new Writer().u64(BigInt(run.tick)).i64(BigInt(Math.round(run.tick * step_s * 1e9))).u32(count);

/** Each robot is heard by the next two, by way of the medium "air". */
function deliveriesMessage() {
  const pairs = robotBodies.flatMap((sender, i) => [1, 2].map((n) => [sender, robotBodies[(i + n) % robotBodies.length]])).filter(([a, b]) => a !== b).slice(0, 1000);
  const w = counted(pairs.length);
  for (const [sender, receiver] of pairs) w.u32(sender.id).u32(receiver.id).u16(1).u16(1).i32(0).f32(50);
  return w.arrayBuffer();
}

/** Full at the start, empty after a minute and more, and full again. */
function batteriesMessage() {
  const w = counted(robotBodies.length);
  robotBodies.forEach((body, i) => w.u32(body.id).f32(Math.max(0, 1 - ((run.tick * step_s) / 60 + i * 0.23) % 1.2)));
  return w.arrayBuffer();
}

// Files ---------------------------------------------------------------------------------------------------------------

const assets = { '/assets/mesh/a0': rockMesh(), '/assets/grid/g0': hillGrid(), '/assets/texture/t0': cratePng() };
function asset(path) {
  return assets[path];
}

const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml', '.map': 'application/json', '.png': 'image/png' };

async function serve(request, response) {
  const path = new URL(request.url, 'http://x').pathname;
  const bytes = asset(path);
  if (bytes) {
    response.writeHead(200, { 'content-type': path.includes('texture') ? 'image/png' : 'application/octet-stream' }).end(bytes);
    return;
  }
  try {
    const file = path === '/' ? '/index.html' : normalize(path);
    const body = await readFile(join(dist, file));
    response.writeHead(200, {
      'content-type': TYPES[extname(file)] ?? 'application/octet-stream',
      'content-security-policy': "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' blob: data:; connect-src 'self' ws: wss:",
    }).end(body);
  } catch {
    response.writeHead(404, { 'content-type': 'text/plain' }).end('not found\n');
  }
}

http.listen(port, '127.0.0.1', () => console.log(`http://127.0.0.1:${http.address().port}/ (${match ? 'a match' : `${robots} robots`})`));
