// The rules of each part, from what the operator asked for.
#pragma once

#include <filesystem>

#include "api/result.h"
#include "server/auth/token_folder.h"
#include "server/config.h"
#include "server/http/http_server.h"
#include "server/jobs/integrity_check.h"
#include "server/jobs/job_service.h"
#include "server/workers/doorbell.h"
#include "server/workers/supervisor.h"
#include "server/workers/view_service.h"

namespace server {

JobRules job_rules(const Config& config, const Doorbell& bell);
ViewRules view_rules(const Config& config);
IntegrityRules integrity_rules(const Config& config);
WorkerRules worker_rules(const Config& config);
HttpRules http_rules(const Config& config);
/// Of the second listener.
HttpRules ops_http_rules(const Address& ops);
GateRules gate_rules(const Config& config);
/// Prometheus and health checks on this machine need no token; from others they need one as everybody does.
GateRules ops_gate_rules(const Config& config, const Address& ops);

/// Refuses (invalid_request) to listen where others can reach us while nobody has a valid token.
api::Status check_who_may_enter(const Config& config, const TokenFolder& tokens);

/// Can a worker be started at all? On a thread of any kind; takes milliseconds, 5 s at most.
api::Status start_worker_once(const std::filesystem::path& program);

}  // namespace server
