// Time that can be played, with its keys, on a page of its own.
import type { Lifetime } from "../../base/signal";
import { addKeys } from "../../shell/keys";
import type { Playhead } from "../playhead";
import { shuttle, startPlayer, stepBy, toggle } from "./player";

export function startPlaying(playhead: Playhead, lifetime: Lifetime): void {
  startPlayer(playhead, lifetime);
  addKeys(lifetime, "Timeline", [
    { keys: "Space", does: "Play or stop", run: () => toggle(playhead) },
    { keys: "l", does: "Play on; again: faster", run: () => shuttle(playhead, 1) },
    { keys: "j", does: "Play back; again: faster", run: () => shuttle(playhead, -1) },
    { keys: "k", does: "Stop", run: () => (playhead.playing.value = false) },
    { keys: ",", does: "One frame back", run: () => stepBy(playhead, -1) },
    { keys: ".", does: "One frame on", run: () => stepBy(playhead, 1) },
    { keys: "Home", does: "First frame", run: () => stepBy(playhead, -playhead.frameCount) },
    { keys: "End", does: "Last frame", run: () => stepBy(playhead, playhead.frameCount) },
  ]);
}
