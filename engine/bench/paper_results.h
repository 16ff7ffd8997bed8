// What Besuievsky & Pueyo report, to stand beside ours.
#pragma once

#include <array>

namespace engine {

/// A column of their Table 2 or 3 (120 frames, Pentium III at 450 MHz). 0: not reported.
struct PaperColumn {
  const char* run;  ///< of ours beside it
  int key_frames;
  double estimation_s;
  double computation_min;
  double per_frame_s;
  double absolute_speed_up, relative_speed_up;
  double memory_mb;
  double rmse_average;  ///< in a unit they do not name
};

inline constexpr std::array<PaperColumn, 3> kPaperTable2{{
    {"garage_eps_0.1", 75, 30, 52, 26, 36, 1.38, 150, 1.3e-4},
    {"garage_eps_0.2", 39, 30, 34, 17, 55, 2.11, 80, 3.9e-4},
    {"garage_full", 120, 0, 73, 35, 26, 1, 250, 0},
}};
inline constexpr std::array<PaperColumn, 2> kPaperTable3{{
    {"garage_off_eps_0.1", 61, 30, 44, 22, 42, 1.6, 125, 1.7e-4},
    {"garage_off_full", 120, 0, 71, 35, 26, 1, 250, 0},
}};
inline constexpr std::array<PaperColumn, 1> kPaperOffice{{
    {"office_eps_0.05", 34, 0, 0, 50, 23.3, 2.5, 0, 0},
}};

}  // namespace engine
