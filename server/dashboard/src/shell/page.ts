// What a page is. The shell opens one at a time into <main> and closes it before the next.
import type { Lifetime } from "../base/signal";

export interface PageContext {
  /** Values of the {names} in the page's path. */
  readonly values: Readonly<Record<string, string>>;
  readonly query: URLSearchParams;
  /** Ends when the page is left: what a page starts (listeners, timers, requests, WebGL), it adds here. */
  readonly lifetime: Lifetime;
  /** What the tab's title and the heading say. */
  setTitle(title: string): void;
  /** Controls beside the heading. */
  setTools(...tools: Node[]): void;
}

/** Returns at once with what can be shown at once; the rest is filled in as it comes. */
export type OpenPage = (context: PageContext) => HTMLElement;
