// The service itself: what the workers take, room on the disk, limits, versions, health. Looks again by itself.
import { messageOf } from "../api/api_error";
import { get } from "../api/client";
import { curlOf } from "../api/curl";
import { live } from "../api/live";
import type { JobState } from "../api/types";
import { kJobStates } from "../api/types";
import { bytes, count, moment } from "../base/format";
import { append, fill, h } from "../base/h";
import { queueNow } from "../queue/queue_state";
import { stateWords } from "../queue/state_badge";
import { copyCurlButton } from "../shell/copy_curl";
import type { OpenPage } from "../shell/page";
import { card, facts, meter, type Fact } from "./cards";
import { fetchReadiness, fetchSamples, sampleOf, type Sample } from "./health";
import "./system.css";

const kEveryMs = 5_000;

export const openSystemPage: OpenPage = ({ lifetime, setTitle }) => {
  setTitle("System");
  const { queue } = queueNow(lifetime);
  const queueCard = card("Queue", curlOf("GET", "/v1/queue"));
  const workersCard = card("Workers", curlOf("GET", "/v1/queue"));
  const healthCard = card("Health", curlOf("GET", "/readyz"));
  const serviceCard = card("Disk and connections", curlOf("GET", "/metrics"));
  const limitsCard = card("Limits", curlOf("GET", "/v1/limits"));
  const versionCard = card("Version", curlOf("GET", "/version"));

  lifetime.add(queue.watch((now) => {
    if (!now) return;
    fill(queueCard.body,
      now.paused ? h("p", { class: "warn" }, `Paused${now.changed_at ? ` since ${moment(now.changed_at)}` : ""}${now.reason ? `: ${now.reason}` : ""}`) : null,
      facts(kJobStates.map((state): Fact => [stateWords[state as JobState], h("a", { href: `/?state=${state}` }, String(now.jobs[state] ?? 0))])));
    const { running, cores, cores_max, memory_bytes, memory_bytes_max } = now.workers;
    fill(workersCard.body, facts([["Running", count(running, "worker")]]),
      meter("Cores", cores, cores_max, `${cores} of ${cores_max}`),
      memory_bytes_max === null ? facts([["Memory, as forecast", bytes(memory_bytes)]])
        : meter("Memory, as forecast", memory_bytes, memory_bytes_max, `${bytes(memory_bytes)} of ${bytes(memory_bytes_max)}`));
  }));

  const look = (): void => {
    if (document.hidden || lifetime.ended) return;
    void fetchReadiness().then(({ ready, checks }) => fill(healthCard.body,
      h("p", { class: ready ? "good" : "bad" }, ready ? "Ready: jobs are taken and rendered." : "Not ready."),
      facts(Object.entries(checks).map(([name, what]): Fact => [name, h("span", { class: what === "ok" ? "" : "bad" }, what)]))),
    (error: unknown) => fill(healthCard.body, h("p", { class: "bad" }, messageOf(error))));
    void fetchSamples().then((samples) => fill(serviceCard.body, samples === null
      ? h("p", { class: "muted" }, "The token has not the scope metrics:read, so these are not shown.") : facts(serviceFacts(samples))),
    (error: unknown) => fill(serviceCard.body, h("p", { class: "bad" }, messageOf(error))));
  };
  const once = (): void => {
    void get("/v1/limits").then((limits) => fill(limitsCard.body, facts(Object.entries(limits).map(([name, value]): Fact => [wordsOf(name), valueOf(name, value as number | null)]))), () => {});
    void get("/version").then((version) => fill(versionCard.body, facts([["Keylume", version.version], ["Workers are held by", version.worker_sandbox]])), () => {});
    look();
  };
  once();
  const timer = setInterval(look, kEveryMs);
  lifetime.add(() => clearInterval(timer));
  live.listen(lifetime, { onRefresh: once });

  const page = h("div", { class: "cards" });
  append(page, [queueCard, workersCard, healthCard, serviceCard, limitsCard, versionCard].map(({ element }) => element));
  return h("div", null, page, h("p", { class: "muted small" }, "Numbers for Prometheus are at ", h("a", { href: "/metrics" }, "/metrics"), ", the interface is described at ",
    h("a", { href: "/docs" }, "/docs"), " ", copyCurlButton(() => curlOf("GET", "/openapi.json"), "the description of the interface")));
};

function serviceFacts(samples: readonly Sample[]): Fact[] {
  const known: [string, string, (value: number) => string][] = [
    ["Free on the disk", "keylume_disk_free_bytes", bytes],
    ["Database's log", "keylume_sqlite_wal_bytes", bytes],
    ["Listeners to events", "keylume_sse_clients", String],
    ["Uploads coming in", "keylume_uploads_in_flight", String],
    ["Removed after their time", "keylume_gc_removed_jobs_total", (value) => count(value, "job")],
    ["Bytes freed so", "keylume_gc_removed_bytes_total", bytes],
  ];
  return known.flatMap(([label, name, write]): Fact[] => {
    const value = sampleOf(samples, name);
    return value === null || value < 0 ? [] : [[label, write(value)]];
  });
}

const kLimitWords: Readonly<Record<string, string>> = {
  upload_bytes_max: "Upload of one job",
  animation_bytes_max: "animation.json",
  materials_max: "MTL files of a job",
  textures_max: "Textures of a job",
  uploads_at_once_max: "Uploads at once, of all clients",
  small_body_bytes_max: "Body of other requests",
  json_depth_max: "Brackets open in JSON",
  json_values_max: "Values in JSON",
  frames_max: "Frames of a job",
  labels_max: "Labels of a job",
  batch_max: "Jobs in one batch",
  listeners_max: "Listeners to events, of all clients",
  requests_per_second_max: "Requests per second",
  requests_at_once_max: "Requests in a burst",
};

function wordsOf(name: string): string {
  const known = kLimitWords[name];
  if (known !== undefined) return known;
  const words = name.replace(/_max$/, "").replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

function valueOf(name: string, value: number | null): string {
  if (value === null) return "no limit";
  return name.includes("bytes") ? bytes(value) : value.toLocaleString("en");
}
