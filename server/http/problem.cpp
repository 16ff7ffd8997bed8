#include "server/http/problem.h"

#include <array>
#include <utility>

#include "api/json/json_text.h"
#include "server/log.h"
#include "server/store/job_store.h"

namespace server {
namespace {

constexpr std::string_view kRetryAfterSeconds = "30";

constexpr std::array kTitles{
    std::pair{400, std::string_view("Bad Request")},
    std::pair{401, std::string_view("Unauthorized")},
    std::pair{403, std::string_view("Forbidden")},
    std::pair{404, std::string_view("Not Found")},
    std::pair{405, std::string_view("Method Not Allowed")},
    std::pair{408, std::string_view("Request Timeout")},
    std::pair{409, std::string_view("Conflict")},
    std::pair{411, std::string_view("Length Required")},
    std::pair{412, std::string_view("Precondition Failed")},
    std::pair{413, std::string_view("Content Too Large")},
    std::pair{414, std::string_view("URI Too Long")},
    std::pair{415, std::string_view("Unsupported Media Type")},
    std::pair{416, std::string_view("Range Not Satisfiable")},
    std::pair{417, std::string_view("Expectation Failed")},
    std::pair{421, std::string_view("Misdirected Request")},
    std::pair{422, std::string_view("Unprocessable Content")},
    std::pair{429, std::string_view("Too Many Requests")},
    std::pair{431, std::string_view("Request Header Fields Too Large")},
    std::pair{500, std::string_view("Internal Server Error")},
    std::pair{501, std::string_view("Not Implemented")},
    std::pair{503, std::string_view("Service Unavailable")},
    std::pair{505, std::string_view("HTTP Version Not Supported")},
    std::pair{507, std::string_view("Insufficient Storage")},
};

int status_of(api::Fault fault) {
  switch (fault) {
    case api::Fault::invalid_request:
      return 422;
    case api::Fault::not_found:
      return 404;
    case api::Fault::wrong_state:
      return 409;
    case api::Fault::out_of_resources:
    case api::Fault::stopped:
      return 503;
    case api::Fault::changed:
      return 412;
    case api::Fault::too_many:
      return 429;
    case api::Fault::disk_full:
    case api::Fault::over_quota:
      return 507;
    case api::Fault::internal:
      break;
  }
  return 500;
}

HttpAnswer problem_answer(const api::Error& error, int status, std::string_view instance) {
  HttpAnswer answer;
  answer.status = status;
  answer.content_type = "application/problem+json";
  answer.body = api::problem_json(error, status, title_of(status), instance);
  if (status == 503 || status == 429) answer.headers.emplace_back("Retry-After", kRetryAfterSeconds);
  return answer;
}

}  // namespace

HttpAnswer problem(const api::Error& error, std::string_view instance) {
  const int status = status_of(error.fault);
  const bool disk_full = error.fault == api::Fault::disk_full;
  if (status == 500 || disk_full) log_line(std::string(instance) + ": " + error.message);
  // Whoever asks for a damaged file is told so; other paths, SQL and the like are for the operator.
  const bool damaged = !error.violations.empty() && error.violations.front().code == kDamagedFile;
  if (damaged) return problem_answer(error, status, instance);
  if (status == 500)
    return problem_answer({error.fault, "something failed inside the service; its log says what"}, status,
                          instance);
  if (disk_full) return problem_answer({error.fault, "the disk of the service is full"}, status, instance);
  return problem_answer(error, status, instance);
}

HttpAnswer problem(int status, std::string_view detail, std::string_view instance) {
  const api::Fault fault = status == 404 ? api::Fault::not_found : api::Fault::invalid_request;
  return problem_answer({fault, std::string(detail)}, status, instance);
}

HttpAnswer problem(int status, const api::Error& error, std::string_view instance) {
  return problem_answer(error, status, instance);
}

HttpAnswer bad_parameter(std::string_view name, std::string_view code, std::string_view detail,
                         std::string_view instance) {
  return problem_answer({api::Fault::invalid_request,
                         std::string(detail),
                         {{std::string(name), "", 0, 0, std::string(code), std::string(detail)}}},
                        400, instance);
}

std::string_view title_of(int status) {
  for (const auto& [number, title] : kTitles)
    if (number == status) return title;
  return "Error";
}

}  // namespace server
