#include "api/json/json_text.h"
#include "server/artefacts/verify.h"
#include "server/http/routes.h"
#include "server/workers/sandbox.h"

namespace server {
namespace {

HttpAnswer get_openapi() {
  HttpAnswer answer = json_answer(std::string(openapi_json()));
  static const std::string etag = sha256_of(openapi_json());
  answer.etag = etag;
  return answer;
}

}  // namespace

void add_service_routes(Router& router) {
  router.add("GET", "/healthz", [](const auto&, const auto&) { return json_answer(R"({"status":"ok"})"); });
  router.add("GET", "/version", [](const auto&, const auto&) {
    return json_answer(api::json_text({{"name", "keylume"},
                                       {"version", KEYLUME_VERSION},
                                       {"worker_sandbox", text_of(worker_sandbox())}}));
  });
  router.add("GET", "/openapi.json", [](const auto&, const auto&) { return get_openapi(); });
}

}  // namespace server
