// New job: files, what they show, what it will cost, settings, submit.
import { ApiError, messageOf } from "../api/api_error";
import { get, send } from "../api/client";
import { curlOf } from "../api/curl";
import { fetchExample, listExamples } from "../api/examples";
import { fetchInputs } from "../api/job_inputs";
import type { ProblemError, Validation } from "../api/types";
import { forecastText } from "../base/forecast";
import { bytes, count } from "../base/format";
import { fill, h } from "../base/h";
import { copyCurlButton } from "../shell/copy_curl";
import type { OpenPage, PageContext } from "../shell/page";
import { navigate } from "../shell/router";
import { toast, toastError } from "../shell/toast";
import { dropZone } from "./drop_zone";
import { jobOptionsForm } from "./job_options_form";
import { previewOf } from "./preview_request";
import { scenePreview } from "./scene_preview";
import { settingsForm } from "./settings_form";
import { formOf, isWhole, jsonOf, missing, withFiles, withSettings, type Part } from "./upload";
import "./new_job.css";

/** A setting is checked when nothing has been typed for so long. */
const kQuietMs = 600;

export const openNewJobPage: OpenPage = (context) => {
  context.setTitle("New job");
  return new NewJob(context).element;
};

class NewJob {
  readonly element: HTMLElement;
  private parts: Part[] = [];
  /** Of animation.json; null: none, none that is JSON, or in an archive. */
  private animation: Record<string, unknown> | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private asked = new AbortController();
  /** Of the page. */
  private readonly over = new AbortController();
  private readonly files = h("ul", { class: "file-list", "aria-label": "Files of the job" });
  private readonly hint = h("p", { class: "muted", role: "status" });
  private readonly errors = h("div", { class: "job-errors", role: "alert" });
  private readonly forecast = h("div", { class: "forecast", role: "status" });
  private readonly warnings = h("div", { role: "status" });
  private readonly submit = h("button", { class: "primary", type: "submit" }, "Submit job");
  private readonly settings = settingsForm(() => this.later());
  private readonly options = jobOptionsForm(() => this.later());
  private readonly preview;

  constructor(context: PageContext) {
    this.preview = scenePreview(context.lifetime);
    context.lifetime.add(() => clearTimeout(this.timer), () => this.asked.abort(), () => this.over.abort());
    this.element = h("form", {
      class: "new-job", novalidate: true, onsubmit: (event) => {
        event.preventDefault();
        void this.send().catch(toastError);
      },
    },
      dropZone((files) => void this.add(files).catch(toastError)), this.examples(), this.files, this.hint, this.errors,
      h("div", { class: "new-job-sides" }, h("div", null, this.preview.element, this.warnings), h("div", null, this.settings.element, this.options.element)),
      h("div", { class: "row new-job-send" }, this.submit, copyCurlButton(() => this.curl(), "submit this job"), this.forecast));
    this.settings.start(null);
    this.show();
    const from = context.query.get("from");
    if (from) void this.takeFrom(from).catch((error: unknown) => this.showErrors(error));
  }

  /** The files and settings of another job, to begin with. */
  private async takeFrom(id: string): Promise<void> {
    this.hint.textContent = "Fetching the files of the other job…";
    const [job, files] = await Promise.all([get("/v1/jobs/{id}", { path: { id } }), fetchInputs(id, this.over.signal)]);
    if (this.over.signal.aborted) return;
    this.options.start(job);
    await this.take(withFiles([], files).parts);
    this.hint.textContent = `Files and settings are those of ${job.name || job.id}. Change what you like.`;
  }

  private async add(files: readonly File[]): Promise<void> {
    const { parts, unknown } = withFiles(this.parts, files);
    if (unknown.length > 0) toast(`Not part of a job: ${unknown.join(", ")}`, { kind: "bad" });
    await this.take(parts);
  }

  private async take(parts: Part[]): Promise<void> {
    const before = this.parts;
    const isNew = (field: Part["field"]): boolean =>
      parts.find((part) => part.field === field)?.file !== before.find((part) => part.field === field)?.file;
    this.parts = parts;
    const options = isNew("options") ? await jsonOf(parts, "options") : null;
    if (options) this.options.start(options);
    if (isNew("animation")) {
      this.animation = await jsonOf(parts, "animation");
      this.settings.start(this.animation);
    }
    this.show();
    this.check(true);
  }

  private show(): void {
    fill(this.files, this.parts.map((part) => h("li", null, h("code", null, part.file.name), h("span", { class: "muted" }, ` ${part.field} · ${bytes(part.file.size)} `),
      h("button", { type: "button", class: "quiet icon", "aria-label": `Leave out ${part.file.name}`, onclick: () => void this.take(this.parts.filter((other) => other !== part)) }, "×"))));
    this.hint.textContent = missing(this.parts);
    this.submit.disabled = !isWhole(this.parts);
  }

  private later(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.check(false), kQuietMs);
  }

  private form(): FormData {
    return formOf(this.parts, this.animation && withSettings(this.animation, this.settings.values()), this.options.values());
  }

  /** The forecast after every change; the preview where the files have changed. */
  private check(filesChanged: boolean): void {
    this.asked.abort();
    this.asked = new AbortController();
    if (!isWhole(this.parts)) {
      fill(this.forecast);
      fill(this.warnings);
      fill(this.errors);
      if (filesChanged) this.preview.clear();
      return;
    }
    const { signal } = this.asked;
    fill(this.forecast, h("span", { class: "muted" }, "Checking…"));
    send("post", "/v1/validate", { form: this.form(), signal }).then(
      (answer) => !signal.aborted && this.showForecast(answer),
      (error: unknown) => !signal.aborted && this.showErrors(error),
    );
    if (!filesChanged) return;
    previewOf(this.form(), signal).then((archive) => this.preview.show(archive)).catch((error: unknown) => {
      this.preview.clear();
      // What is wrong with the files is told by the check; here only what stops the preview alone.
      if (!signal.aborted && !(error instanceof ApiError && error.status === 422)) toast(`No preview: ${messageOf(error)}`);
    });
  }

  private showForecast({ forecast, warnings }: Validation): void {
    this.settings.showErrors([]);
    fill(this.errors);
    fill(this.forecast, h("dl", { class: "forecast-facts", "aria-label": "Forecast" },
      h("dt", null, "Takes"), h("dd", null, forecastText(forecast)),
      h("dt", null, "memory"), h("dd", null, bytes(forecast.memory_bytes)),
      h("dt", null, "for"), h("dd", null, `${count(forecast.patches, "patch", "patches")}, ${count(forecast.frames, "frame")}, ${count(forecast.polygons, "polygon")}`)));
    fill(this.warnings, warnings.map((text) => h("p", { class: "warn small" }, text)));
  }

  private showErrors(error: unknown): void {
    fill(this.forecast);
    fill(this.warnings);
    const named = error instanceof ApiError ? error.errors : [];
    const left = this.settings.showErrors(named);
    fill(this.errors, named.length === 0 ? h("p", { class: "bad" }, messageOf(error)) : h("p", { class: "bad" }, "This job would be refused:"),
      h("ul", null, left.map((one) => h("li", null, h("code", null, placeOf(one)), ` ${one.detail}`)),
        named.length > left.length ? h("li", null, "see the settings marked below") : null));
  }

  private async send(): Promise<void> {
    this.submit.disabled = true;
    try {
      const job = await send("post", "/v1/jobs", { form: this.form() });
      toast("Submitted.", { kind: "good" });
      navigate(`/jobs/${encodeURIComponent(job.id)}`);
    } catch (error) {
      if (error instanceof ApiError && error.status === 422) {
        this.showErrors(error);
        this.errors.scrollIntoView({ block: "center" });
        toast(`Not submitted: ${count(error.errors.length, "place")} to fix.`, { kind: "bad" });
      } else {
        throw error;
      }
    } finally {
      this.submit.disabled = !isWhole(this.parts);
    }
  }

  /** Files by their names, to be run where they are; what was set in the form stands in the command itself. */
  private curl(): string {
    const animation = this.animation && JSON.stringify(withSettings(this.animation, this.settings.values()));
    const changed = animation !== null && animation !== JSON.stringify(this.animation);
    const files = this.parts.filter(({ field }) => field !== "options").map(({ field, file }) =>
      (field === "animation" && changed ? { field, text: animation } : { field, file: file.name }));
    const options = this.options.values();
    return curlOf("POST", "/v1/jobs", { form: [...files, ...(Object.keys(options).length > 0 ? [{ field: "options", text: JSON.stringify(options) }] : [])] });
  }

  private examples(): HTMLElement {
    const place = h("div", { class: "row" });
    listExamples().then((examples) => {
      fill(place, h("span", { class: "muted" }, "Or start from an example: "), examples.map((example) =>
        h("button", { type: "button", title: example.description, onclick: () => void use(example).catch(toastError) }, example.title)));
    }, () => {}); // without examples there is nothing to offer
    const use = async (example: Parameters<typeof fetchExample>[0]): Promise<void> => {
      await this.take((await fetchExample(example)).map(({ field, file }) => ({ field, file })));
    };
    return place;
  }
}

function placeOf({ file, pointer, line, column }: ProblemError): string {
  return `${file}${line !== undefined ? `:${line}${column !== undefined ? `:${column}` : ""}` : ""}${pointer ? ` ${pointer}` : ""}`;
}
