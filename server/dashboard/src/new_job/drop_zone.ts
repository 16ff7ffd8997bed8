// Where files are dropped, or chosen.
import { h } from "../base/h";

export function dropZone(take: (files: readonly File[]) => void): HTMLElement {
  const input = h("input", {
    type: "file", multiple: true, class: "visually-hidden", id: "job-files", accept: ".obj,.mtl,.png,.jpg,.jpeg,.json,.zip,.tar",
    onchange: () => {
      take([...(input.files ?? [])]);
      input.value = ""; // the same file may be chosen again, changed
    },
  });
  const zone = h("div", { class: "drop-zone" }, input,
    h("label", { for: "job-files" }, h("strong", null, "Drop files here, or choose them"),
      h("span", { class: "muted" }, "the scene (.obj), its materials (.mtl) and textures, and the animation (.json); or all in one .zip or .tar")));
  const over = (yes: boolean) => (event: DragEvent): void => {
    event.preventDefault();
    zone.classList.toggle("drop-over", yes);
  };
  zone.addEventListener("dragover", over(true));
  zone.addEventListener("dragleave", over(false));
  zone.addEventListener("drop", (event) => {
    over(false)(event);
    take([...(event.dataTransfer?.files ?? [])]);
  });
  return zone;
}
