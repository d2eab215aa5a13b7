// A crate's planks as PNG, made here so that no picture need be stored.
import { deflateSync } from 'node:zlib';

const TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});
/** By hand, since Node 18 has no zlib.crc32. */
function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = TABLE[(crc ^ byte) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

function chunk(type, data) {
  const body = Buffer.concat([Buffer.from(type, 'latin1'), data]);
  const out = Buffer.alloc(body.length + 8);
  out.writeUInt32BE(data.length, 0);
  body.copy(out, 4);
  out.writeUInt32BE(crc32(body), body.length + 4);
  return out;
}

export function cratePng(size = 256) {
  const rows = Buffer.alloc(size * (1 + 3 * size));
  for (let y = 0; y < size; ++y) {
    for (let x = 0; x < size; ++x) {
      const border = Math.min(x, y, size - 1 - x, size - 1 - y) < size * 0.1;
      const diagonal = Math.abs(x - y) < size * 0.07;
      const plank = Math.floor((y / size) * 6);
      const seam = (y / size) * 6 - plank < 0.06;
      const grain = 8 * Math.sin(x * 0.13 + 3 * Math.sin(y * 0.35 + plank)) + 5 * Math.sin(x * 0.031 + plank * 2.1);
      const light = (border || diagonal ? 1.08 : 0.88) * (seam && !border && !diagonal ? 0.6 : 1);
      const at = y * (1 + 3 * size) + 1 + 3 * x;
      [188, 142, 90].forEach((c, i) => { rows[at + i] = Math.max(0, Math.min(255, (c + grain) * light)); });
    }
  }
  const header = Buffer.alloc(13);
  header.writeUInt32BE(size, 0);
  header.writeUInt32BE(size, 4);
  header.set([8, 2, 0, 0, 0], 8);
  return Buffer.concat([Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]), chunk('IHDR', header), chunk('IDAT', deflateSync(rows)), chunk('IEND', Buffer.alloc(0))]);
}
