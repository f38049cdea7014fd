// Content of a recording and what solve would take of it, before anything is measured.
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/inspection.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/recordings.hpp"

namespace odomcalib::cli {
namespace {

struct InspectOptions {
  std::string recording;
  RecordingOptions reading;
};

int inspect_recording(const InspectOptions& options, const Session& session) {
  const auto found = [&] {
    const Meanwhile shown("reading " + options.recording);
    return inspect(options.recording, options.reading);
  }();
  if (!found) return report_error(found.error(), session.json);
  if (session.json == JsonMode::off)
    print_text(describe(found.value()), session.legend);
  else
    print_document("inspection", to_json(found.value()), session.json);
  return kDone;
}

}  // namespace

void add_inspect(CLI::App& app, Session& session) {
  const auto [verb, options] = add_verb(
      app, session, "inspect", "What a recording holds, and what solve would take of it", inspect_recording);
  verb->add_option("RECORDING", options->recording, "in any form that solve reads")->required();
  add_reading_options(*verb, options->reading);
}

}  // namespace odomcalib::cli
