// The verbs, one file each. A verb registers itself and sets `run`, which main calls after parsing.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "daemon/cli/output.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's name
class App;
}

namespace odomcalib::cli {

struct Session {
  JsonMode json = JsonMode::off;
  bool legend = true;
  bool verbose = false;                           ///< everything instead of a summary
  std::string socket = "/run/odomcalib/control";  ///< of the daemon
  bool takes_much_memory = false;                 ///< whether the verb that was parsed does
  std::function<int()> run;                       ///< set by the verb that was parsed
};

using AddVerb = void(CLI::App& app, Session& session);
// Offline: need no daemon.
AddVerb add_solve, add_predict, add_convert, add_decode, add_match, add_report, add_compare, add_inspect,
    add_export, add_graph;
// Ask the daemon.
AddVerb add_questions, add_wait, add_monitor, add_view, add_record, add_manual, add_motions;
int show_status(const Session& session);
int show_checks(const Session& session);

}  // namespace odomcalib::cli
