// How bright light is shown, as the engine's pictures do (engine/image/tone_curve.h): J. Hable, "Uncharted 2: HDR
// Lighting", Game Developers Conference 2010; scaled so that middle grey, 0.18, stays.
const kMiddleGrey = 0.18;
const kWhite = 11.2;

function hable(x: number): number {
  return (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3;
}

/** k: where hable(k 0.18) / hable(11.2) = 0.18, by bisection. */
export const kFilmicScale = ((): number => {
  let low = 1;
  let high = 10;
  for (let step = 0; step < 60; ++step) {
    const middle = 0.5 * (low + high);
    if (hable(middle * kMiddleGrey) < kMiddleGrey * hable(kWhite)) low = middle;
    else high = middle;
  }
  return low;
})();
