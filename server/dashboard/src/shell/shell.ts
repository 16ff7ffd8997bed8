// What is around every page: navigation, connection, theme, keys; opens pages as the address says.
import { access } from "../api/client";
import { live } from "../api/live";
import { fill, h } from "../base/h";
import { Lifetime } from "../base/signal";
import { connectionStatus, offlineBar } from "./connection";
import { addKeys, showKeys, startKeys } from "./keys";
import { isLoggedIn, logOut } from "./login_page";
import type { OpenPage } from "./page";
import { pages } from "./pages";
import { match, navigate, watchAddress } from "./router";
import { nextTheme, startTheme, theme } from "./theme";
import { toastError, toastRegion } from "./toast";
import { versionBar } from "./version_watch";

const kNavigation = [
  { path: "/", label: "Queue" },
  { path: "/new", label: "New job" },
  { path: "/compare", label: "Compare" },
  { path: "/system", label: "System" },
];

/** The frame a page is shown in. */
interface Frame {
  heading: HTMLElement;
  tools: HTMLElement;
  main: HTMLElement;
  navigation: HTMLElement;
}

export function startShell(root: HTMLElement): void {
  startTheme();
  startKeys();
  const frame: Frame = {
    heading: h("h1", { tabindex: -1 }),
    tools: h("div", { class: "page-tools" }),
    main: h("main", { id: "main", tabindex: -1 }),
    navigation: h("nav", { "aria-label": "Pages" }, kNavigation.map(({ path, label }) => h("a", { href: path }, label))),
  };
  frame.main.append(h("div", { class: "page-head" }, frame.heading, frame.tools));
  fill(root, h("a", { class: "skip", href: "#main", onclick: (event) => { event.preventDefault(); frame.heading.focus(); } }, "Skip to content"),
    header(frame.navigation), offlineBar(), versionBar(), frame.main, toastRegion());
  addGlobalKeys();
  access.watch((now) => now === "denied" && askForLogin());
  live.start();
  watchAddress(pages, pageOpener(frame));
}

function header(navigation: HTMLElement): HTMLElement {
  const themeButton = h("button", { class: "quiet", onclick: nextTheme });
  theme.watch((now) => {
    themeButton.textContent = { auto: "Auto", light: "Light", dark: "Dark" }[now];
    themeButton.title = `Colours: ${now === "auto" ? "as the system says" : now}. Press to change.`;
    themeButton.setAttribute("aria-label", `Theme: ${now}`);
  });
  const out = h("button", { class: "quiet", hidden: true, onclick: () => void logOut().catch(toastError) }, "Log out");
  access.watch(() => (out.hidden = !isLoggedIn()));
  return h("header", { class: "shell-header" },
    h("a", { class: "brand", href: "/", "aria-label": "Keylume, to the queue" }, "Keylume"), navigation,
    h("div", { class: "shell-right" }, connectionStatus(), h("a", { href: "/docs", class: "quiet-link" }, "API"), themeButton,
      h("button", { class: "quiet icon", title: "Keyboard (?)", "aria-label": "Keyboard commands", onclick: () => void showKeys() }, "?"), out));
}

function addGlobalKeys(): void {
  addKeys(new Lifetime(), "Everywhere", [
    { keys: "g q", does: "Queue", run: () => navigate("/") },
    { keys: "g n", does: "New job", run: () => navigate("/new") },
    { keys: "g c", does: "Compare", run: () => navigate("/compare") },
    { keys: "g s", does: "System", run: () => navigate("/system") },
    { keys: "g t", does: "Light, dark, automatic", run: nextTheme },
    { keys: "?", does: "This list", run: () => void showKeys() },
  ]);
}

function askForLogin(): void {
  if (location.pathname === "/login") return;
  navigate(`/login?back=${encodeURIComponent(location.pathname + location.search + location.hash)}`, { replace: true });
}

/** Opens the page that the address names, after closing the one before. */
function pageOpener(frame: Frame): () => void {
  let lifetime = new Lifetime();
  let opened = 0;
  return () => {
    lifetime.end();
    const mine = (lifetime = new Lifetime());
    const first = opened++ === 0;
    markCurrent(frame.navigation);
    const found = match(pages, location.pathname);
    if (!found) return showPage(frame, openNothingHere, {}, mine, first);
    frame.main.setAttribute("aria-busy", "true");
    found.route.load().then(
      (open) => !mine.ended && showPage(frame, open, found.values, mine, first),
      () => !mine.ended && showPage(frame, openScriptMissing, {}, mine, first),
    );
  };
}

function showPage(frame: Frame, open: OpenPage, values: Record<string, string>, lifetime: Lifetime, first: boolean): void {
  frame.tools.replaceChildren();
  const content = open({
    values,
    query: new URLSearchParams(location.search),
    lifetime,
    setTitle(title) {
      frame.heading.textContent = title;
      document.title = `${title} · Keylume`;
    },
    setTools: (...tools) => frame.tools.replaceChildren(...tools),
  });
  while (frame.main.children.length > 1) frame.main.lastChild!.remove();
  frame.main.append(content);
  frame.main.removeAttribute("aria-busy");
  // A screen reader hears that there is another page; on the first one the browser says so itself.
  if (!first && !content.contains(document.activeElement)) {
    frame.heading.focus({ preventScroll: true });
    window.scrollTo(0, 0);
  }
}

function markCurrent(navigation: HTMLElement): void {
  for (const link of navigation.querySelectorAll("a"))
    if (link.pathname === location.pathname) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
}

const openNothingHere: OpenPage = ({ setTitle }) => {
  setTitle("Nothing here");
  return h("p", null, "There is no page at this address. ", h("a", { href: "/" }, "To the queue"));
};

const openScriptMissing: OpenPage = ({ setTitle }) => {
  setTitle("This page could not be fetched");
  return h("div", { class: "notice" },
    h("p", null, "The service does not answer, or it was upgraded and this dashboard is from before."),
    h("button", { class: "primary", onclick: () => location.reload() }, "Reload"));
};
