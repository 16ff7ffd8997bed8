#include "engine/scene/found.h"

#include <array>
#include <string>
#include <utility>

#include "api/refusal_text.h"

namespace engine {
namespace {

Violations shared(const Found& found) {
  const std::array lists{&found.request, &found.obj, &found.names, &found.materials};
  std::array<std::size_t, lists.size()> taken{};
  std::size_t total = 0;
  for (bool more = true; more;) {
    more = false;
    for (std::size_t k = 0; k < lists.size(); ++k) {
      if (total == api::kViolationsMax || taken[k] == lists[k]->size()) continue;
      ++taken[k];
      ++total;
      more = true;
    }
  }
  Violations all;
  for (std::size_t k = 0; k < lists.size(); ++k)
    all.insert(all.end(), lists[k]->begin(), lists[k]->begin() + static_cast<std::ptrdiff_t>(taken[k]));
  return all;
}

}  // namespace

api::Error refused(const Found& found) {
  Violations all = shared(found);
  std::string message = api::refusal_text(found.request.empty() ? "the scene" : "the job", all.size());
  return {api::Fault::invalid_request, std::move(message), std::move(all)};
}

}  // namespace engine
