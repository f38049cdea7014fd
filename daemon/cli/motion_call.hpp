// A method of the daemon that moves the robot or writes: consent, lease, progress.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "daemon/cli/client.hpp"
#include "daemon/cli/verbs.hpp"
#include "proto/result.hpp"

namespace odomcalib::cli {

/// Options that every such verb has.
struct Consent {
  bool yes = false;
  bool dry_run = false;
  WhenInterrupted interrupted = WhenInterrupted::stop;
  Client* on = nullptr;  ///< see call_with_lease
};

/// Asks for consent where it was not given, and runs the method with the lease. With dry_run nothing moves.
/// @return "result" of the daemon's answer
Result<nlohmann::ordered_json> run_method(const Session& session, const Consent& consent,
                                          const std::string& method, nlohmann::ordered_json parameters);

void add_consent(CLI::App& verb, Consent& consent);

}  // namespace odomcalib::cli
