// Radiosity of a job by frames: half floats, fetched by ranges when they are wanted and kept while there is room.
import { npyHeader } from "./npz";
import { halfValue } from "./half_floats";
import type { FrameSource, Rgb } from "./lighting_view";

/** Fetches bytes [first, last] of a file. Rejects where it fails. */
export type FetchRange = (first: number, last: number, signal: AbortSignal) => Promise<ArrayBuffer>;

/** Bytes of frames that are kept; the least recently used go first. */
const kKeptBytes = 256 * 1024 * 1024;
/** One request fetches so much, or a frame. */
const kRequestBytes = 4 * 1024 * 1024;
const kHeaderBytes = 128;

export class HalfSource implements FrameSource {
  private readonly kept = new Map<number, Uint16Array>();
  private readonly coming = new Map<number, Promise<void>>();
  private readonly stop = new AbortController();

  private header: Promise<number> | null = null;

  /** `name` is for errors. Nothing is fetched before it is wanted. */
  constructor(
    private readonly name: string,
    private readonly fetchRange: FetchRange,
    readonly frameCount: number,
    readonly patchCount: number,
    readonly halfScale: number,
  ) {}

  cached(frame: number): Uint16Array | null {
    const values = this.kept.get(frame);
    if (!values) return null;
    this.kept.delete(frame); // to the end: the most recently used
    this.kept.set(frame, values);
    return values;
  }

  async load(frame: number): Promise<Uint16Array> {
    if (!this.kept.has(frame)) await (this.coming.get(frame) ?? this.fetchFrom(frame));
    const values = this.cached(frame);
    if (!values) throw new Error(`frame ${frame} did not come`);
    return values;
  }

  /** Fetches what is missing of the next `count` frames in the direction of time, without being asked twice. */
  prefetch(frame: number, direction: 1 | -1, count: number): void {
    for (let k = 1; k <= count; ++k) {
      const next = (frame + direction * k + this.frameCount) % this.frameCount;
      if (this.kept.has(next) || this.coming.has(next)) continue;
      this.fetchFrom(next).catch(() => undefined); // whoever needs it asks again and hears why
      return;
    }
  }

  value(patch: number, frame: number): Rgb | null {
    const values = this.cached(frame);
    if (!values) return null;
    const channel = (k: number) => halfValue(values[3 * patch + k] ?? 0) * this.halfScale;
    return [channel(0), channel(1), channel(2)];
  }

  close(): void {
    this.stop.abort();
    this.kept.clear();
  }

  private get frameBytes(): number {
    return 6 * this.patchCount;
  }

  /** Asked once; after a failure once more. */
  private headerBytes(): Promise<number> {
    this.header ??= this.fetchRange(0, kHeaderBytes - 1, this.stop.signal).then((start) => {
      const { dtype, shape, bytes } = npyHeader(new Uint8Array(start), this.name);
      if (dtype !== "<f2" || shape.join() !== [this.frameCount, this.patchCount, 3].join())
        throw new Error(`${this.name} is not the radiosity of this mesh`);
      return bytes;
    });
    this.header.catch(() => (this.header = null));
    return this.header;
  }

  /** `frame` and as many missing ones after it as go into one request. */
  private fetchFrom(frame: number): Promise<void> {
    let end = frame + 1;
    const most = Math.max(1, Math.floor(kRequestBytes / this.frameBytes));
    while (end < this.frameCount && end - frame < most && !this.kept.has(end) && !this.coming.has(end)) ++end;
    const coming = this.headerBytes()
      .then((header) =>
        this.fetchRange(header + frame * this.frameBytes, header + end * this.frameBytes - 1, this.stop.signal))
      .then((bytes) => {
        for (let f = frame; f < end; ++f)
          this.keep(f, new Uint16Array(bytes.slice((f - frame) * this.frameBytes, (f - frame + 1) * this.frameBytes)));
      })
      .finally(() => {
        for (let f = frame; f < end; ++f) this.coming.delete(f);
      });
    for (let f = frame; f < end; ++f) this.coming.set(f, coming);
    return coming;
  }

  private keep(frame: number, values: Uint16Array): void {
    this.kept.set(frame, values);
    let bytes = this.kept.size * this.frameBytes;
    for (const oldest of this.kept.keys()) {
      if (bytes <= kKeptBytes || this.kept.size <= 4) return;
      this.kept.delete(oldest);
      bytes -= this.frameBytes;
    }
  }
}
