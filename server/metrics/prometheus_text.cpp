#include "server/metrics/prometheus_text.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "server/metrics/histogram.h"

namespace server {
namespace {

/// As the format wants it: backslash, double quote and end of line escaped.
std::string escaped(std::string_view value) {
  std::string text;
  for (const char c : value) {
    if (c == '\\' || c == '"') text += '\\';
    if (c == '\n')
      text += "\\n";
    else
      text += c;
  }
  return text;
}

std::string number(double value) {
  if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.15g", value);
  return text.data();
}

}  // namespace

void PrometheusText::family(std::string_view name, std::string_view type, std::string_view help) {
  name_ = name;
  text_ += "# HELP " + name_ + " " + escaped(help) + "\n# TYPE " + name_ + " " + std::string(type) + "\n";
}

void PrometheusText::line(std::string_view suffix, Labels labels, std::string_view more_label, double value) {
  std::string list;
  for (const auto& [name, label] : labels)
    list += (list.empty() ? "" : ",") + std::string(name) + "=\"" + escaped(label) + "\"";
  if (!more_label.empty()) list += (list.empty() ? "" : ",") + std::string(more_label);
  text_ += name_ + std::string(suffix) + (list.empty() ? "" : "{" + list + "}") + " " + number(value) + "\n";
}

void PrometheusText::sample(double value, Labels labels) {
  line("", labels, "", value);
}

void PrometheusText::sample(const Histogram& histogram, Labels labels) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < histogram.counts().size(); ++i) {
    count += histogram.counts()[i];
    const bool last = i == histogram.bounds().size();
    const std::string bound = last ? "+Inf" : number(histogram.bounds()[i]);
    line("_bucket", labels, "le=\"" + bound + "\"", static_cast<double>(count));
  }
  line("_sum", labels, "", histogram.sum());
  line("_count", labels, "", static_cast<double>(count));
}

}  // namespace server
