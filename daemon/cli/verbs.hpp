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

// Offline: need no daemon.
void add_solve(CLI::App& app, Session& session);
void add_predict(CLI::App& app, Session& session);
void add_convert(CLI::App& app, Session& session);
void add_decode(CLI::App& app, Session& session);
void add_match(CLI::App& app, Session& session);
void add_report(CLI::App& app, Session& session);
void add_export(CLI::App& app, Session& session);
void add_graph(CLI::App& app, Session& session);

// Ask the daemon.
int show_status(const Session& session);
int show_checks(const Session& session);
void add_questions(CLI::App& app, Session& session);
void add_wait(CLI::App& app, Session& session);
void add_monitor(CLI::App& app, Session& session);
void add_view(CLI::App& app, Session& session);
void add_record(CLI::App& app, Session& session);
void add_manual(CLI::App& app, Session& session);
void add_motions(CLI::App& app, Session& session);

}  // namespace odomcalib::cli
