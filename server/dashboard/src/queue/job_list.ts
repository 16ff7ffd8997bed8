// The jobs of the list as they are now: pages from the service, kept true by events.
import { get } from "../api/client";
import { live } from "../api/live";
import { withProgress, type Job, type JobProgress } from "../api/types";
import { isLabel, labelFilters, labelsText } from "../base/labels";
import { Signal, type Lifetime } from "../base/signal";

export interface Filter {
  /** A state, or "" for all. */
  state: string;
  /** name=value or a name alone, several with commas between; all must fit. */
  label: string;
  /** Words that all must stand in the name, the id, the owner or a label; name=value is a label. */
  text: string;
}

export type ListState = "loading" | "shown" | "failed";

const kPage = 50;
const kPageMax = 200;
/** The service knows states and labels, not words: for those jobs are fetched and looked at, so many at one go. */
const kSearchedAtOnce = 2_000;
const kFoundEnough = 50;
const kLabelsMax = 8; // of one request
const kGatherMs = 150; // changes come in bursts: one request answers for many

export class JobList {
  /** Newest first, those that fit the filter's text. */
  readonly jobs = new Signal<readonly Job[]>([]);
  readonly state = new Signal<ListState>("loading");
  readonly more = new Signal(false);
  /** Further pages are being fetched, because too few jobs have the words that are sought. */
  readonly searching = new Signal(false);
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
    const before = JSON.stringify(this.query(0));
    this.filter = next;
    if (JSON.stringify(this.query(0)) === before) {
      this.publish();
      return void this.search();
    }
    this.known.clear();
    this.order = [];
    this.cursor = null;
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
      const rest = page.next_cursor === null ? [] : this.beyond(fresh);
      if (rest.length === 0) this.cursor = page.next_cursor;
      this.take(page.jobs, [...fresh, ...rest]);
      void this.search();
    } catch (error) {
      if (mine === this.asked && !this.lifetime.ended) this.fail(error);
    }
  }

  /** What lies beyond the window that was asked for stays as it was. */
  private beyond(fresh: readonly string[]): string[] {
    const here = new Set(fresh);
    const last = [...this.order].reverse().find((id) => here.has(id));
    return last === undefined ? [] : this.order.slice(this.order.indexOf(last) + 1);
  }

  /** The next page; of a search as many as it takes. */
  async loadMore(): Promise<void> {
    if (this.words.length > 0) return this.search(this.loaded + kSearchedAtOnce, this.jobs.value.length + kFoundEnough);
    await this.loadPage(kPage);
  }

  private async loadPage(limit: number): Promise<void> {
    const { cursor, asked } = this;
    if (cursor === null) return;
    const page = await get("/v1/jobs", { query: { ...this.query(limit), cursor } });
    if (this.lifetime.ended || asked !== this.asked) return;
    this.cursor = page.next_cursor;
    const have = new Set(this.order);
    this.take(page.jobs, [...this.order, ...page.jobs.map((job) => job.id).filter((id) => !have.has(id))]);
  }

  /** Until enough jobs have the words, all are here, or so many were looked at. */
  private async search(most = kSearchedAtOnce, enough = kFoundEnough): Promise<void> {
    if (this.searching.value || this.words.length === 0) return;
    this.searching.value = true;
    try {
      while (this.words.length > 0 && this.jobs.value.length < enough && this.loaded < most && this.cursor !== null && !this.lifetime.ended)
        await this.loadPage(kPageMax);
    } catch (error) {
      if (!this.lifetime.ended) this.fail(error);
    }
    this.searching.value = false;
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

  /** Words that the service cannot look for. */
  private get words(): string[] {
    return wordsOf(this.filter.text).filter((word) => !isLabel(word)).map((word) => word.toLowerCase());
  }

  private query(limit: number): Record<string, string | number | readonly string[]> {
    const labels = [this.filter.label, ...wordsOf(this.filter.text).filter(isLabel)].join(",");
    return { limit, state: this.filter.state, label: labelFilters(labels).filters.slice(0, kLabelsMax) };
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
    const { words } = this;
    const all = this.order.map((id) => this.known.get(id)!);
    this.jobs.value = words.length === 0 ? all : all.filter((job) => words.every((word) => textOf(job).includes(word)));
  }

  private takeProgress(progress: JobProgress): void {
    const job = this.known.get(progress.job);
    if (!job) return;
    this.known.set(job.id, withProgress(job, progress));
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
  return [job.name, job.id, job.owner, labelsText(job.labels)].join(" ").toLowerCase();
}

function wordsOf(text: string): string[] {
  return text.split(/\s+/).filter(Boolean);
}
