// Follows /v1/events for as long as it lives: goes on from the last event after a break, polls where the service has
// no place for another listener, and comes back by itself. Runs in the shared worker, or in the page without one.
import { EventStreamParser } from "./event_stream";
import { Silence } from "./silence";
import type { JobEvent, JobGone, JobProgress } from "./types";

export type ConnectionState =
  | { how: "connecting" }
  | { how: "live" }
  /** No stream, but the service answers: pages are told to look again every few seconds. */
  | { how: "polling"; why: string }
  | { how: "offline"; sinceMs: number }
  /** A token is needed first. */
  | { how: "denied" };

export type LiveMessage =
  | { kind: "connection"; state: ConnectionState }
  | { kind: "state"; event: JobEvent }
  | { kind: "removed"; gone: JobGone }
  | { kind: "progress"; progress: JobProgress }
  /** Something may have been missed: look again. */
  | { kind: "refresh" };

const kSilenceMsMax = 40_000; // the service speaks every 15 s
const kPollMs = 4_000;
const kFailuresBeforePolling = 2;
const kDelaysMs = [300, 1_000, 2_000, 4_000, 8_000];

export class Follower {
  private last: string | null = null;
  private failures = 0;
  private state: ConnectionState = { how: "connecting" };
  private current: AbortController | null = null;
  private wake: (() => void) | null = null;
  private stopped = false;

  constructor(private readonly tell: (message: LiveMessage) => void) {}

  get connection(): ConnectionState {
    return this.state;
  }

  /** Ends when `stop` is called. */
  async run(): Promise<void> {
    while (!this.stopped) {
      await this.listen();
      if (this.stopped) return;
      if (this.state.how === "polling") this.tell({ kind: "refresh" });
      await this.pause(this.state.how === "polling" ? kPollMs : this.delayMs());
    }
  }

  /** Do not wait any longer: the network is back, or somebody has logged in. */
  retry(): void {
    this.failures = 0;
    this.wake?.();
  }

  stop(): void {
    this.stopped = true;
    this.current?.abort();
    this.wake?.();
  }

  private set(state: ConnectionState): void {
    if (state.how === this.state.how) return;
    this.state = state;
    this.tell({ kind: "connection", state });
  }

  private delayMs(): number {
    if (this.state.how === "denied") return 60_000;
    return kDelaysMs[Math.min(this.failures, kDelaysMs.length) - 1] ?? kDelaysMs[0]!;
  }

  private pause(ms: number): Promise<void> {
    return new Promise((resolve) => {
      const timer = setTimeout(resolve, ms);
      this.wake = () => {
        clearTimeout(timer);
        resolve();
      };
    });
  }

  /** One stream, until it ends. */
  private async listen(): Promise<void> {
    this.current = new AbortController();
    const silence = new Silence(this.current, kSilenceMsMax);
    try {
      const headers: Record<string, string> = { Accept: "text/event-stream" };
      if (this.last !== null) headers["Last-Event-ID"] = this.last;
      const response = await fetch("/v1/events", { headers, signal: this.current.signal, cache: "no-store", credentials: "same-origin" });
      if (response.ok && response.body) {
        this.failures = 0;
        this.set({ how: "live" });
        this.tell({ kind: "refresh" });
        await this.read(response.body, silence);
        ++this.failures;
      } else {
        await this.refused(response);
      }
    } catch {
      ++this.failures;
    }
    silence.end();
    if (this.failures >= kFailuresBeforePolling && this.state.how !== "denied") await this.lookWhetherThere();
  }

  private async read(body: ReadableStream<Uint8Array>, silence: Silence): Promise<void> {
    const parser = new EventStreamParser();
    const decoder = new TextDecoder();
    const reader = body.getReader();
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return;
      silence.broken();
      for (const event of parser.take(decoder.decode(value, { stream: true }))) {
        if (event.id !== null) this.last = event.id;
        if (event.type === "state") this.tell({ kind: "state", event: JSON.parse(event.data) as JobEvent });
        if (event.type === "removed") this.tell({ kind: "removed", gone: JSON.parse(event.data) as JobGone });
        if (event.type === "progress") this.tell({ kind: "progress", progress: JSON.parse(event.data) as JobProgress });
      }
    }
  }

  private async refused(response: Response): Promise<void> {
    ++this.failures;
    if (response.status === 401) return this.set({ how: "denied" });
    if (response.status === 400) this.last = null; // an id from another data folder
    if (this.state.how === "denied") this.set({ how: "connecting" });
  }

  private async lookWhetherThere(): Promise<void> {
    try {
      const response = await fetch("/healthz", { cache: "no-store", signal: AbortSignal.timeout(5_000) });
      if (!response.ok) throw new Error(String(response.status));
      this.set({ how: "polling", why: "the service has no place for another listener, or a proxy stops the stream" });
    } catch {
      if (this.state.how !== "offline") this.set({ how: "offline", sinceMs: Date.now() });
    }
  }
}
