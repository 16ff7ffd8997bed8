// How long a job takes, told the same wherever it is told before it runs.
import { duration } from "./format";

/** "about 16 s", "about 2 min": a forecast is good to a third or so, not to the second. */
export function forecastText({ seconds }: { readonly seconds: number }): string {
  return `about ${duration(rounded(seconds))}`;
}

/** To a step that is not finer than what is known. */
function rounded(seconds: number): number {
  if (seconds < 1) return 1;
  const step = seconds < 20 ? 1 : seconds < 90 ? 5 : seconds < 600 ? 30 : seconds < 7200 ? 300 : 1800;
  return Math.round(seconds / step) * step;
}
