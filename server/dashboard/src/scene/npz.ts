// Reads .npz archives as the engine writes them: stored (not deflated), little-endian, C order. Arrays are views into
// the archive's buffer where they are aligned, so nothing is copied that need not be.
// Formats: PKWARE APPNOTE 6.3.10, sections 4.3.7 and 4.3.12; NumPy's "npy" format, versions 1 and 2.

export type Values = Float32Array | Float64Array | Uint32Array | Uint16Array | Uint8Array;

export interface NpyArray {
  readonly dtype: string;
  readonly shape: readonly number[];
  readonly bytes: Uint8Array;
}

export class NpzError extends Error {}

const kEndOfDirectory = 0x06054b50;
const kDirectoryEntry = 0x02014b50;
const kLocalHeader = 0x04034b50;

export class Npz {
  private readonly arrays = new Map<string, NpyArray>();

  /** Throws NpzError where it is no such archive. */
  constructor(buffer: ArrayBuffer) {
    const view = new DataView(buffer);
    let at = endOfDirectory(view);
    const count = view.getUint16(at + 10, true);
    at = view.getUint32(at + 16, true);
    for (let entry = 0; entry < count; ++entry) {
      if (view.getUint32(at, true) !== kDirectoryEntry) throw new NpzError("the archive's directory is damaged");
      if (view.getUint16(at + 10, true) !== 0) throw new NpzError("the archive is compressed");
      const size = view.getUint32(at + 24, true);
      const nameLength = view.getUint16(at + 28, true);
      const next = at + 46 + nameLength + view.getUint16(at + 30, true) + view.getUint16(at + 32, true);
      const name = new TextDecoder().decode(new Uint8Array(buffer, at + 46, nameLength));
      const local = view.getUint32(at + 42, true);
      if (view.getUint32(local, true) !== kLocalHeader) throw new NpzError(`${name} is not where it should be`);
      const first = local + 30 + view.getUint16(local + 26, true) + view.getUint16(local + 28, true);
      this.arrays.set(name.replace(/\.npy$/, ""), parseNpy(new Uint8Array(buffer, first, size), name));
      at = next;
    }
  }

  has(name: string): boolean {
    return this.arrays.has(name);
  }

  array(name: string): NpyArray {
    const found = this.arrays.get(name);
    if (!found) throw new NpzError(`the archive has no array ${name}`);
    return found;
  }

  shape(name: string): readonly number[] {
    return this.array(name).shape;
  }

  f32(name: string): Float32Array {
    return this.typed(name, "<f4", Float32Array);
  }
  f64(name: string): Float64Array {
    return this.typed(name, "<f8", Float64Array);
  }
  u32(name: string): Uint32Array {
    return this.typed(name, "<u4", Uint32Array);
  }
  u8(name: string): Uint8Array {
    return this.typed(name, "|u1", Uint8Array);
  }

  /** Fixed-width unicode ("<U12"), padded with zeros. */
  strings(name: string): string[] {
    const { dtype, bytes, shape } = this.array(name);
    if (!dtype.startsWith("<U")) throw new NpzError(`${name} is no text`);
    const width = Number(dtype.slice(2));
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    return Array.from({ length: shape[0] ?? 0 }, (_, row) => {
      let text = "";
      for (let k = 0; k < width; ++k) {
        const point = view.getUint32(4 * (row * width + k), true);
        if (point !== 0) text += String.fromCodePoint(point);
      }
      return text;
    });
  }

  private typed<T extends Values>(
    name: string,
    dtype: string,
    Type: { new (buffer: ArrayBuffer, at: number, length: number): T; BYTES_PER_ELEMENT: number },
  ): T {
    const array = this.array(name);
    if (array.dtype !== dtype) throw new NpzError(`${name} is ${array.dtype}, not ${dtype}`);
    const size = Type.BYTES_PER_ELEMENT;
    const { buffer, byteOffset, byteLength } =
      array.bytes.byteOffset % size === 0 ? array.bytes : array.bytes.slice();
    return new Type(buffer as ArrayBuffer, byteOffset, byteLength / size);
  }
}

function endOfDirectory(view: DataView): number {
  const least = Math.max(0, view.byteLength - 22 - 65535);
  for (let at = view.byteLength - 22; at >= least; --at)
    if (view.getUint32(at, true) === kEndOfDirectory) return at;
  throw new NpzError("this is no .npz archive");
}

/** `file` names it in errors. */
export function parseNpy(bytes: Uint8Array, file: string): NpyArray {
  const magic = String.fromCharCode(...bytes.subarray(1, 6));
  if (bytes[0] !== 0x93 || magic !== "NUMPY") throw new NpzError(`${file} is no .npy file`);
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const version = bytes[6] ?? 0;
  const headerAt = version === 1 ? 10 : 12;
  const length = version === 1 ? view.getUint16(8, true) : view.getUint32(8, true);
  const header = new TextDecoder().decode(bytes.subarray(headerAt, headerAt + length));
  const dtype = /'descr': *'([^']+)'/.exec(header)?.[1];
  const shape = /'shape': *\(([^)]*)\)/.exec(header)?.[1];
  if (!dtype || shape === undefined || !/'fortran_order': *False/.test(header))
    throw new NpzError(`${file} has a header that is not understood`);
  const sizes = shape.split(",").map((s) => s.trim()).filter((s) => s !== "").map(Number);
  return { dtype, shape: sizes, bytes: bytes.subarray(headerAt + length) };
}

/** How long a .npy file's header is, from its first bytes (64 are enough for ours), and its shape. */
export function npyHeader(start: Uint8Array, file: string): { bytes: number; shape: readonly number[]; dtype: string } {
  const { dtype, shape, bytes } = parseNpy(start, file);
  return { bytes: bytes.byteOffset - start.byteOffset, shape, dtype };
}
