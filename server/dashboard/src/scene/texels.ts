// Arrays as textures: number i is texel (i % width, i / width).
import {
  DataTexture, FloatType, HalfFloatType, NearestFilter, NoColorSpace, RedFormat, RGBAFormat, RGBAIntegerFormat, RGBFormat,
  RGIntegerFormat, UnsignedByteType, UnsignedIntType,
} from "three";
import type { PixelFormat, TextureDataType } from "three";

/** Powers of two, see shaders.ts; every device that has WebGL 2 takes 2048. */
export const kTexelsShift = 10;
export const kTexelsPerRow = 1 << kTexelsShift;

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

/** `parts` numbers to a texel: 2 or 4. */
export function uintTexture(values: Uint32Array, parts: 2 | 4): DataTexture {
  const height = rowsFor(values.length / parts, kTexelsPerRow);
  const data = new Uint32Array(kTexelsPerRow * height * parts);
  data.set(values);
  return texture(data, kTexelsPerRow, height, parts === 2 ? RGIntegerFormat : RGBAIntegerFormat, UnsignedIntType);
}

/** Four numbers to a texel. */
export function floatTexture(values: Float32Array): DataTexture {
  const height = rowsFor(values.length / 4, kTexelsPerRow);
  const data = new Float32Array(kTexelsPerRow * height * 4);
  data.set(values);
  return texture(data, kTexelsPerRow, height, RGBAFormat, FloatType);
}

/** Three numbers each and a fourth. */
export function rgbTexture(values: Float32Array, alpha: (i: number) => number): DataTexture {
  const count = values.length / 3;
  const data = new Float32Array(4 * count);
  for (let i = 0; i < count; ++i) {
    data.set(values.subarray(3 * i, 3 * i + 3), 4 * i);
    data[4 * i + 3] = alpha(i);
  }
  return floatTexture(data);
}

export function byteTexture(count: number): DataTexture {
  const height = rowsFor(count, kTexelsPerRow);
  return texture(new Uint8Array(kTexelsPerRow * height), kTexelsPerRow, height, RedFormat, UnsignedByteType);
}

/** Room for the (patches, 3) half floats of a frame. */
export function halfTexture(patchCount: number): DataTexture {
  const height = rowsFor(patchCount, kTexelsPerRow);
  const made = texture(new Uint16Array(3 * kTexelsPerRow * height), kTexelsPerRow, height, RGBFormat, HalfFloatType);
  made.internalFormat = "RGB16F"; // three.js chooses none for three halves
  return made;
}

export function fillTexture(target: DataTexture, values: Uint16Array | Uint8Array): void {
  (target.image.data as unknown as Uint16Array | Uint8Array).set(values);
  target.needsUpdate = true;
}
