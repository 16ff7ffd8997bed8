// Three small scenes with things in the way of light, whose exact radiosity dense_radiosity.h can find.
#pragma once

#include "tests/support/scenes.h"

namespace tests {

/// A block at rest, and one that flies past it and has turned in the second of two frames.
SceneBuilder blocks_of_which_one_moves();

/// A tilted sheet of which both sides are patches, between a lamp and the floor.
SceneBuilder open_sheet();

/// Two blocks, one of them turned, between coloured walls under a warm lamp.
SceneBuilder coloured_blocks();

}  // namespace tests
