// Every action of the dashboard as a command: it teaches the interface.
import { urlOf, type RequestOptions } from "./client";

export interface CurlOptions extends Pick<RequestOptions, "path" | "query" | "headers" | "json"> {
  /** Parts of an upload: `file` is sent by its name, `text` as it is. */
  form?: readonly { field: string; file?: string; text?: string }[];
  /** Keep the answer in this file. */
  output?: string;
  /** Follow a stream as it comes. */
  stream?: boolean;
}

function quoted(text: string): string {
  return /^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;
}

/** A curl command that does what the dashboard does. `path` with or without {names}. */
export function curlOf(method: string, path: string, options: CurlOptions = {}): string {
  const words = ["curl", options.stream ? "-sN" : "-sS"];
  const upper = method.toUpperCase();
  const has_body = options.json !== undefined || options.form !== undefined;
  if (upper !== "GET" && !(upper === "POST" && has_body)) words.push("-X", upper);
  if (asksForTokens()) words.push("-H", '"Authorization: Bearer $KEYLUME_TOKEN"');
  for (const [name, value] of Object.entries(options.headers ?? {})) words.push("-H", quoted(`${name}: ${value}`));
  if (options.json !== undefined)
    words.push("-H", quoted("Content-Type: application/json"), "-d", quoted(JSON.stringify(options.json)));
  for (const { field, file, text } of options.form ?? []) {
    // In what follows -F curl reads ; and , as its own; of --form-string it sends all.
    if (file !== undefined) words.push("-F", quoted(`${field}=@${/[,;"\\]/.test(file) ? `"${file.replace(/["\\]/g, "\\$&")}"` : file}`));
    else words.push("--form-string", quoted(`${field}=${text ?? ""}`));
  }
  if (options.output !== undefined) words.push("-o", quoted(options.output));
  words.push(quoted(location.origin + urlOf(path, options)));
  return words.join(" ");
}

const kLoggedIn = "keylume-logged-in";

/** Remembered over visits: the cookie of the login cannot be read from here. */
export function setLoggedIn(yes: boolean): void {
  try {
    if (yes) localStorage.setItem(kLoggedIn, "1");
    else localStorage.removeItem(kLoggedIn);
  } catch {
    // No storage: commands are shown without the token.
  }
}

export function asksForTokens(): boolean {
  try {
    return localStorage.getItem(kLoggedIn) !== null;
  } catch {
    return false;
  }
}
