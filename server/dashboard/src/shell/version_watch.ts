// After an upgrade of the service the scripts of this page are old, and those it has not fetched yet are gone.
import { live } from "../api/live";
import { h } from "../base/h";

/** The service's index names other scripts than this page runs. */
async function isOutdated(): Promise<boolean> {
  const own = document.querySelector<HTMLScriptElement>("script[type=module][src]")?.getAttribute("src");
  const response = await fetch("/", { cache: "no-cache", headers: { Accept: "text/html" } });
  return response.ok && own !== undefined && own !== null && !(await response.text()).includes(own);
}

/** A bar that offers to reload; nothing is reloaded under somebody's hands. */
export function versionBar(): HTMLElement {
  const bar = h("div", { class: "bar", role: "status", hidden: true },
    h("span", null, "The service was upgraded. Reload to use its new dashboard."),
    h("button", { onclick: () => location.reload() }, "Reload"));
  let before = "";
  live.connection.watch((state) => {
    const back = state.how === "live" && before !== "" && before !== "connecting";
    before = state.how;
    if (back) void isOutdated().then((outdated) => (bar.hidden = !outdated), () => {});
  });
  return bar;
}
