// Linear RGB with the primaries of Rec. 709: reflectance [-], radiosity and exitance [W/m^2], radiance.
#pragma once

#include <algorithm>

namespace engine {

struct Rgb {
  float r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

inline Rgb operator+(Rgb a, Rgb b) {
  return {a.r + b.r, a.g + b.g, a.b + b.b};
}
inline Rgb operator-(Rgb a, Rgb b) {
  return {a.r - b.r, a.g - b.g, a.b - b.b};
}
inline Rgb operator*(Rgb a, Rgb b) {
  return {a.r * b.r, a.g * b.g, a.b * b.b};
}
inline Rgb operator*(Rgb a, float s) {
  return {a.r * s, a.g * s, a.b * s};
}
inline Rgb operator*(float s, Rgb a) {
  return a * s;
}
inline Rgb& operator+=(Rgb& a, Rgb b) {
  return a = a + b;
}
/// Of each channel the larger.
inline Rgb max(Rgb a, Rgb b) {
  return {std::max(a.r, b.r), std::max(a.g, b.g), std::max(a.b, b.b)};
}
inline float max_channel(Rgb a) {
  return std::max({a.r, a.g, a.b});
}

}  // namespace engine
