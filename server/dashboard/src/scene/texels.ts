// Arrays as textures: number i is texel (i % width, i / width).
import {
  DataTexture, FloatType, HalfFloatType, NearestFilter, NoColorSpace, RedFormat, RedIntegerFormat, RGBAFormat,
  RGBAIntegerFormat, RGIntegerFormat, UnsignedByteType, UnsignedIntType,
} from "three";
import type { PixelFormat, TextureDataType } from "three";

/** Powers of two, see shaders.ts; every device that has WebGL 2 takes 2048. */
export const kTexelsShift = 10;
export const kTexelsPerRow = 1 << kTexelsShift;
/** Of half floats, three for each patch. */
export const kHalfsShift = 11;
export const kHalfsPerRow = 1 << kHalfsShift;

export function rowsFor(count: number, width: number): number {
  return Math.max(1, Math.ceil(count / width));
}

type TexelArray = Float32Array<ArrayBuffer> | Uint32Array<ArrayBuffer> | Uint16Array<ArrayBuffer> | Uint8Array<ArrayBuffer>;

function texture(data: TexelArray, width: number, height: number, format: PixelFormat, type: TextureDataType): DataTexture {
  const made = new DataTexture(data, width, height, format, type);
  made.minFilter = NearestFilter;
  made.magFilter = NearestFilter;
  made.generateMipmaps = false;
  made.colorSpace = NoColorSpace;
  made.unpackAlignment = 1;
  made.needsUpdate = true;
  return made;
}

/** `parts` numbers to a texel: 1, 2 or 4. */
export function uintTexture(values: Uint32Array, parts: 1 | 2 | 4): DataTexture {
  const height = rowsFor(values.length / parts, kTexelsPerRow);
  const data = new Uint32Array(kTexelsPerRow * height * parts);
  data.set(values);
  const format = parts === 1 ? RedIntegerFormat : parts === 2 ? RGIntegerFormat : RGBAIntegerFormat;
  return texture(data, kTexelsPerRow, height, format, UnsignedIntType);
}

/** Three numbers each and a fourth, as RGBA. */
export function rgbTexture(values: Float32Array, alpha: (i: number) => number): DataTexture {
  const count = values.length / 3;
  const data = new Float32Array(4 * kTexelsPerRow * rowsFor(count, kTexelsPerRow));
  for (let i = 0; i < count; ++i) {
    data.set(values.subarray(3 * i, 3 * i + 3), 4 * i);
    data[4 * i + 3] = alpha(i);
  }
  return texture(data, kTexelsPerRow, rowsFor(count, kTexelsPerRow), RGBAFormat, FloatType);
}

export function byteTexture(count: number): DataTexture {
  const height = rowsFor(count, kTexelsPerRow);
  return texture(new Uint8Array(kTexelsPerRow * height), kTexelsPerRow, height, RedFormat, UnsignedByteType);
}

/** Room for the (patches, 3) half floats of a frame. */
export function halfTexture(patchCount: number): DataTexture {
  const height = rowsFor(3 * patchCount, kHalfsPerRow);
  return texture(new Uint16Array(kHalfsPerRow * height), kHalfsPerRow, height, RedFormat, HalfFloatType);
}

export function fillTexture(target: DataTexture, values: Uint16Array | Uint8Array): void {
  (target.image.data as unknown as Uint16Array | Uint8Array).set(values);
  target.needsUpdate = true;
}
