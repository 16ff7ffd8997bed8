// A small picture of a job, as soon as there is one; looked for only where the row is in sight.
import { get } from "../api/client";
import type { Job } from "../api/types";
import { h } from "../base/h";

export interface Thumbnail {
  element: HTMLElement;
  show(job: Job): void;
  stop(): void;
}

const kMayHavePictures: readonly string[] = ["images", "publish"];

export function thumbnail(): Thumbnail {
  const element = h("div", { class: "thumbnail", "aria-hidden": "true" });
  let job: Job | null = null;
  let inSight = false;
  let lookedFor = ""; // the progress at which it was last looked for
  const look = (): void => {
    if (!job || !inSight) return;
    const when = wordOf(job);
    if (when === "" || when === lookedFor) return;
    lookedFor = when;
    void find(job.id).then((href) => {
      if (href === null || element.querySelector("img")?.getAttribute("src") === href) return;
      const image = h("img", { src: href, alt: "", loading: "lazy", decoding: "async" });
      image.addEventListener("load", () => element.replaceChildren(image));
      if (!element.firstChild) element.append(image);
    });
  };
  const watcher = new IntersectionObserver((entries) => {
    inSight = entries.some((entry) => entry.isIntersecting);
    look();
  });
  watcher.observe(element);
  return {
    element,
    show(now) {
      job = now;
      look();
    },
    stop: () => watcher.disconnect(),
  };
}

/** Changes when another picture may be there; "": there can be none. */
function wordOf(job: Job): string {
  if (job.state === "succeeded") return `done ${job.attempt}`;
  if (!kMayHavePictures.includes(job.progress.stage ?? "")) return "";
  return `${job.attempt} ${Math.floor(job.progress.stage_fraction * 4)}`;
}

/** The picture in the middle of the sequence, or of what there is of it. */
async function find(id: string): Promise<string | null> {
  try {
    const { images } = await get("/v1/jobs/{id}/preview", { path: { id } });
    return images[Math.floor(images.length / 2)]?.href ?? null;
  } catch {
    return null; // no pictures were asked for, or they are gone
  }
}
