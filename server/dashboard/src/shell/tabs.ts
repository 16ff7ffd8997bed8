// Tabs by the ARIA pattern: arrows move between them, the address keeps which (#tab=images).
import { h } from "../base/h";

export interface Tab {
  name: string;
  label: string;
  /** Called once, when it is first shown. */
  open(): HTMLElement;
}

function nameInAddress(): string | null {
  return new URLSearchParams(location.hash.slice(1)).get("tab");
}

function keep(name: string | null): void {
  const words = new URLSearchParams(location.hash.slice(1));
  if (name === null) words.delete("tab");
  else words.set("tab", name);
  const text = decodeURIComponent(words.toString());
  history.replaceState(history.state, "", location.pathname + location.search + (text ? `#${text}` : ""));
}

export function tabs(label: string, list: readonly Tab[]): HTMLElement {
  const panels = list.map((tab) => h("div", { role: "tabpanel", id: `panel-${tab.name}`, "aria-labelledby": `tab-${tab.name}`, hidden: true }));
  const buttons = list.map((tab, i) => h("button", {
    role: "tab", id: `tab-${tab.name}`, "aria-controls": `panel-${tab.name}`, onclick: () => select(i, true),
    onkeydown: (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (step === undefined) return;
      event.preventDefault();
      const next = (i + step + list.length) % list.length;
      select(next, true);
      buttons[next]!.focus();
    },
  }, tab.label));

  function select(chosen: number, byHand: boolean): void {
    list.forEach((tab, i) => {
      buttons[i]!.setAttribute("aria-selected", String(i === chosen));
      buttons[i]!.tabIndex = i === chosen ? 0 : -1;
      panels[i]!.hidden = i !== chosen;
      if (i === chosen && panels[i]!.childElementCount === 0) panels[i]!.append(tab.open());
    });
    if (byHand) keep(chosen === 0 ? null : list[chosen]!.name);
  }
  const element = h("div", { class: "tabs" }, h("div", { role: "tablist", "aria-label": label }, buttons), panels);
  select(Math.max(list.findIndex((tab) => tab.name === nameInAddress()), 0), false);
  return element;
}
