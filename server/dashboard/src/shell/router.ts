// Which page answers which path, by the History API. What stands after # belongs to the page.
import type { OpenPage } from "./page";

export interface Route {
  /** As the service's own: "/jobs/{id}". */
  pattern: string;
  /** Fetches the page's script when it is first needed. */
  load(): Promise<OpenPage>;
}

export interface Match {
  route: Route;
  values: Record<string, string>;
}

const kNavigated = "keylume-navigated";

export function match(routes: readonly Route[], path: string): Match | null {
  const given = path.split("/");
  for (const route of routes) {
    const wanted = route.pattern.split("/");
    if (wanted.length !== given.length) continue;
    const values: Record<string, string> = {};
    const fits = wanted.every((segment, i) => {
      if (!segment.startsWith("{")) return segment === given[i];
      values[segment.slice(1, -1)] = decoded(given[i]!);
      return given[i] !== "";
    });
    if (fits) return { route, values };
  }
  return null;
}

function decoded(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** Goes to a page of the dashboard: a path, with a query and a #fragment if need be. */
export function navigate(to: string, how: { replace?: boolean } = {}): void {
  if (how.replace) history.replaceState(null, "", to);
  else history.pushState(null, "", to);
  window.dispatchEvent(new Event(kNavigated));
}

/** Calls `open` whenever another page is asked for: by a link, by navigate(), by back and forward. */
export function watchAddress(routes: readonly Route[], open: () => void): void {
  let shown = "";
  const look = (always: boolean): void => {
    const now = location.pathname + location.search;
    if (!always && now === shown) return; // only what stands after # has changed
    shown = now;
    open();
  };
  window.addEventListener(kNavigated, () => look(true));
  window.addEventListener("popstate", () => look(false));
  document.addEventListener("click", (event) => {
    const link = linkToFollow(event);
    if (!link || !match(routes, link.pathname)) return;
    if (link.pathname + link.search === location.pathname + location.search && link.hash) return;
    event.preventDefault();
    navigate(link.href);
  });
  look(true);
}

/** A plain click on a link within the dashboard; anything else is the browser's business. */
function linkToFollow(event: MouseEvent): HTMLAnchorElement | null {
  if (event.defaultPrevented || event.button !== 0 || event.metaKey || event.ctrlKey || event.shiftKey || event.altKey) return null;
  const link = (event.target as Element | null)?.closest?.("a[href]") as HTMLAnchorElement | null;
  if (!link || link.target || link.hasAttribute("download") || link.origin !== location.origin) return null;
  return link;
}
