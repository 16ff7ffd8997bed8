// The text format 0.0.4 of Prometheus.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

namespace server {

class Histogram;

/// family, then its samples, then the next family.
class PrometheusText {
 public:
  using Labels = std::initializer_list<std::pair<std::string_view, std::string_view>>;

  /// `type`: "counter", "gauge" or "histogram". The name ends with its unit, a counter's with _total.
  void family(std::string_view name, std::string_view type, std::string_view help);
  void sample(double value, Labels labels = {});
  void sample(const Histogram& histogram, Labels labels = {});

  const std::string& text() const { return text_; }

 private:
  void line(std::string_view suffix, Labels labels, std::string_view more_label, double value);

  std::string name_;
  std::string text_;
};

}  // namespace server
