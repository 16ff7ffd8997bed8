// The parts of the shell that need no browser.
import assert from "node:assert/strict";
import { test } from "node:test";
import { ApiError, errorOf, placeOf } from "dashboard/api/api_error";
import { urlOf } from "dashboard/api/client";
import { curlOf } from "dashboard/api/curl";
import { EventStreamParser } from "dashboard/api/event_stream";
import { ago, bytes, count, duration, percent } from "dashboard/base/format";
import { Lifetime, Signal } from "dashboard/base/signal";
import { widthsOf } from "dashboard/queue/progress_bar";
import { Selection } from "dashboard/queue/selection";
import { match } from "dashboard/shell/router";
import { parseSamples, sampleOf } from "dashboard/system/health";

const kStream = 'retry: 3000\n\nid: 17\nevent: state\ndata: {"job":"a"}\n\n: ping\n\nevent: progress\r\ndata: 1\r\ndata: 2\r\n\r\ndata: cut';

test("an event stream is read the same wherever it is cut", () => {
  const whole = new EventStreamParser().take(kStream);
  assert.deepEqual(whole, [
    { id: "17", type: "state", data: '{"job":"a"}' },
    { id: null, type: "progress", data: "1\n2" },
  ]);
  for (let cut = 0; cut <= kStream.length; ++cut) {
    const parser = new EventStreamParser();
    assert.deepEqual([...parser.take(kStream.slice(0, cut)), ...parser.take(kStream.slice(cut))], whole, `cut at ${cut}`);
  }
});

test("what the progress bar fills is the fraction of the job", () => {
  for (const [stage, stage_fraction, fraction] of [["solve", 0.25, 0.6], ["scene", 1, 0.001], ["publish", 0.5, 0.999], ["estimate", 0, 0.02]] as const) {
    const widths = widthsOf({ stage, stage_fraction, fraction });
    const filled = widths.reduce((sum, width) => sum + width.filled, 0);
    const all = widths.reduce((sum, width) => sum + width.filled + width.empty, 0);
    assert.ok(Math.abs(filled - fraction) < 1e-9, `${stage}: ${filled}`);
    assert.ok(Math.abs(all - 1) < 1e-9 && widths.every(({ filled: f, empty }) => f >= 0 && empty >= 0));
  }
  assert.ok(widthsOf({ stage: null, stage_fraction: 0, fraction: 0 }).every(({ filled }) => filled === 0));
  assert.ok(widthsOf(null).every(({ empty }) => empty === 0));
});

test("a command can be pasted whatever it holds", () => {
  (globalThis as { location?: unknown }).location = { origin: "http://127.0.0.1:8080" };
  assert.equal(curlOf("GET", "/v1/jobs/{id}", { path: { id: "job_1" } }), "curl -sS http://127.0.0.1:8080/v1/jobs/job_1");
  assert.equal(curlOf("DELETE", "/v1/jobs/a b"), "curl -sS -X DELETE 'http://127.0.0.1:8080/v1/jobs/a b'");
  assert.equal(curlOf("POST", "/v1/queue/pause", { json: { reason: "it's $HOME" } }),
    `curl -sS -H 'Content-Type: application/json' -d '{"reason":"it'\\''s $HOME"}' http://127.0.0.1:8080/v1/queue/pause`);
  assert.equal(curlOf("POST", "/v1/jobs", { form: [{ field: "scene", file: "my scene.obj" }, { field: "options", text: "{}" }] }),
    "curl -sS -F 'scene=@my scene.obj' --form-string 'options={}' http://127.0.0.1:8080/v1/jobs");
});

test("paths are filled in and values escaped", () => {
  assert.equal(urlOf("/v1/jobs/{id}/frames/{f}", { path: { id: "a/b", f: 3 } }), "/v1/jobs/a%2Fb/frames/3");
  assert.equal(urlOf("/v1/jobs", { query: { state: "", label: ["a", "b:c d"], limit: 0, cursor: null } }), "/v1/jobs?label=a&label=b%3Ac+d&limit=0");
});

test("a problem document keeps its places and when to come back", async () => {
  const problem = { type: "urn:x", title: "Unprocessable Content", status: 422, detail: "2 places", errors: [{ file: "animation.json", pointer: "/images/0", code: "missing", detail: "is missing" }] };
  const error = await errorOf(new Response(JSON.stringify(problem), { status: 422, headers: { "Retry-After": "7" } }));
  assert.ok(error instanceof ApiError);
  assert.deepEqual([error.status, error.message, error.retryAfterSeconds, error.at("/images/0")?.code, error.at("/images")], [422, "2 places", 7, "missing", null]);
  assert.equal(placeOf(error.errors[0]!), "animation.json /images/0");
  assert.equal(placeOf({ file: "scene.obj", line: 3, column: 7, code: "syntax", detail: "" }), "scene.obj line 3:7");
  const proxy = await errorOf(new Response("<html>Bad Gateway</html>", { status: 502, statusText: "Bad Gateway" }));
  assert.equal(proxy.message, "the service answered 502 Bad Gateway");
});

test("pages are found by their paths", () => {
  const routes = ["/", "/jobs/{id}", "/new"].map((pattern) => ({ pattern, load: () => Promise.reject(new Error()) }));
  assert.equal(match(routes, "/")?.route.pattern, "/");
  assert.deepEqual(match(routes, "/jobs/a%20b")?.values, { id: "a b" });
  assert.deepEqual(match(routes, "/jobs/%E0%A4%A")?.values, { id: "%E0%A4%A" });
  for (const path of ["/jobs/", "/jobs", "/jobs/a/b", "/new/", "//"]) assert.equal(match(routes, path), null, path);
});

test("Shift chooses all between two", () => {
  const shown = ["a", "b", "c", "d"];
  const selection = new Selection();
  selection.toggle("d");
  selection.extendTo("b", shown);
  assert.deepEqual([...selection.ids.value].sort(), ["b", "c", "d"]);
  selection.keepOnly(["a", "c"]);
  assert.deepEqual([...selection.ids.value], ["c"]);
  selection.toggle("c");
  assert.equal(selection.ids.value.size, 0);
});

test("a signal tells of changes only, and of none after its stop", () => {
  const heard: number[] = [];
  const signal = new Signal(1);
  const stop = signal.watch((value) => heard.push(value));
  signal.value = 1;
  signal.value = 2;
  stop();
  signal.value = 3;
  assert.deepEqual(heard, [1, 2]);
  const order: string[] = [];
  const lifetime = new Lifetime();
  lifetime.add(() => order.push("first"), () => order.push("second"));
  lifetime.end();
  lifetime.add(() => order.push("too late: at once"));
  assert.deepEqual(order, ["second", "first", "too late: at once"]);
});

test("numbers are written for people", () => {
  assert.deepEqual([0, 999, 1000, 178_400_000, 59e9].map(bytes), ["0 B", "999 B", "1.0 kB", "178 MB", "59 GB"]);
  assert.deepEqual([0.04, 0.96, 59.4, 200, 3600, 7500, 360_000].map(duration), ["0.0 s", "1 s", "59 s", "3 min 20 s", "1 h", "2 h 5 min", "4 d 4 h"]);
  assert.deepEqual([0, 0.999, 1, 1.5].map(percent), ["0 %", "99 %", "100 %", "100 %"]);
  assert.deepEqual([count(1, "job"), count(2000, "job"), count(2, "box", "boxes")], ["1 job", "2,000 jobs", "2 boxes"]);
  assert.equal(ago("2026-11-22T08:15:30Z", Date.parse("2026-11-22T08:18:31Z")), "3 min ago");
});

test("samples of the metrics are found by their names", () => {
  const samples = parseSamples('# HELP a b\nkeylume_disk_free_bytes 59000000000\nkeylume_jobs{state="queued"} 3\nbroken line here\n');
  assert.equal(samples.length, 2);
  assert.equal(sampleOf(samples, "keylume_disk_free_bytes"), 59e9);
  assert.equal(sampleOf(samples, "none"), null);
});
