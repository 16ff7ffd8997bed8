// Light, dark, or as the system says. Kept over visits.
import { Signal } from "../base/signal";

export type Theme = "auto" | "light" | "dark";

const kKey = "keylume-theme";
const kThemes: readonly Theme[] = ["auto", "light", "dark"];

function kept(): Theme {
  try {
    const word = localStorage.getItem(kKey);
    return kThemes.find((theme) => theme === word) ?? "auto";
  } catch {
    return "auto";
  }
}

export const theme = new Signal<Theme>(kept());

/** What is shown now, also where that is the system's choice. */
export function isDark(): boolean {
  return theme.value === "dark" || (theme.value === "auto" && matchMedia("(prefers-color-scheme: dark)").matches);
}

export function startTheme(): void {
  theme.watch((now) => {
    if (now === "auto") delete document.documentElement.dataset["theme"];
    else document.documentElement.dataset["theme"] = now;
    try {
      if (now === "auto") localStorage.removeItem(kKey);
      else localStorage.setItem(kKey, now);
    } catch {
      // No storage: it holds for this visit.
    }
  });
}

export function nextTheme(): void {
  theme.value = kThemes[(kThemes.indexOf(theme.value) + 1) % kThemes.length]!;
}
