// /readyz, which answers 503 with a body when something is wrong, and /metrics, which is no JSON.
import { ApiError } from "../api/api_error";
import { fetchBytes, kSilenceMsMax } from "../api/client";

export interface Readiness {
  ready: boolean;
  checks: Record<string, string>;
}

export interface Sample {
  name: string;
  labels: string;
  value: number;
}

export async function fetchReadiness(): Promise<Readiness> {
  let response: Response;
  try {
    response = await fetch("/readyz", { cache: "no-store", signal: AbortSignal.timeout(kSilenceMsMax) });
  } catch {
    throw new ApiError(0, "The service does not answer. Is it running?");
  }
  const { status, checks } = (await response.json()) as { status: string; checks: Record<string, string> };
  return { ready: status === "ready", checks };
}

/** Null: this is not for whoever asks. */
export async function fetchSamples(): Promise<Sample[] | null> {
  try {
    return parseSamples(await (await fetchBytes("/metrics")).text());
  } catch (error) {
    if (error instanceof ApiError && error.status === 403) return null;
    throw error;
  }
}

/** Lines of the Prometheus text format: NAME{LABELS} VALUE. */
export function parseSamples(text: string): Sample[] {
  return text.split("\n").flatMap((line): Sample[] => {
    const match = /^([a-z_:][\w:]*)(\{.*\})? (\S+)$/i.exec(line);
    return match ? [{ name: match[1]!, labels: match[2] ?? "", value: Number(match[3]) }] : [];
  });
}

export function sampleOf(samples: readonly Sample[], name: string): number | null {
  return samples.find((sample) => sample.name === name)?.value ?? null;
}
