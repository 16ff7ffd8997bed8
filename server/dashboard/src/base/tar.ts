// Files out of a tar (POSIX.1-2001: ustar headers, pax records of long names) as it comes, so that one may stop early.

const kBlock = 512;

export interface TarFile {
  readonly path: string;
  readonly bytes: Uint8Array<ArrayBuffer>;
}

/** Hands over bytes in the portions that are asked for. */
class Pieces {
  private held: Uint8Array<ArrayBuffer> = new Uint8Array(0);

  constructor(private readonly reader: ReadableStreamDefaultReader<Uint8Array<ArrayBuffer>>) {}

  /** Null: there are not so many left. */
  async take(count: number): Promise<Uint8Array<ArrayBuffer> | null> {
    const parts = [this.held];
    let have = this.held.length;
    while (have < count) {
      const { value, done } = await this.reader.read();
      if (done) return null;
      parts.push(value);
      have += value.length;
    }
    const all = new Uint8Array(have);
    let at = 0;
    for (const part of parts) {
      all.set(part, at);
      at += part.length;
    }
    this.held = all.slice(count);
    return all.subarray(0, count);
  }
}

function textAt(block: Uint8Array, at: number, size: number): string {
  const field = block.subarray(at, at + size);
  const end = field.indexOf(0);
  return new TextDecoder().decode(end < 0 ? field : field.subarray(0, end));
}

/** Of a pax header: "27 path=...\n". */
function paxPath(records: Uint8Array): string | null {
  return /(?:^|\n)\d+ path=([^\n]*)\n/.exec(new TextDecoder().decode(records))?.[1] ?? null;
}

/** The files one after the other, until the caller stops or the tar ends. Errors: Error where it ends too early. */
export async function* filesInTar(body: ReadableStream<Uint8Array<ArrayBuffer>>): AsyncGenerator<TarFile> {
  const reader = body.getReader();
  const pieces = new Pieces(reader);
  let longPath: string | null = null;
  try {
    for (;;) {
      const header = await pieces.take(kBlock);
      if (header === null || header[0] === 0) return;
      const size = parseInt(textAt(header, 124, 12), 8);
      const padded = await pieces.take(Math.ceil(size / kBlock) * kBlock);
      if (padded === null) throw new Error("the archive ended early");
      const bytes = padded.slice(0, size);
      if (textAt(header, 156, 1) === "x") {
        longPath = paxPath(bytes);
        continue;
      }
      yield { path: longPath ?? textAt(header, 0, 100), bytes };
      longPath = null;
    }
  } finally {
    // What comes after the last file that was wanted need not be sent.
    await reader.cancel().catch(() => {});
  }
}
