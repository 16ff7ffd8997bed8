// What happens to jobs, as it happens: one stream per browser, shared by its tabs.
import { Signal, type Lifetime } from "../base/signal";
import { workerUrl } from "../base/workers";
import { access } from "./client";
import { Follower, type ConnectionState, type LiveMessage } from "./follower";
import type { JobEvent, JobGone, JobProgress } from "./types";

export type { ConnectionState } from "./follower";

export interface LiveListener {
  /** A job has changed its state (and maybe more: fetch it for the rest). */
  onState?(event: JobEvent): void;
  /** A job is gone, by whoever removed it. */
  onRemoved?(gone: JobGone): void;
  onProgress?(progress: JobProgress): void;
  /** Something may have been missed, or there is no stream and this is the time to poll: fetch again. */
  onRefresh?(): void;
}

export class Live {
  readonly connection = new Signal<ConnectionState>({ how: "connecting" });
  private readonly listeners = new Set<LiveListener>();
  private retryNow: () => void = () => {};

  start(): void {
    try {
      this.startShared();
    } catch {
      this.startOwn();
    }
    window.addEventListener("online", () => this.retryNow());
  }

  /** Until the lifetime ends. Does not call at once: fetch first, then keep it true by this. */
  listen(lifetime: Lifetime, listener: LiveListener): void {
    this.listeners.add(listener);
    lifetime.add(() => void this.listeners.delete(listener));
  }

  /** Do not wait for the next try. */
  retry(): void {
    this.retryNow();
  }

  private startShared(): void {
    if (!("SharedWorker" in window)) throw new Error("no shared workers here");
    const worker = new SharedWorker(workerUrl("live"), { name: "keylume-live" });
    worker.onerror = () => this.startOwn();
    worker.port.onmessage = ({ data }) => this.take(data as LiveMessage);
    worker.port.start();
    window.addEventListener("pagehide", () => worker.port.postMessage("bye"));
    // Back from the browser's memory of pages: be heard again.
    window.addEventListener("pageshow", (event) => event.persisted && location.reload());
    this.retryNow = () => worker.port.postMessage("retry");
  }

  private startOwn(): void {
    const follower = new Follower((message) => this.take(message));
    this.retryNow = () => follower.retry();
    void follower.run();
  }

  private take(message: LiveMessage): void {
    if (message.kind === "connection") {
      this.connection.value = message.state;
      if (message.state.how === "denied") access.value = "denied";
      return;
    }
    for (const listener of [...this.listeners]) {
      if (message.kind === "state") listener.onState?.(message.event);
      else if (message.kind === "removed") listener.onRemoved?.(message.gone);
      else if (message.kind === "progress") listener.onProgress?.(message.progress);
      else listener.onRefresh?.();
    }
  }
}

/** The one of this tab; the shell starts it. */
export const live = new Live();
