import { copyCurlButton } from "../shell/copy_curl";
import { h } from "../base/h";

export type Fact = readonly [label: string, value: Node | string];

export interface Card {
  element: HTMLElement;
  body: HTMLElement;
}

/** A titled box, with the command that asks for the same. */
export function card(title: string, command: string): Card {
  const body = h("div", { class: "system-body" }, h("p", { class: "muted" }, "Fetching…"));
  const element = h("section", { class: "card", "aria-label": title },
    h("div", { class: "card-head" }, h("h2", null, title), copyCurlButton(() => command, title.toLowerCase())), body);
  return { element, body };
}

export function facts(list: readonly Fact[]): HTMLElement {
  return h("dl", { class: "facts" }, list.flatMap(([label, value]) => [h("dt", null, label), h("dd", null, value)]));
}

/** How much of what there is is taken. */
export function meter(label: string, value: number, most: number, text: string): HTMLElement {
  const bar = h("meter", { min: 0, max: most, value, "aria-label": `${label}: ${text}` });
  return h("div", { class: "system-meter" }, h("div", { class: "system-meter-line" }, h("span", { class: "muted" }, label), h("span", null, text)), bar);
}
