#include "server/jobs/without_folder.h"

namespace server {

std::string without_folder(std::string_view text, std::string_view folder) {
  std::string changed;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t found = text.find(folder, at);
    changed += text.substr(at, found - at);
    if (found == text.npos) break;
    at = found + folder.size();
    if (at < text.size() && text[at] == '/')
      ++at;
    else
      changed += '.';
  }
  return changed;
}

void leave_out_folder(std::string_view folder, api::JobReport& report) {
  report.message = without_folder(report.message, folder);
  for (std::string& warning : report.warnings) warning = without_folder(warning, folder);
  for (api::Violation& violation : report.violations) {
    violation.file = without_folder(violation.file, folder);
    violation.detail = without_folder(violation.detail, folder);
  }
}

}  // namespace server
