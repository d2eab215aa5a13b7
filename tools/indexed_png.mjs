// PNG with a palette, for screenshots of grass: a third of the size of one in full colour. Median cut, without dithering, which costs more than it shows.
import { writeFileSync } from "node:fs";
import { deflateSync } from "node:zlib";

/** @param rgba  pixels, row by row, of which the opacity is ignored  @return the file */
export function indexedPng(width, height, rgba, colours = 256) {
  // Pixels by colour, to five bits a channel.
  const counts = new Map();
  const keyAt = (i) => rgba[i] >> 3 << 10 | rgba[i + 1] >> 3 << 5 | rgba[i + 2] >> 3;
  for (let i = 0; i < rgba.length; i += 4) {
    const key = keyAt(i), bin = counts.get(key) ?? { key, sum: [0, 0, 0], count: 0 };
    for (let c = 0; c < 3; c++) bin.sum[c] += rgba[i + c];
    bin.count++;
    counts.set(key, bin);
  }
  const mean = (bin, c) => bin.sum[c] / bin.count;
  // The box with the greatest spread is cut at the median of its longest side. Few pixels count much: thin lines keep their colours.
  const measured = (bins) => {
    let axis = 0, longest = -1;
    for (let c = 0; c < 3; c++) {
      const values = bins.map((bin) => mean(bin, c)), side = Math.max(...values) - Math.min(...values);
      if (side > longest) [axis, longest] = [c, side];
    }
    return { bins, axis, spread: longest * bins.reduce((sum, bin) => sum + bin.count, 0) ** 0.25 };
  };
  const boxes = [measured([...counts.values()])];
  while (boxes.length < colours) {
    const widest = boxes.reduce((best, box, i) => (box.bins.length > 1 && box.spread > (boxes[best]?.spread ?? -1) ? i : best), -1);
    if (widest < 0) break;
    const [{ bins, axis }] = boxes.splice(widest, 1);
    bins.sort((a, b) => mean(a, axis) - mean(b, axis));
    const half = bins.reduce((sum, bin) => sum + bin.count, 0) / 2;
    let at = 0;
    for (let sum = 0; at < bins.length - 1 && sum < half; at++) sum += bins[at].count;
    at = Math.max(1, Math.min(at, bins.length - 1));
    boxes.push(measured(bins.slice(0, at)), measured(bins.slice(at)));
  }
  const palette = Buffer.alloc(3 * boxes.length), indices = new Map();
  boxes.forEach(({ bins }, i) => {
    const count = bins.reduce((sum, bin) => sum + bin.count, 0);
    for (let c = 0; c < 3; c++) palette[3 * i + c] = Math.round(bins.reduce((sum, bin) => sum + bin.sum[c], 0) / count);
    for (const { key } of bins) indices.set(key, i);
  });
  const rows = Buffer.alloc(height * (width + 1));
  for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) rows[y * (width + 1) + 1 + x] = indices.get(keyAt(4 * (y * width + x)));
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.set([8, 3, 0, 0, 0], 8);
  return Buffer.concat([Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), chunk("IHDR", header), chunk("PLTE", palette), chunk("IDAT", deflateSync(rows, { level: 9 })), chunk("IEND", Buffer.alloc(0))]);
}

function chunk(type, data) {
  const out = Buffer.alloc(data.length + 12);
  out.writeUInt32BE(data.length, 0);
  out.write(type, 4, "latin1");
  data.copy(out, 8);
  let crc = -1;
  for (const byte of out.subarray(4, data.length + 8)) {
    crc ^= byte;
    for (let k = 0; k < 8; k++) crc = crc >>> 1 ^ (crc & 1 ? 0xedb88320 : 0);
  }
  out.writeUInt32BE(~crc >>> 0, data.length + 8);
  return out;
}

/** Writes what a page of Playwright shows, with a palette. */
export async function saveScreenshot(page, file, colours) {
  const taken = (await page.screenshot()).toString("base64");
  const { width, height, pixels } = await page.evaluate(async (data) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: "image/png" }));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    const image = context.getImageData(0, 0, bitmap.width, bitmap.height);
    let text = "";
    for (let i = 0; i < image.data.length; i += 4096) text += String.fromCharCode(...image.data.subarray(i, i + 4096));
    return { width: bitmap.width, height: bitmap.height, pixels: btoa(text) };
  }, taken);
  writeFileSync(file, indexedPng(width, height, Buffer.from(pixels, "base64"), colours));
}
