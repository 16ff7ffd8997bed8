// Numbers, times and sizes as people read them. Figures are meant for tabular digits.

/** 0.0 .. 1 as "42 %". */
export function percent(fraction: number): string {
  return `${Math.floor(Math.min(Math.max(fraction, 0), 1) * 100)} %`;
}

/** Bytes by powers of 1000, as disks and downloads are sold: "1.4 MB". */
export function bytes(count: number): string {
  const units = ["B", "kB", "MB", "GB", "TB", "PB"];
  let value = Math.max(count, 0);
  let unit = 0;
  while (value >= 999.5 && unit + 1 < units.length) {
    value /= 1000;
    ++unit;
  }
  return `${unit === 0 || value >= 99.5 ? Math.round(value) : value.toPrecision(2)} ${units[unit]}`;
}

/** "45 s", "3 min 20 s", "2 h 5 min", "4 d 2 h"; below a second with one digit after the point. */
export function duration(seconds: number): string {
  if (seconds < 0.95) return `${Math.max(seconds, 0).toFixed(1)} s`;
  const s = Math.round(seconds);
  if (s < 60) return `${s} s`;
  const parts: [number, string][] =
    s < 3600
      ? [[Math.floor(s / 60), "min"], [s % 60, "s"]]
      : s < 86400
        ? [[Math.floor(s / 3600), "h"], [Math.floor((s % 3600) / 60), "min"]]
        : [[Math.floor(s / 86400), "d"], [Math.floor((s % 86400) / 3600), "h"]];
  return parts.filter(([value]) => value > 0).map(([value, unit]) => `${value} ${unit}`).join(" ");
}

/** A moment of the service (RFC 3339) as "3 min ago", or the date where that is long past. */
export function ago(moment: string, nowMs = Date.now()): string {
  const seconds = (nowMs - Date.parse(moment)) / 1000;
  if (seconds < 5) return "just now";
  if (seconds < 60) return `${Math.floor(seconds)} s ago`;
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ago`;
  if (seconds < 86400) return `${Math.floor(seconds / 3600)} h ago`;
  return new Date(moment).toLocaleDateString(undefined, { year: "numeric", month: "short", day: "numeric" });
}

/** The whole moment, for titles. */
export function moment(text: string): string {
  return new Date(text).toLocaleString(undefined, { dateStyle: "medium", timeStyle: "medium" });
}

/** "1 job", "3 jobs"; thousands set apart. */
export function count(number: number, one: string, many = `${one}s`): string {
  return `${number.toLocaleString("en")} ${number === 1 ? one : many}`;
}
