import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';

const { Client } = await load('net/client.ts');
const frames = await load('net/frames.ts');
const { targetOf, socketAddress } = await load('net/address.ts');

/** A socket whose other end is the test. */
class Socket {
  constructor() {
    this.sent = [];
    this.readyState = 1;
  }
  send(data) {
    this.sent.push(typeof data === 'string' ? JSON.parse(data) : data);
  }
  close() {
    this.readyState = 3;
  }
  text(value) {
    this.onmessage({ data: JSON.stringify(value) });
  }
  ops() {
    return this.sent.filter((s) => s.op).map((s) => s.op);
  }
}

/** The client is closed when the test ends, also when it fails: its timers would keep the process. */
function connected(t, more = {}) {
  const sockets = [];
  const client = new Client({
    address: () => 'ws://here/',
    backoff_ms: [5],
    makeSocket: () => {
      const socket = new Socket();
      sockets.push(socket);
      return socket;
    },
    ...more,
  });
  t.after(() => client.close());
  client.connect();
  return { client, sockets, hello: () => sockets.at(-1).text({ op: 'serverInfo', name: 's', capabilities: ['connectionGraph'] }) };
}

const advertise = (id, topic) => ({ op: 'advertise', channels: [{ id, topic, encoding: 'json', schemaName: 'x', schema: '' }] });
const soon = (ms = 30) => new Promise((resolve) => setTimeout(resolve, ms));

function messageFrame(subscription, time_ns, text) {
  const payload = new TextEncoder().encode(text);
  const buffer = new ArrayBuffer(13 + payload.length);
  const view = new DataView(buffer);
  view.setUint8(0, 1);
  view.setUint32(1, subscription, true);
  view.setBigUint64(5, time_ns, true);
  new Uint8Array(buffer).set(payload, 13);
  return buffer;
}

test('a service request is framed as the protocol says, byte by byte', () => {
  const bytes = new Uint8Array(frames.encodeServiceRequest(0x01020304, 7, 'json', new Uint8Array([0x7b, 0x7d])));
  assert.deepEqual([...bytes], [2, 4, 3, 2, 1, 7, 0, 0, 0, 4, 0, 0, 0, 0x6a, 0x73, 0x6f, 0x6e, 0x7b, 0x7d]);
  assert.deepEqual([...new Uint8Array(frames.encodeClientMessage(258, new Uint8Array([9])))], [1, 2, 1, 0, 0, 9]);
});

test('a frame that is cut anywhere is null or keeps within its bytes', () => {
  const response = [3, 1, 0, 0, 0, 2, 0, 0, 0, 4, 0, 0, 0, 0x6a, 0x73, 0x6f, 0x6e, 0x31];
  assert.equal(frames.decodeServerFrame(new Uint8Array(response).buffer).encoding, 'json');
  for (let length = 0; length < 17; length++) assert.equal(frames.decodeServerFrame(new Uint8Array(response.slice(0, length)).buffer), null, `${length}`);
  const lying = new Uint8Array(response);
  lying[12] = 0x80;  // says that the encoding is 2 GiB long
  assert.equal(frames.decodeServerFrame(lying.buffer), null);
  assert.equal(frames.decodeServerFrame(new Uint8Array([99, 0, 0]).buffer), null);
  const asset = frames.decodeServerFrame(new Uint8Array([4, 5, 0, 0, 0, 1, 2, 0, 0, 0, 0x6e, 0x6f]).buffer);
  assert.equal(asset.error, 'no');
});

test('a subscription waits for its channel and outlives the connection', async (t) => {
  const { client, sockets, hello } = connected(t);
  const got = [];
  client.subscribe('/a', (m) => got.push([m.value(), m.time_ns]));
  hello();
  assert.deepEqual(sockets[0].ops(), []);
  sockets[0].text(advertise(4, '/a'));
  assert.equal(sockets[0].sent[0].subscriptions[0].channelId, 4);
  sockets[0].onmessage({ data: messageFrame(sockets[0].sent[0].subscriptions[0].id, 5n, '{"x":1}') });
  assert.deepEqual(got, [[{ x: 1 }, 5n]]);
  sockets[0].onclose({ code: 1006, reason: '' });
  assert.equal(client.state, 'waiting');
  await soon();
  assert.equal(sockets.length, 2);
  hello();
  sockets[1].text(advertise(9, '/a'));
  assert.equal(sockets[1].sent[0].subscriptions[0].channelId, 9);
});

test('two listeners share one subscription; the last one ends it', (t) => {
  const { client, sockets, hello } = connected(t);
  hello();
  sockets[0].text(advertise(4, '/a'));
  const stops = [client.subscribe('/a', () => undefined), client.subscribe('/a', () => undefined)];
  assert.deepEqual(sockets[0].ops(), ['subscribe']);
  stops[0]();
  stops[0]();
  assert.deepEqual(sockets[0].ops(), ['subscribe']);
  stops[1]();
  assert.deepEqual(sockets[0].ops(), ['subscribe', 'unsubscribe']);
});

test('a hidden page keeps only what is for the background', (t) => {
  const { client, sockets, hello } = connected(t);
  hello();
  sockets[0].text({ op: 'advertise', channels: [advertise(1, '/status').channels[0], advertise(2, '/poses').channels[0]] });
  client.subscribe('/status', () => undefined, { background: true });
  client.subscribe('/poses', () => undefined);
  const poses_id = sockets[0].sent[1].subscriptions[0].id;
  client.setHidden(true);
  assert.deepEqual(sockets[0].sent.at(-1), { op: 'unsubscribe', subscriptionIds: [poses_id] });
  client.setHidden(false);
  assert.equal(sockets[0].sent.at(-1).subscriptions[0].channelId, 2);
});

test('malformed messages are counted and the rest goes on', (t) => {
  const { client, sockets, hello } = connected(t);
  hello();
  const warn = console.warn;
  console.warn = () => undefined;
  for (const data of ['{', 'null', '{"op":"advertise"}', '{"op":"advertise","channels":7}', '[]', '7']) sockets[0].onmessage({ data });
  sockets[0].onmessage({ data: new ArrayBuffer(3) });
  console.warn = warn;
  assert.ok(client.counts.malformed >= 4);
  sockets[0].text(advertise(4, '/a'));
  assert.ok(client.channels.has('/a'));
});

test('a call is answered, refused, or times out; a lost connection ends it', async (t) => {
  const { client, sockets, hello } = connected(t);
  await assert.rejects(client.call('/c', {}), /not connected/);
  hello();
  sockets[0].text({ op: 'advertiseServices', services: [{ id: 3, name: '/c', type: 't' }] });
  const callId = () => new DataView(sockets[0].sent.at(-1)).getUint32(5, true);
  const answered = client.call('/c', { line: 'x' });
  const id = callId();
  const body = new TextEncoder().encode('{"ok":true}');
  const response = new Uint8Array(17 + body.length);
  const view = new DataView(response.buffer);
  view.setUint8(0, 3);
  view.setUint32(1, 3, true);
  view.setUint32(5, id, true);
  view.setUint32(9, 4, true);
  response.set(new TextEncoder().encode('json'), 13);
  response.set(body, 17);
  sockets[0].onmessage({ data: response.buffer });
  assert.deepEqual(await answered, { ok: true });
  const refused = client.call('/c', {});
  sockets[0].text({ op: 'serviceCallFailure', serviceId: 3, callId: callId(), message: 'not you' });
  await assert.rejects(refused, /not you/);
  await assert.rejects(client.call('/c', {}, 10), /no answer within/);
  const lost = client.call('/c', {});
  sockets[0].onclose({ code: 1006, reason: 'cable' });
  await assert.rejects(lost, /cable/);
});

test('a refused parameter comes back with its old value and the reason', async (t) => {
  const { client, sockets, hello } = connected(t);
  hello();
  const answer = client.setParameters([{ name: 'a.b', value: 9 }]);
  const { id } = sockets[0].sent.at(-1);
  sockets[0].text({ op: 'status', level: 2, message: 'a.b: 9 is not in 0 to 1' });
  sockets[0].text({ op: 'parameterValues', id, parameters: [{ name: 'a.b', value: 0.5 }] });
  assert.deepEqual(await answer, { parameters: [{ name: 'a.b', value: 0.5 }], reasons: ['a.b: 9 is not in 0 to 1'] });
});

test('a token leaves the address bar, is kept for this host, and never goes to another', () => {
  const kept = new Map();
  const store = { getItem: (k) => kept.get(k) ?? null, setItem: (k, v) => kept.set(k, v) };
  const first = targetOf({ href: 'http://box:8080/?token=s3cret&role=spectator' }, store);
  assert.equal(first.cleanHref, 'http://box:8080/?role=spectator');
  assert.equal(socketAddress(first.target), 'ws://box:8080/?token=s3cret&role=spectator&name=page');
  assert.equal(targetOf({ href: 'http://box:8080/' }, store).target.token, 's3cret');
  assert.equal(targetOf({ href: 'http://box:8080/?ws=ws://evil:1/' }, store).target.token, '');
  assert.equal(targetOf({ href: 'https://box/' }, store).target.url, 'wss://box/');
});
