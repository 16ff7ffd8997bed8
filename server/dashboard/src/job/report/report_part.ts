// Report: where the time went, what there was of what, whether the promise was kept, the log.
import { messageOf } from "../../api/api_error";
import { fetchBytes, urlOf } from "../../api/client";
import { curlOf } from "../../api/curl";
import { bytes, duration } from "../../base/format";
import { fill, h } from "../../base/h";
import { copyCurlButton } from "../../shell/copy_curl";
import { keyFramesOf, type KeyFrames } from "../key_frames";
import type { JobContext, OpenJobPart } from "../job_part";
import { percentText } from "../timeline/track";
import "./report.css";

/** api/schemas/report.schema.json; older workers wrote less. */
interface Report {
  outcome: string;
  message: string;
  warnings: string[];
  stage_seconds: { stage: string; seconds: number }[];
  counts: { name: string; value: number }[];
  peak_memory_bytes: number;
  noise?: number | null;
  target_error?: number | null;
  target_error_met?: boolean | null;
  sandbox?: string | null;
  fingerprint?: string | null;
}

const kForecast = /^forecast_\w+_seconds$/;

export const openReport: OpenJobPart = (context) => {
  const [facts, promise, log] = [h("div"), h("div"), h("div")];
  let state = "";
  context.lifetime.add(context.job.watch((job) => {
    if (job.state === state) return;
    state = job.state;
    if (job.links.report) load(facts, fetchReport(context), reportTables);
    else fill(facts, h("p", { class: "muted" }, "The report is written when an attempt ends."));
    if (job.state === "succeeded") load(promise, keyFramesOf(context), promiseTable);
    if (job.links.log) load(log, fetchText(context), (text) => h("pre", { class: "log", tabindex: "0", "aria-label": "Log" }, text || "(empty)"));
  }));
  const path = { id: context.id };
  return h("section", { class: "report", "aria-label": "Report" }, facts, promise,
    h("section", { "aria-label": "Log" }, h("div", { class: "row" }, h("h2", null, "Log"),
      copyCurlButton(() => curlOf("GET", "/v1/jobs/{id}/log", { path }), "fetch the log")), log));
};

function load<T>(place: HTMLElement, coming: Promise<T>, show: (value: T) => Node): void {
  coming.then((value) => fill(place, show(value)), (error: unknown) => fill(place, h("p", { class: "muted" }, messageOf(error))));
}

async function fetchReport({ id }: JobContext): Promise<Report> {
  return (await (await fetchBytes(urlOf("/v1/jobs/{id}/report.json", { path: { id } }))).json()) as Report;
}

async function fetchText({ id }: JobContext): Promise<string> {
  return (await fetchBytes(urlOf("/v1/jobs/{id}/log", { path: { id } }))).text();
}

function reportTables(report: Report): Node {
  const forecast = new Map(report.counts.map(({ name, value }) => [name, value]));
  const forecastOf = (stage: string): string => {
    const seconds = forecast.get(`forecast_${stage}_seconds`);
    return seconds === undefined ? "" : duration(seconds);
  };
  const counts = report.counts.filter(({ name }) => !kForecast.test(name));
  const all = report.stage_seconds.reduce((sum, { seconds }) => sum + seconds, 0);
  return h("div", { class: "report-tables" },
    report.message ? h("p", { class: report.outcome === "succeeded" ? "" : "bad" }, report.message) : null,
    report.warnings.map((text) => h("p", { class: "warn" }, text)),
    h("section", { "aria-label": "Stages" }, h("h2", null, "Stages"), h("table", null,
      h("thead", null, h("tr", null, ["Stage", "Time", "Forecast", "Share"].map((text) => h("th", { scope: "col" }, text)))), h("tbody", null,
      report.stage_seconds.map(({ stage, seconds }) => h("tr", null, h("th", { scope: "row" }, stage), h("td", { class: "number" }, duration(seconds)),
        h("td", { class: "number muted" }, forecastOf(stage)), h("td", null, h("meter", { min: 0, max: Math.max(all, 1e-9), value: seconds, "aria-label": `${stage}: share of the time` })))),
      h("tr", null, h("th", { scope: "row" }, "all"), h("td", { class: "number" }, duration(all)), h("td"), h("td"))))),
    h("section", { "aria-label": "Figures" }, h("h2", null, "Figures"), h("table", null, h("tbody", null,
      figure("peak memory", bytes(report.peak_memory_bytes)),
      report.noise === null || report.noise === undefined ? null : figure("noise", percentText(report.noise)),
      report.target_error ? figure("target error", `${percentText(report.target_error)}, ${report.target_error_met ? "met" : "not met"}`) : null,
      report.sandbox ? figure("held by", report.sandbox) : null,
      counts.map(({ name, value }) => figure(name.replaceAll("_", " "), value.toLocaleString("en", { maximumSignificantDigits: 6 })))))));
}

function figure(name: string, value: string): HTMLElement {
  return h("tr", null, h("th", { scope: "row" }, name), h("td", { class: "number" }, value));
}

function promiseTable(keys: KeyFrames): Node {
  const promised = keys.tolerance ? `an interpolation error of at most ${percentText(keys.tolerance)}` : "nothing";
  const solved = keys.frames.filter(({ kind }) => kind !== "interpolated").length;
  return h("section", { "aria-label": "Promise" }, h("h2", null, "Promise"),
    h("p", null, `Mode ${keys.mode} promised ${promised}. ${solved} of ${keys.frames.length} frames were solved.`),
    keys.intervals.length === 0 ? null : h("div", { class: "report-scroll", tabindex: "0", role: "group", "aria-label": "Intervals" }, h("table", null,
      h("thead", null, h("tr", null, ["Frames", "Predicted", "Observed", "Kept"].map((text) => h("th", { scope: "col" }, text)))),
      h("tbody", null, keys.intervals.map(({ first, last, predicted_error, observed_error, kept }) =>
        h("tr", null, h("td", { class: "number" }, `${first} – ${last}`), h("td", { class: "number" }, percentText(predicted_error)),
          h("td", { class: "number" }, percentText(observed_error)), h("td", { class: kept === false ? "bad" : "" }, kept === true ? "yes" : kept === false ? "no" : "–")))))));
}
