// Little-endian bytes for the mock server and the tests, and CDR as its messages need it.

export class Writer {
  #bytes = new Uint8Array(256);
  #view = new DataView(this.#bytes.buffer);
  #at = 0;

  #room(count) {
    if (this.#at + count <= this.#bytes.length) return;
    const larger = new Uint8Array(Math.max(2 * this.#bytes.length, this.#at + count));
    larger.set(this.#bytes);
    this.#bytes = larger;
    this.#view = new DataView(larger.buffer);
  }
  #put(method, count, value) {
    this.#room(count);
    this.#view[method](this.#at, value, true);
    this.#at += count;
    return this;
  }
  u8(value) { return this.#put('setUint8', 1, value); }
  u16(value) { return this.#put('setUint16', 2, value); }
  u32(value) { return this.#put('setUint32', 4, value); }
  i32(value) { return this.#put('setInt32', 4, value); }
  u64(value) { return this.#put('setBigUint64', 8, value); }
  i64(value) { return this.#put('setBigInt64', 8, value); }
  f32(value) { return this.#put('setFloat32', 4, value); }
  f64(value) { return this.#put('setFloat64', 8, value); }
  bytes(values) {
    this.#room(values.length);
    this.#bytes.set(values, this.#at);
    this.#at += values.length;
    return this;
  }
  align(size, origin = 0) {
    while ((this.#at - origin) % size !== 0) this.u8(0);
    return this;
  }
  get length() { return this.#at; }
  arrayBuffer() { return this.#bytes.slice(0, this.#at).buffer; }
  buffer() { return Buffer.from(this.arrayBuffer()); }
}

/** CDR, little-endian: each number on a multiple of its size behind the four bytes of the header. */
export class CdrWriter {
  #writer = new Writer().u8(0).u8(1).u8(0).u8(0);
  #aligned(method, size, value) {
    this.#writer.align(size, 4)[method](value);
    return this;
  }
  u8(value) { return this.#aligned('u8', 1, value); }
  bool(value) { return this.u8(value ? 1 : 0); }
  u32(value) { return this.#aligned('u32', 4, value); }
  i32(value) { return this.#aligned('i32', 4, value); }
  u64(value) { return this.#aligned('u64', 8, BigInt(value)); }
  f32(value) { return this.#aligned('f32', 4, value); }
  f64(value) { return this.#aligned('f64', 8, value); }
  string(value) {
    const bytes = Buffer.from(value, 'utf8');
    this.u32(bytes.length + 1);
    this.#writer.bytes(bytes).u8(0);
    return this;
  }
  time(time_s) {
    const whole_s = Math.floor(time_s);
    return this.i32(whole_s).u32(Math.min(999999999, Math.round((time_s - whole_s) * 1e9)));
  }
  buffer() { return this.#writer.buffer(); }
}

export class CdrReader {
  #view;
  #at = 4;
  constructor(bytes) { this.#view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength); }
  #next(size) {
    while ((this.#at - 4) % size !== 0) ++this.#at;
    const at = this.#at;
    this.#at += size;
    return at;
  }
  u32() { return this.#view.getUint32(this.#next(4), true); }
  f64() { return this.#view.getFloat64(this.#next(8), true); }
  string() {
    const length = this.u32();
    const text = Buffer.from(this.#view.buffer, this.#view.byteOffset + this.#at, Math.max(0, length - 1)).toString('utf8');
    this.#at += length;
    return text;
  }
  strings() { return Array.from({ length: this.u32() }, () => this.string()); }
}

/** Six bytes of an orientation w x y z, the largest left out. */
export function smallestThree(q) {
  let largest = 0;
  for (let i = 1; i < 4; ++i) if (Math.abs(q[i]) > Math.abs(q[largest])) largest = i;
  const sign = q[largest] < 0 ? -1 : 1;
  let bits = BigInt(largest);
  let shift = 2n;
  for (let i = 0; i < 4; ++i) {
    if (i === largest) continue;
    const n = Math.round(((sign * q[i] * Math.SQRT2 + 1) / 2) * 32767);
    bits |= BigInt(Math.min(32767, Math.max(0, n))) << shift;
    shift += 15n;
  }
  return Array.from({ length: 6 }, (_, i) => Number((bits >> BigInt(8 * i)) & 255n));
}
