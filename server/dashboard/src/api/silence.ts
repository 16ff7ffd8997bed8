/** Aborts what nobody has said anything on for too long: a connection can be dead without anybody noticing. */
export class Silence {
  /** It was this that aborted. */
  tooLong = false;
  private timer: ReturnType<typeof setTimeout>;

  constructor(
    private readonly controller: AbortController,
    private readonly ms: number,
  ) {
    this.timer = this.wait();
  }

  broken(): void {
    clearTimeout(this.timer);
    this.timer = this.wait();
  }

  end(): void {
    clearTimeout(this.timer);
  }

  private wait(): ReturnType<typeof setTimeout> {
    return setTimeout(() => {
      this.tooLong = true;
      this.controller.abort();
    }, this.ms);
  }
}
