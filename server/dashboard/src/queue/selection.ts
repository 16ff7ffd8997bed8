// Which jobs are chosen: one by one, or all between two (Shift).
import { Signal } from "../base/signal";

export class Selection {
  readonly ids = new Signal<ReadonlySet<string>>(new Set());
  private anchor: string | null = null;

  has(id: string): boolean {
    return this.ids.value.has(id);
  }

  toggle(id: string): void {
    const next = new Set(this.ids.value);
    if (!next.delete(id)) next.add(id);
    this.anchor = id;
    this.ids.value = next;
  }

  /** From the one chosen before to this one, in the order they are shown. */
  extendTo(id: string, shown: readonly string[]): void {
    const from = this.anchor === null ? -1 : shown.indexOf(this.anchor);
    const to = shown.indexOf(id);
    if (from < 0 || to < 0) return this.toggle(id);
    const between = shown.slice(Math.min(from, to), Math.max(from, to) + 1);
    this.ids.value = new Set([...this.ids.value, ...between]);
  }

  setAll(ids: readonly string[]): void {
    this.ids.value = new Set(ids);
  }

  /** Those that are not shown any more cannot be meant. */
  keepOnly(shown: readonly string[]): void {
    const there = new Set(shown);
    const next = [...this.ids.value].filter((id) => there.has(id));
    if (next.length !== this.ids.value.size) this.ids.value = new Set(next);
  }

  clear(): void {
    this.anchor = null;
    if (this.ids.value.size > 0) this.ids.value = new Set();
  }
}
