// Pictures as numbers: PNG files of 8 bits per channel, RGB or RGBA, not interlaced (ISO/IEC 15948).
import assert from "node:assert/strict";
import { inflateSync } from "node:zlib";

function paeth(a, b, c) {
  const [pa, pb, pc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

const undo = [() => 0, (a) => a, (a, b) => b, (a, b) => (a + b) >> 1, paeth];

/** -> { width, height, rgb: Uint8Array } */
export function decodePng(bytes) {
  assert.equal(bytes.toString("latin1", 1, 4), "PNG");
  const packed = [];
  let [width, height, channels] = [0, 0, 3];
  for (let at = 8; at < bytes.length;) {
    const length = bytes.readUInt32BE(at);
    const kind = bytes.toString("latin1", at + 4, at + 8);
    const body = bytes.subarray(at + 8, at + 8 + length);
    if (kind === "IHDR") {
      [width, height] = [body.readUInt32BE(0), body.readUInt32BE(4)];
      assert.ok(body[8] === 8 && (body[9] === 2 || body[9] === 6) && body[12] === 0, "8 bits, RGB or RGBA, not interlaced");
      channels = body[9] === 2 ? 3 : 4;
    }
    if (kind === "IDAT") packed.push(body);
    at += 12 + length;
  }
  return { width, height, rgb: withoutAlpha(unfiltered(inflateSync(Buffer.concat(packed)), width, height, channels), channels) };
}

function unfiltered(rows, width, height, channels) {
  const stride = width * channels;
  const out = new Uint8Array(stride * height);
  for (let y = 0; y < height; ++y) {
    const filter = undo[rows[y * (stride + 1)]];
    for (let x = 0; x < stride; ++x) {
      const left = x >= channels ? out[y * stride + x - channels] : 0;
      const above = y > 0 ? out[(y - 1) * stride + x] : 0;
      const corner = x >= channels && y > 0 ? out[(y - 1) * stride + x - channels] : 0;
      out[y * stride + x] = rows[y * (stride + 1) + 1 + x] + filter(left, above, corner);
    }
  }
  return out;
}

function withoutAlpha(values, channels) {
  return channels === 3 ? values : values.filter((_, k) => k % 4 !== 3);
}

/** Of the absolute difference of all channels, as shares of full scale. */
export function difference(a, b) {
  assert.deepEqual([a.width, a.height], [b.width, b.height]);
  const each = Float64Array.from(a.rgb, (value, k) => Math.abs(value - b.rgb[k]) / 255);
  const sorted = each.slice().sort();
  return { mean: each.reduce((sum, d) => sum + d, 0) / each.length, percentile99: sorted[Math.floor(0.99 * (sorted.length - 1))], largest: sorted.at(-1) };
}

/** Mean of all channels, 0 .. 1. */
export function brightness({ rgb }) {
  return rgb.reduce((sum, value) => sum + value, 0) / rgb.length / 255;
}
