// Eight animations of different kinds, small enough to be solved frame by frame in seconds.
#pragma once

#include <string>
#include <vector>

#include "tests/support/scenes.h"

namespace tests {

struct AnimatedScene {
  std::string name;
  SceneBuilder built;
};

/// A fast small object, a slow large one, a blinking light, an opening door, a light carried through columns,
/// two objects crossing, a static scene, a camera only. Rooms of about 6 x 4 x 2.5 m, grey or coloured; cut
/// into patches of half a metre each has 300 to 700.
std::vector<AnimatedScene> animated_scenes();

}  // namespace tests
