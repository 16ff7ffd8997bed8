// What went wrong with a request, told so that people and forms can act on it.
import type { Problem, ProblemError } from "./types";

export class ApiError extends Error {
  override readonly name = "ApiError";

  constructor(
    /** HTTP status; 0: the service was not reached at all. */
    readonly status: number,
    message: string,
    /** Every place to fix; empty where the request's content is not at fault. */
    readonly errors: readonly ProblemError[] = [],
    /** The service's own word for the kind of problem. */
    readonly type = "about:blank",
    /** When to try again; null: it does not say. */
    readonly retryAfterSeconds: number | null = null,
  ) {
    super(message);
  }

  get offline(): boolean {
    return this.status === 0;
  }

  /** The place to fix that this JSON pointer of this file names, or lies in it; null: none does. */
  at(pointer: string, file?: string): ProblemError | null {
    return this.errors.find((error) => (file === undefined || error.file === file) && error.pointer === pointer) ?? null;
  }
}

export async function errorOf(response: Response): Promise<ApiError> {
  const seconds = Number(response.headers.get("Retry-After") ?? "");
  const retry = Number.isFinite(seconds) && seconds > 0 ? seconds : null;
  try {
    const problem = (await response.json()) as Problem;
    const message = problem.detail || problem.title || `the service answered ${response.status}`;
    return new ApiError(response.status, message, problem.errors ?? [], problem.type, retry);
  } catch {
    // A proxy before the service answers in its own words.
    return new ApiError(response.status, `the service answered ${response.status} ${response.statusText}`.trim(), [], undefined, retry);
  }
}

/** For a toast or a line of text: what happened, and what to do where that is known. */
export function messageOf(error: unknown): string {
  if (!(error instanceof ApiError)) return error instanceof Error ? error.message : String(error);
  if (error.offline) return `${sentence(error.message)} It is tried again by itself.`;
  const wait = error.retryAfterSeconds === null ? "" : ` Try again in ${error.retryAfterSeconds} s.`;
  const places = error.errors.slice(0, 3).map((place) => `${placeOf(place)}: ${place.detail}`);
  return [sentence(error.message) + wait, ...places].join(" ");
}

function sentence(text: string): string {
  const upper = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(upper) ? upper : `${upper}.`;
}

/** "animation.json /images/0/camera", "scene.obj line 12". */
export function placeOf(error: ProblemError): string {
  const line = error.line === undefined ? "" : ` line ${error.line}${error.column === undefined ? "" : `:${error.column}`}`;
  return `${error.file}${error.pointer ? ` ${error.pointer}` : ""}${line}`.trim() || error.code;
}
