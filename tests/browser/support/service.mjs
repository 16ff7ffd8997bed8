// A real server with its dashboard, on a free port, in a folder of its own; ends only what it started.
import { spawn, spawnSync } from "node:child_process";
import { createWriteStream, mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { basename, dirname, join } from "node:path";

const { KEYLUME_SERVER, KEYLUME_WORKER, KEYLUME_DASHBOARD, KEYLUME_BROWSER_PICTURES } = process.env;

function freePort() {
  return new Promise((resolve, reject) => {
    const probe = createServer().on("error", reject).listen(0, "127.0.0.1", () => {
      const { port } = probe.address();
      probe.close(() => resolve(port));
    });
  });
}

/** The first true value of `condition()`. */
export async function waitFor(condition, seconds, what) {
  const end = Date.now() + 1000 * seconds;
  while (Date.now() < end) {
    const value = await condition();
    if (value) return value;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  throw new Error(`not within ${seconds} s: ${what}`);
}

export class Service {
  folder = mkdtempSync(join(tmpdir(), "keylume-browser-"));
  process = null;

  get url() {
    return `http://127.0.0.1:${this.port}`;
  }

  async start(...options) {
    this.port ??= await freePort();
    this.options = options;
    mkdirSync(dirname(this.log), { recursive: true });
    const log = createWriteStream(this.log, { flags: "a" });
    this.process = spawn(KEYLUME_SERVER, ["--data", this.data, "--listen", `127.0.0.1:${this.port}`, "--ops-listen", "off",
      "--worker", KEYLUME_WORKER, "--dashboard", KEYLUME_DASHBOARD, ...options], { stdio: ["ignore", "pipe", "pipe"] });
    this.process.stdout.pipe(log);
    this.process.stderr.pipe(log);
    this.ended = new Promise((resolve) => this.process.on("exit", resolve));
    await waitFor(() => this.answers(), 30, "the server answers");
    return this;
  }

  get data() {
    return join(this.folder, "data");
  }
  /** Beside the pictures, where there is such a place: to be read after a test that failed. */
  get log() {
    return join(KEYLUME_BROWSER_PICTURES ?? this.folder, `${basename(process.argv[1] ?? "service", ".mjs")}-server.log`);
  }

  async answers() {
    if (this.process.exitCode !== null) throw new Error(`the server ended:\n${readFileSync(this.log, "utf8")}`);
    return fetch(`${this.url}/healthz`).then((response) => response.ok, () => false);
  }

  /** As an operator stops it. */
  async stop() {
    this.process.kill("SIGTERM");
    await this.ended;
  }

  restart() {
    return this.start(...this.options);
  }

  /** Also before it has been started: the first token makes it ask for tokens. */
  createToken(name, scopes = "jobs:read,jobs:write,queue:admin,metrics:read") {
    const run = spawnSync(KEYLUME_SERVER, ["token", "create", name, "--scopes", scopes, "--data", this.data], { encoding: "utf8" });
    const token = /kl_\S+/.exec(run.stdout)?.[0];
    if (!token) throw new Error(`no token: ${run.stdout}${run.stderr}`);
    return token;
  }

  async end() {
    if (this.process && this.process.exitCode === null) {
      this.process.kill("SIGTERM");
      const late = setTimeout(() => this.process.kill("SIGKILL"), 15_000);
      await this.ended;
      clearTimeout(late);
    }
    rmSync(this.folder, { recursive: true, force: true });
  }
}
