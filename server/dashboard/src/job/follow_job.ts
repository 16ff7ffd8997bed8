// A job as it is now, for as long as it is shown.
import { get } from "../api/client";
import { live } from "../api/live";
import { withProgress, type Job } from "../api/types";
import type { Lifetime, Signal } from "../base/signal";

/**
 * By events between fetches: progress alone is patched in, a change of state is looked up. `gone` is called when somebody
 * has deleted it. Returns what looks it up now.
 */
export function followJob(job: Signal<Job>, lifetime: Lifetime, gone: () => void): () => Promise<void> {
  const { id } = job.value;
  const look = async (): Promise<void> => {
    if (lifetime.ended) return;
    try {
      const now = await get("/v1/jobs/{id}", { path: { id } });
      if (!lifetime.ended) job.value = now;
    } catch {
      // The header says that the service is away; the next refresh looks again.
    }
  };
  const soon = (): void => void look();
  live.listen(lifetime, {
    onState: (event) => event.job === id && soon(),
    onRemoved: (removed) => removed.job === id && gone(),
    onRefresh: soon,
    onProgress: (progress) => {
      if (progress.job === id) job.value = withProgress(job.value, progress);
    },
  });
  return look;
}
