import test from 'node:test';
import assert from 'node:assert/strict';
import { load } from './bundle.mjs';
import { Writer, smallestThree } from '../mock/bytes.mjs';

const binary = await load('binary.ts');

function slot(motions) {
  return { motions: Uint8Array.from(motions), values: new Float64Array(7 * motions.length), form: 0 };
}

function header(writer, count, more = {}) {
  return writer.u8(more.version ?? 1).u8(more.flags ?? 1).u16(3).u32(12).u64(123n).i64(1_230_000_000n).u32(count);
}

test('a record of joints is read link by link', () => {
  const w = header(new Writer(), 1);
  w.u32(7).u8(0).f32(1).f32(-2).f32(0.5).bytes(smallestThree([1, 0, 0, 0]));
  w.u16(16384).f32(0.25).f32(-3).bytes(smallestThree([0, 0, 0, 1]));
  // Fixed tells nothing; then a link that no joint carries.
  w.f32(4).f32(5).f32(6).bytes(smallestThree([0, 1, 0, 0]));
  const s = slot([5, 1, 2, 3, 4, 0, 5]);
  const head = binary.emptyPosesHeader();
  const moved = [];
  assert.equal(binary.decodePoses(w.arrayBuffer(), head, (id) => (id === 7 ? s : undefined), (id) => moved.push(id)), true);
  assert.deepEqual(head, { key_frame: true, epoch: 3, revision: 12, tick: 123, time_s: 1.23, count: 1 });
  assert.deepEqual(moved, [7]);
  assert.deepEqual([...s.values.slice(0, 3)], [1, -2, 0.5]);
  assert.ok(Math.abs(s.values[7] - Math.PI / 2) < 1e-12); // 16384 / 65536 of a turn
  assert.equal(s.values[14], 0.25);
  assert.equal(s.values[21], -3);
  near([...s.values.slice(31, 35)], [0, 0, 0, 1]);
  near([...s.values.slice(42, 49)], [4, 5, 6, 0, 1, 0, 0]);
});

test('form 1 tells every link in the world', () => {
  const w = header(new Writer(), 1);
  w.u32(7).u8(1);
  for (let link = 0; link < 2; ++link) w.f32(link).f32(0).f32(0).bytes(smallestThree([1, 0, 0, 0]));
  const s = slot([5, 1]);
  assert.equal(binary.decodePoses(w.arrayBuffer(), binary.emptyPosesHeader(), () => s, () => {}), true);
  assert.equal(s.form, 1);
  near([...s.values.slice(7, 14)], [1, 0, 0, 1, 0, 0, 0]);
});

test('the smallest three come back within their step', () => {
  // One step is sqrt(2) / 32767, rounding makes half of it; the fourth follows from the others with at most
  // the sum of their errors over itself (>= 1/2): 3 * (0.5 * 1/2) / 0.5 steps.
  const step = Math.SQRT2 / 32767;
  const out = new Float64Array(4);
  for (const q of [[0.5, 0.5, 0.5, 0.5], [0.1, -0.9, 0.3, 0.2], [0.2, 0.3, -0.9, -0.1], [-0.3, 0.4, 0.1, -0.85], [0.99, 0.01, -0.1, 0.05]]) {
    const length = Math.hypot(...q);
    const unit = q.map((c) => c / length);
    binary.readSmallestThree(new DataView(Uint8Array.from(smallestThree(unit)).buffer), 0, out, 0);
    const sign = Math.sign(out[0] * unit[0]); // q and -q are the same turn
    for (let i = 0; i < 4; ++i) assert.ok(Math.abs(sign * out[i] - unit[i]) <= 1.5 * step, `${q} gave ${out}`);
  }
});

test('damaged messages are refused, at every length', () => {
  const w = header(new Writer(), 1);
  w.u32(7).u8(0).f32(1).f32(2).f32(3).bytes(smallestThree([1, 0, 0, 0])).u16(1);
  const whole = new Uint8Array(w.arrayBuffer());
  const decode = (bytes, known = true) =>
    binary.decodePoses(bytes, binary.emptyPosesHeader(), () => (known ? slot([5, 1]) : undefined), () => {});
  assert.equal(decode(whole), true);
  for (let length = 0; length < whole.length; ++length) assert.equal(decode(whole.slice(0, length)), false, `${length} bytes`);
  assert.equal(decode(whole, false), false);
  assert.equal(decode(Uint8Array.from([...whole, 0])), false);
  assert.equal(decode(Uint8Array.from([2, ...whole.slice(1)])), false);
  const many = whole.slice();
  many.set([255, 255, 255, 255], 24);
  assert.equal(decode(many), false);
});

test('contacts are read, and refused when their count is wrong', () => {
  const w = new Writer().u64(5n).i64(50_000_000n).u32(2);
  for (let i = 0; i < 14; ++i) w.f32(i);
  const contacts = binary.emptyContacts();
  const whole = new Uint8Array(w.arrayBuffer());
  assert.equal(binary.decodeContacts(whole, contacts), true);
  assert.equal(contacts.count, 2);
  assert.equal(contacts.time_s, 0.05);
  assert.deepEqual([...contacts.values.slice(0, 14)], [...Array(14).keys()]);
  assert.equal(binary.decodeContacts(whole.slice(0, -1), contacts), false);
  assert.equal(contacts.count, 0);
  assert.equal(binary.decodeContacts(new ArrayBuffer(3), contacts), false);
});

test('deliveries are read, and refused when their count is wrong', () => {
  const w = new Writer().u64(5n).i64(50_000_000n).u32(2);
  w.u32(7).u32(8).u16(1).u16(3).u32(0xffffffff).f32(-50).u32(8).u32(7).u16(0).u16(1).u32(2).f32(20);
  const whole = new Uint8Array(w.arrayBuffer());
  const deliveries = binary.emptyDeliveries();
  assert.equal(binary.decodeDeliveries(whole, deliveries), true);
  assert.equal(deliveries.count, 2);
  assert.equal(deliveries.time_s, 0.05);
  assert.deepEqual([...deliveries.values.slice(0, 12)], [7, 8, 1, 3, -1, -50, 8, 7, 0, 1, 2, 20]);
  for (let length = 0; length < whole.length; ++length) assert.equal(binary.decodeDeliveries(whole.slice(0, length), deliveries), false, `${length} bytes`);
  assert.equal(deliveries.count, 0);
});

test('charges of batteries are read, and refused when their count is wrong', () => {
  const w = new Writer().u64(5n).i64(50_000_000n).u32(100);
  for (let i = 0; i < 100; ++i) w.u32(i + 3).f32(i === 1 ? NaN : i / 128);
  const whole = new Uint8Array(w.arrayBuffer());
  const batteries = binary.emptyBatteries();
  assert.equal(binary.decodeBatteries(whole, batteries), true);
  assert.equal(batteries.count, 100);
  assert.deepEqual([batteries.ids[0], batteries.ids[99], batteries.charges[1], batteries.charges[99]], [3, 102, 0, 99 / 128]);
  assert.equal(binary.decodeBatteries(whole.slice(0, -1), batteries), false);
  assert.equal(batteries.count, 0);
});

function near(actual, expected) {
  for (let i = 0; i < expected.length; ++i) {
    assert.ok(Math.abs(actual[i] - expected[i]) < 1e-4, `${actual} is not ${expected}`);
  }
}
