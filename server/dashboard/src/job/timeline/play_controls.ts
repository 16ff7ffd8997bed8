// Play and the slider of frames, wherever there is time to go through.
import { h } from "../../base/h";
import type { Lifetime } from "../../base/signal";
import type { Playhead } from "../playhead";
import { toggle } from "./player";

export function playButton(playhead: Playhead, lifetime: Lifetime): HTMLButtonElement {
  const button = h("button", { type: "button", class: "timeline-play", onclick: () => toggle(playhead) });
  lifetime.add(playhead.playing.watch((playing) => (button.textContent = playing ? "Stop" : "Play")));
  return button;
}

/** Who moves it stops what plays. */
export function frameSlider(playhead: Playhead, lifetime: Lifetime, label = "Frame"): HTMLInputElement {
  const input = h("input", {
    type: "range", class: "timeline-slider", min: 0, max: playhead.frameCount - 1, step: 1, "aria-label": label,
    oninput: () => {
      playhead.playing.value = false;
      playhead.time.value = Number(input.value);
    },
  });
  lifetime.add(playhead.time.watch(() => {
    input.value = String(playhead.frame);
    input.setAttribute("aria-valuetext", `frame ${playhead.frame}`);
  }));
  return input;
}
