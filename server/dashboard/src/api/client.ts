// Requests to the service, typed by its own description: the path is written as in api/openapi.yaml.
import type { paths } from "openapi";
import { Signal } from "../base/signal";
import { ApiError, errorOf } from "./api_error";
import { Silence } from "./silence";

type Method = "get" | "post" | "put" | "patch" | "delete";
type Operation<P extends keyof paths, M extends Method> = M extends keyof paths[P] ? paths[P][M] : never;
type WithMethod<M extends Method> = {
  [P in keyof paths]: M extends keyof paths[P] ? (paths[P][M] extends undefined ? never : P) : never;
}[keyof paths];
type JsonOf<R> = R extends { content: { "application/json": infer J } } ? J : never;
type AnswersOf<O> = O extends { responses: infer R } ? R : never;
type EmptyOf<R> = 204 extends keyof R ? undefined : never;
type Success<R> = { [S in keyof R]: S extends 200 | 201 | 202 ? JsonOf<R[S]> : never }[keyof R] | EmptyOf<R>;

/** What a request of this method to this path answers, where it is JSON. */
export type Answer<P extends keyof paths, M extends Method> = Success<AnswersOf<Operation<P, M>>>;

export type Query = Readonly<Record<string, string | number | boolean | readonly string[] | undefined | null>>;

export interface RequestOptions {
  /** Values of the {names} in the path. */
  path?: Readonly<Record<string, string | number>>;
  /** Without what is undefined, null, or "" . Lists repeat the name. */
  query?: Query;
  headers?: Readonly<Record<string, string>>;
  json?: unknown;
  form?: FormData;
  signal?: AbortSignal;
}

/** Whether the service lets us in; the shell shows the login at "denied". */
export const access = new Signal<"unknown" | "granted" | "denied">("unknown");

const kRetriesMax = 3;
const kWaitSecondsMax = 10;
/** Who reads is answered at once. Longer means that nobody answers, or that nobody hears us: asking anew is better. */
export const kSilenceMsMax = 20_000;

/** "/v1/jobs/{id}" and its values as the path and query that are sent. */
export function urlOf(path: string, options: Pick<RequestOptions, "path" | "query"> = {}): string {
  const filled = path.replace(/\{(\w+)\}/g, (_, name: string) => encodeURIComponent(String(options.path?.[name] ?? "")));
  const query = new URLSearchParams();
  for (const [name, value] of Object.entries(options.query ?? {})) {
    if (value === undefined || value === null || value === "") continue;
    for (const each of Array.isArray(value) ? value : [value]) query.append(name, String(each));
  }
  return query.size > 0 ? `${filled}?${query}` : filled;
}

/** JSON from the service. Asks again by itself where the service says when (429, 503), and is given up when it falls silent
 * for kSilenceMsMax. Errors: ApiError. */
export async function get<P extends WithMethod<"get">>(path: P, options: RequestOptions = {}): Promise<Answer<P, "get">> {
  return withoutSilence(options.signal, async (signal, silence) => {
    const response = await fetchPatiently(urlOf(path, options), { ...options, signal }, silence);
    return response.status === 204 ? undefined : JSON.parse(await textOf(response, silence));
  }) as Promise<Answer<P, "get">>;
}

/** A request that changes something: sent once. Errors: ApiError, which says when to try again. */
export async function send<M extends Exclude<Method, "get">, P extends WithMethod<M>>(
  method: M,
  path: P,
  options: RequestOptions = {},
): Promise<Answer<P, M>> {
  const headers: Record<string, string> = { ...options.headers };
  if (options.json !== undefined) headers["Content-Type"] = "application/json";
  const body = options.form ?? (options.json === undefined ? undefined : JSON.stringify(options.json));
  const response = await fetchOnce(urlOf(path, options), { method: method.toUpperCase(), headers, body, signal: options.signal });
  if (!response.ok) throw await errorOf(response);
  return answerOf(response) as Promise<Answer<P, M>>;
}

/** Any other bytes: pictures, arrays (with a Range), text. `url` as the service's links say. The answer begins within
 * kSilenceMsMax, and may then take as long as it likes. Errors: ApiError. */
export async function fetchBytes(url: string, options: Pick<RequestOptions, "headers" | "signal"> = {}): Promise<Response> {
  return withoutSilence(options.signal, (signal, silence) => fetchPatiently(url, { ...options, signal }, silence));
}

/** Does `work` with a signal that also aborts when nothing has been heard for too long. */
async function withoutSilence<T>(
  stop: AbortSignal | undefined,
  work: (signal: AbortSignal, silence: Silence) => Promise<T>,
): Promise<T> {
  const controller = new AbortController();
  const silence = new Silence(controller, kSilenceMsMax);
  try {
    return await work(stop ? AbortSignal.any([stop, controller.signal]) : controller.signal, silence);
  } catch (error) {
    if (!silence.tooLong || stop?.aborted) throw error;
    throw new ApiError(0, `The service has not answered for ${kSilenceMsMax / 1000} s: it, its disk or the network is very busy`);
  } finally {
    silence.end();
  }
}

async function textOf(response: Response, silence: Silence): Promise<string> {
  if (!response.body) return response.text();
  const reader = response.body.getReader();
  const decoder = new TextDecoder();
  let text = "";
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return text + decoder.decode();
    silence.broken();
    text += decoder.decode(value, { stream: true });
  }
}

async function answerOf(response: Response): Promise<unknown> {
  return response.status === 204 ? undefined : response.json();
}

async function fetchPatiently(
  url: string,
  options: Pick<RequestOptions, "headers" | "signal">,
  silence: Silence,
): Promise<Response> {
  for (let tries = 0; ; ++tries) {
    // no-cache: the browser asks whether what it has is still true (ETag), so polling costs a 304.
    const cache = options.headers?.["Range"] ? "default" : "no-cache";
    const response = await fetchOnce(url, { headers: options.headers, signal: options.signal, cache });
    silence.broken();
    if (response.ok) return response;
    const error = await errorOf(response);
    const wait = error.retryAfterSeconds;
    if ((error.status !== 429 && error.status !== 503) || wait === null || wait > kWaitSecondsMax || tries >= kRetriesMax) throw error;
    await sleep(wait, options.signal);
    silence.broken();
  }
}

async function fetchOnce(url: string, init: RequestInit): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(url, { credentials: "same-origin", ...init });
  } catch (error) {
    if (init.signal?.aborted) throw error;
    throw new ApiError(0, "The service does not answer. Is it running?");
  }
  if (response.status === 401) access.value = "denied";
  else if (response.ok && url.startsWith("/v1/jobs")) access.value = "granted";
  return response;
}

/** Rejects with the signal's reason when it is aborted. */
export function sleep(seconds: number, signal?: AbortSignal): Promise<void> {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(done, seconds * 1000);
    function done(): void {
      signal?.removeEventListener("abort", stop);
      resolve();
    }
    function stop(): void {
      clearTimeout(timer);
      reject(signal?.reason);
    }
    if (signal?.aborted) stop();
    else signal?.addEventListener("abort", stop, { once: true });
  });
}
