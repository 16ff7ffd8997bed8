// A value that tells when it changes. What several parts of a page share is a Signal, never a global.

export type Stop = () => void;

export class Signal<T> {
  private readonly listeners = new Set<(value: T) => void>();

  constructor(private current: T) {}

  get value(): T {
    return this.current;
  }

  /** Tells the listeners, unless nothing changed. */
  set value(next: T) {
    if (Object.is(next, this.current)) return;
    this.current = next;
    for (const listener of [...this.listeners]) listener(next);
  }

  /** Calls `listener` now and at every change, until the returned function is called. */
  watch(listener: (value: T) => void): Stop {
    this.listeners.add(listener);
    listener(this.current);
    return () => void this.listeners.delete(listener);
  }
}

/** Collects what must be undone when a page or a part of it closes. */
export class Lifetime {
  private readonly stops: Stop[] = [];
  private over = false;

  get ended(): boolean {
    return this.over;
  }

  add(...stops: Stop[]): void {
    if (this.over) for (const stop of stops) stop();
    else this.stops.push(...stops);
  }

  /** Last in, first out. */
  end(): void {
    this.over = true;
    for (const stop of this.stops.splice(0).reverse()) stop();
  }

  listen<K extends keyof WindowEventMap>(target: Window, type: K, listener: (event: WindowEventMap[K]) => void): void;
  listen<K extends keyof HTMLElementEventMap>(target: EventTarget, type: K, listener: (event: HTMLElementEventMap[K]) => void): void;
  listen(target: EventTarget, type: string, listener: (event: never) => void): void {
    target.addEventListener(type, listener as EventListener);
    this.add(() => target.removeEventListener(type, listener as EventListener));
  }
}
