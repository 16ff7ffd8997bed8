// What a file of tests has for all of them: a service, a browser, and what is prepared there; all ended after them.
import { after, before } from "node:test";
import { Watched, launch } from "./browser.mjs";
import { Service } from "./service.mjs";

/** `prepare(service)`: more for all tests, by name; the browser is there by then. -> { service, browser, open(path, options), ... }, there once a test runs */
export function suite(prepare = async () => {}) {
  const given = { open: (path, options) => Watched.open(given.browser, given.service, path, options) };
  before(async () => {
    given.service = await new Service().start();
    given.browser = await launch();
    Object.assign(given, await prepare(given.service));
  });
  after(async () => {
    await given.browser?.close();
    await given.service?.end();
  });
  return given;
}
