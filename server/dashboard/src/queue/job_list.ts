// The jobs of the list as they are now: pages from the service, kept true by events.
import { get } from "../api/client";
import { live } from "../api/live";
import type { Job, JobProgress } from "../api/types";
import { Signal, type Lifetime } from "../base/signal";

export interface Filter {
  /** A state, or "" for all. */
  state: string;
  /** NAME or NAME:VALUE, or "". */
  label: string;
  /** Words that all must stand in the name, the id, the owner or a label. */
  text: string;
}

export type ListState = "loading" | "shown" | "failed";

const kPage = 50;
const kPageMax = 200;
const kGatherMs = 150; // changes come in bursts: one request answers for many

export class JobList {
  /** Newest first, those that fit the filter's text. */
  readonly jobs = new Signal<readonly Job[]>([]);
  readonly state = new Signal<ListState>("loading");
  readonly more = new Signal(false);
  /** Of the last request that failed. */
  error: unknown = null;
  private readonly known = new Map<string, Job>();
  private order: string[] = [];
  private cursor: string | null = null;
  private changed = new Set<string>();
  private timer: ReturnType<typeof setTimeout> | undefined;
  private asked = 0;

  constructor(
    private filter: Filter,
    private readonly lifetime: Lifetime,
  ) {
    live.listen(lifetime, {
      onState: (event) => this.later(event.job),
      onRemoved: (gone) => this.remove([gone.job]),
      onProgress: (progress) => this.takeProgress(progress),
      onRefresh: () => this.later(null),
    });
    lifetime.add(() => clearTimeout(this.timer));
    void this.reload();
  }

  /** Jobs that are here, also those that the text hides. */
  get loaded(): number {
    return this.order.length;
  }

  job(id: string): Job | undefined {
    return this.known.get(id);
  }

  setFilter(next: Filter): void {
    const other = next.state !== this.filter.state || next.label !== this.filter.label;
    this.filter = next;
    if (!other) return this.publish();
    this.known.clear();
    this.order = [];
    this.state.value = "loading";
    void this.reload();
  }

  /** The newest jobs again, as many as are shown. */
  async reload(): Promise<void> {
    const mine = ++this.asked;
    const limit = Math.min(Math.max(Math.ceil(this.order.length / kPage) * kPage, kPage), kPageMax);
    try {
      const page = await get("/v1/jobs", { query: this.query(limit) });
      if (mine !== this.asked || this.lifetime.ended) return;
      const fresh = page.jobs.map((job) => job.id);
      // What lies beyond the window asked for stays as it was.
      const rest = page.next_cursor === null ? [] : this.order.slice(limit).filter((id) => !fresh.includes(id));
      if (rest.length === 0) this.cursor = page.next_cursor;
      this.take(page.jobs, [...fresh, ...rest]);
    } catch (error) {
      if (mine === this.asked && !this.lifetime.ended) this.fail(error);
    }
  }

  async loadMore(): Promise<void> {
    if (this.cursor === null) return;
    const page = await get("/v1/jobs", { query: { ...this.query(kPage), cursor: this.cursor } });
    if (this.lifetime.ended) return;
    this.cursor = page.next_cursor;
    const have = new Set(this.order);
    this.take(page.jobs, [...this.order, ...page.jobs.map((job) => job.id).filter((id) => !have.has(id))]);
  }

  /** A job as an action has answered it. */
  put(job: Job): void {
    if (!this.known.has(job.id)) return this.later(null);
    this.known.set(job.id, job);
    this.publish();
  }

  remove(ids: readonly string[]): void {
    for (const id of ids) this.known.delete(id);
    this.order = this.order.filter((id) => this.known.has(id));
    this.publish();
  }

  private query(limit: number): Record<string, string | number> {
    return { limit, state: this.filter.state, label: this.filter.label };
  }

  private take(jobs: readonly Job[], order: string[]): void {
    const keep = new Set(order);
    for (const id of [...this.known.keys()]) if (!keep.has(id)) this.known.delete(id);
    for (const job of jobs) this.known.set(job.id, job);
    this.order = order.filter((id) => this.known.has(id));
    this.error = null;
    this.state.value = "shown";
    this.more.value = this.cursor !== null;
    this.publish();
  }

  private fail(error: unknown): void {
    this.error = error;
    // What is shown already is better than a message; the header says that the service is away.
    if (this.order.length === 0) this.state.value = "failed";
  }

  private publish(): void {
    const words = this.filter.text.toLowerCase().split(/\s+/).filter(Boolean);
    const all = this.order.map((id) => this.known.get(id)!);
    this.jobs.value = words.length === 0 ? all : all.filter((job) => words.every((word) => textOf(job).includes(word)));
  }

  private takeProgress(progress: JobProgress): void {
    const job = this.known.get(progress.job);
    if (!job) return;
    const { stage, stage_fraction, fraction, seconds_left } = progress;
    this.known.set(job.id, { ...job, attempt: progress.attempt, progress: { stage: stage as Job["progress"]["stage"], stage_fraction, fraction, seconds_left } });
    this.publish();
  }

  /** Looks up what has changed, soon; null: everything. */
  private later(id: string | null): void {
    this.changed.add(id ?? "");
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      const ids = [...this.changed];
      this.changed = new Set();
      void this.lookUp(ids);
    }, kGatherMs);
  }

  private async lookUp(ids: readonly string[]): Promise<void> {
    // A state that somebody filters by, a place in the queue, a new job: the list knows, a single job does not.
    const one = ids.length === 1 ? this.known.get(ids[0]!) : undefined;
    if (!one || this.filter.state !== "" || this.queuedOthers(one.id)) return this.reload();
    try {
      this.put(await get("/v1/jobs/{id}", { path: { id: one.id } }));
    } catch {
      await this.reload();
    }
  }

  private queuedOthers(id: string): boolean {
    return [...this.known.values()].some((job) => job.id !== id && job.state === "queued");
  }
}

function textOf(job: Job): string {
  const labels = Object.entries(job.labels).map(([name, value]) => `${name}:${value}`);
  return [job.name, job.id, job.owner, ...labels].join(" ").toLowerCase();
}
