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

/// GET /docs, operationId getDocs.
HttpAnswer get_docs() {
  HttpAnswer answer;
  answer.content_type = "text/html; charset=utf-8";
  answer.body = docs_page();
  static const std::string etag = sha256_of(docs_page());
  answer.etag = etag;
  answer.headers = {
      {"Cache-Control", "no-cache"},
      {"Content-Security-Policy", "default-src 'none'; style-src '" + std::string(docs_style_hash()) +
                                      "'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"}};
  return answer;
}

}  // namespace

void add_service_routes(Router& router) {
  router.add("GET", "/healthz", [](const auto&, const auto&) { return json_answer(R"({"status":"ok"})"); });
  router.add("GET", "/version", [](const auto&, const auto&) {
    return json_answer(api::json_text(
        {{"name", "keylume"}, {"version", KEYLUME_VERSION}, {"worker_sandbox", text_of(worker_sandbox())}}));
  });
  router.add("GET", "/openapi.json", [](const auto&, const auto&) { return get_openapi(); });
  router.add("GET", "/docs", [](const auto&, const auto&) { return get_docs(); });
}

}  // namespace server
