// Labels as they are shown, typed and sought everywhere: name=value, or the name alone; several with commas between.

const kName = /^[A-Za-z0-9_.-]{1,64}$/;

function split(pair: string): [name: string, value: string | null] {
  const at = pair.indexOf("=");
  return at < 0 ? [pair.trim(), null] : [pair.slice(0, at).trim(), pair.slice(at + 1).trim()];
}

function pairsOf(text: string): string[] {
  return text.split(",").map((pair) => pair.trim()).filter((pair) => pair !== "");
}

export function labelText(name: string, value: string): string {
  return value === "" ? name : `${name}=${value}`;
}

/** "project=garage, take=3" -> { project: "garage", take: "3" } */
export function labelsOf(text: string): Record<string, string> {
  return Object.fromEntries(pairsOf(text).map(split).map(([name, value]) => [name, value ?? ""]));
}

/** The other way round. */
export function labelsText(labels: Readonly<Record<string, string>>): string {
  return Object.entries(labels).map(([name, value]) => labelText(name, value)).join(", ");
}

/** A word that asks for a label's value, as the search takes it. */
export function isLabel(word: string): boolean {
  const [name, value] = split(word);
  return value !== null && kName.test(name);
}

/** The service's filters of what is typed ("name:value", "name": with any value), and what no label can be called. */
export function labelFilters(text: string): { filters: string[]; wrong: string[] } {
  const filters: string[] = [];
  const wrong: string[] = [];
  for (const pair of pairsOf(text)) {
    const [name, value] = split(pair);
    if (!kName.test(name)) wrong.push(pair);
    else filters.push(value === null ? name : `${name}:${value}`);
  }
  return { filters, wrong };
}
