// The listening socket and everything cpp-httplib.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "api/result.h"
#include "server/http/router.h"
#include "server/http/upload_receiver.h"
#include "server/jobs/job_service.h"

namespace server {

struct HttpRules {
  std::string host = "127.0.0.1";
  int port = 8080;  ///< 0: any free one
  UploadLimits upload;
  // A connection holds a thread as long as it is open: the number of threads is the number of clients at
  // once.
  std::size_t threads = 8;
  std::size_t threads_max = 64;
  std::size_t connections_waiting_max = 256;
};

class HttpServer {
 public:
  /// What it is given must outlive it.
  HttpServer(const Router& router, JobService& jobs, const DataFolder& folder, HttpRules rules);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Takes the port. Errors: wrong_state where it is taken or not ours to take.
  api::Status bind();
  int port() const;
  /// Answers requests until `stop`. False: the socket failed.
  bool run();
  /// Any other thread than `run`'s, which must have been started. Requests under way are cut short where they
  /// stream.
  void stop();

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace server
