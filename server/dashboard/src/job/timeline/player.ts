// Lets time go on while it is played.
import type { Lifetime } from "../../base/signal";
import type { Playhead } from "../playhead";

/** After a hitch (a hidden tab) time goes on from where it was. */
const kStepMs = 100;

export function startPlayer(playhead: Playhead, lifetime: Lifetime): void {
  let wanted = 0;
  let last = 0;
  const step = (now: number): void => {
    wanted = 0;
    if (!playhead.playing.value) return;
    advance(playhead, Math.min(now - last, kStepMs) / 1000);
    last = now;
    wanted = requestAnimationFrame(step);
  };
  lifetime.add(
    playhead.playing.watch((playing) => {
      if (!playing) settle(playhead);
      if (!playing || wanted !== 0) return;
      last = performance.now();
      wanted = requestAnimationFrame(step);
    }),
    () => cancelAnimationFrame(wanted),
  );
}

/** Where it stops, a stored frame is shown. */
function settle(playhead: Playhead): void {
  playhead.time.value = playhead.frame;
}

function advance(playhead: Playhead, seconds: number): void {
  const end = playhead.frameCount - 1;
  let time = playhead.time.value + seconds * playhead.speed.value;
  if (time > end || time < 0) {
    if (!playhead.loop.value) {
      playhead.playing.value = false;
      time = Math.min(Math.max(time, 0), end);
    } else {
      time = time > end ? 0 : end;
    }
  }
  playhead.time.value = time;
}

/** J, K, L as in editors: back, stop, on; again is twice as fast. */
export function shuttle(playhead: Playhead, direction: 1 | -1): void {
  const { speed, playing } = playhead;
  const goes = playing.value && Math.sign(speed.value) === direction;
  const faster = Math.min(Math.abs(speed.value) * 2, playhead.fps * 8);
  speed.value = direction * (goes ? faster : playhead.fps);
  playing.value = true;
}

export function toggle(playhead: Playhead): void {
  if (!playhead.playing.value) {
    playhead.speed.value = playhead.fps;
    if (playhead.frame === playhead.frameCount - 1 && !playhead.loop.value) playhead.time.value = 0;
  }
  playhead.playing.value = !playhead.playing.value;
}

export function stepBy(playhead: Playhead, frames: number): void {
  playhead.playing.value = false;
  const end = playhead.frameCount - 1;
  playhead.time.value = Math.min(Math.max(playhead.frame + frames, 0), end);
}
