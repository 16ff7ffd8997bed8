// Three numbers, for parts that do without three.js.
export class Vector3 {
  constructor(
    readonly x: number,
    readonly y: number,
    readonly z: number,
  ) {}

  /** The `index`-th of an array of triples. */
  static from(triples: Float32Array, index: number): Vector3 {
    return new Vector3(triples[3 * index]!, triples[3 * index + 1]!, triples[3 * index + 2]!);
  }

  minus(other: Vector3): Vector3 {
    return new Vector3(this.x - other.x, this.y - other.y, this.z - other.z);
  }

  cross(other: Vector3): Vector3 {
    return new Vector3(
      this.y * other.z - this.z * other.y, this.z * other.x - this.x * other.z, this.x * other.y - this.y * other.x);
  }

  get length(): number {
    return Math.hypot(this.x, this.y, this.z);
  }
}
