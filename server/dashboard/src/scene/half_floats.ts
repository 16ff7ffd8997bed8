// IEC 60559 binary16.

/** [bits] -> value. */
const table = new Float32Array(65536);
for (let bits = 0; bits < 65536; ++bits) {
  const exponent = (bits >> 10) & 31;
  const fraction = bits & 1023;
  const magnitude = exponent === 0 ? fraction * 2 ** -24 : (1 + fraction / 1024) * 2 ** (exponent - 15);
  table[bits] = bits & 0x8000 ? -magnitude : magnitude;
}

/** Finite values only: radiosity is never anything else. */
export function halfValue(bits: number): number {
  return table[bits] ?? 0;
}
