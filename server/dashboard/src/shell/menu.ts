// A menu behind a button, by the ARIA pattern. Every entry may have its curl command beside it.
import { h } from "../base/h";
import { copyCurlButton } from "./copy_curl";

export interface MenuEntry {
  label: string;
  run(): void;
  danger?: boolean;
  curl?: () => string;
}

/** `entries` is asked each time the menu opens. */
export function menuButton(label: string, entries: () => MenuEntry[]): HTMLElement {
  const button = h("button", { class: "quiet icon", "aria-label": label, title: label, "aria-haspopup": "menu", "aria-expanded": "false" }, "⋯");
  const holder = h("div", { class: "menu-holder" }, button);
  let menu: HTMLElement | null = null;

  const close = (focus: boolean): void => {
    menu?.remove();
    menu = null;
    button.setAttribute("aria-expanded", "false");
    document.removeEventListener("pointerdown", outside, true);
    if (focus) button.focus();
  };
  const outside = (event: Event): void => {
    if (!holder.contains(event.target as Node)) close(false);
  };
  const open = (): void => {
    menu = h("div", { class: "menu", role: "menu", "aria-label": label }, entries().map((entry) => line(entry, close)));
    menu.addEventListener("keydown", (event) => onKey(event, menu!, close));
    menu.addEventListener("focusout", (event) => {
      if (event.relatedTarget instanceof Node && !holder.contains(event.relatedTarget)) close(false);
    });
    holder.append(menu);
    if (menu.getBoundingClientRect().bottom > window.innerHeight) menu.classList.add("menu-above");
    button.setAttribute("aria-expanded", "true");
    document.addEventListener("pointerdown", outside, true);
    itemsOf(menu)[0]?.focus();
  };
  button.addEventListener("click", () => (menu ? close(true) : open()));
  return holder;
}

function line(entry: MenuEntry, close: (focus: boolean) => void): HTMLElement {
  const run = (): void => {
    close(true);
    entry.run();
  };
  const copy = entry.curl ? copyCurlButton(entry.curl, entry.label) : null;
  copy?.setAttribute("role", "menuitem");
  copy?.addEventListener("click", () => close(true));
  return h("div", { class: "menu-line", role: "none" },
    h("button", { class: entry.danger ? "quiet bad" : "quiet", role: "menuitem", onclick: run }, entry.label), copy);
}

function itemsOf(menu: HTMLElement): HTMLElement[] {
  return [...menu.querySelectorAll<HTMLElement>("[role=menuitem]")];
}

function onKey(event: KeyboardEvent, menu: HTMLElement, close: (focus: boolean) => void): void {
  if (event.key === "Escape") return close(true);
  const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
  if (step === undefined) return;
  event.preventDefault();
  event.stopPropagation();
  const items = itemsOf(menu);
  const at = items.indexOf(document.activeElement as HTMLElement);
  items[(at + step + items.length) % items.length]?.focus();
}
