// The event stream format of the HTML standard, from bytes as they come in. Our own reader, because EventSource can
// neither say why it failed nor go on from an event that another one received.

export interface StreamEvent {
  id: string | null;
  type: string;
  data: string;
}

export class EventStreamParser {
  private rest = "";
  private id: string | null = null;
  private type = "";
  private data: string[] = [];

  /** The events that `text` completes. */
  take(text: string): StreamEvent[] {
    const events: StreamEvent[] = [];
    const lines = (this.rest + text).split("\n");
    this.rest = lines.pop() ?? "";
    for (const line of lines) {
      const clean = line.endsWith("\r") ? line.slice(0, -1) : line;
      if (clean === "") this.dispatch(events);
      else this.field(clean);
    }
    return events;
  }

  private field(line: string): void {
    const colon = line.indexOf(":");
    if (colon === 0) return; // a comment: somebody is there
    const name = colon < 0 ? line : line.slice(0, colon);
    const value = colon < 0 ? "" : line.slice(colon + 1).replace(/^ /, "");
    if (name === "data") this.data.push(value);
    else if (name === "event") this.type = value;
    else if (name === "id") this.id = value;
  }

  private dispatch(events: StreamEvent[]): void {
    if (this.data.length > 0) events.push({ id: this.id, type: this.type || "message", data: this.data.join("\n") });
    this.id = null;
    this.type = "";
    this.data = [];
  }
}
