// How a verb gets its options and is run with them; numbers on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "daemon/cli/verbs.hpp"
#include "proto/result.hpp"

namespace odomcalib::cli {

/// A verb and its options, with which main runs it once it was parsed.
template <typename Options>
std::pair<CLI::App*, std::shared_ptr<Options>> add_verb(CLI::App& parent, Session& session, const char* name,
                                                        const char* help,
                                                        int (*run)(const Options&, const Session&)) {
  CLI::App* const verb = parent.add_subcommand(name, help);
  const auto options = std::make_shared<Options>();
  verb->callback([&session, options, run] {
    session.run = [&session, options, run] { return run(*options, session); };
  });
  return {verb, options};
}

/// Takes finite numbers from `least` to `most`. CLI::Range lets NaN pass, and NaN becomes null in JSON.
CLI::Validator finite(double least = std::numeric_limits<double>::lowest(),
                      double most = std::numeric_limits<double>::max());

/// Takes whole numbers from `least` to `most`.
CLI::Validator whole(int least, int most);

/// An option that names a file to write, alike for every verb: "-" is the standard output, as /dev/stdout is.
/// @param path outlives the parsing
CLI::Option* add_output(CLI::App& verb, const std::string& names, std::string& path, const std::string& help);

struct NamedFile {
  std::string name;  ///< of the option or argument, for people
  std::string path;  ///< empty: not asked for
};

/// Error: usage, when an output is an input or another output, whatever links and relative paths they are
/// named by; io, when it could not be written. Where one of them is the standard output (/dev/stdout), what
/// the verb prints goes to standard error from then on: the file alone is what the next program reads.
Result<void> check_outputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs);

/// Files of one argument that may be repeated.
std::vector<NamedFile> named(const std::string& name, const std::vector<std::string>& paths);

}  // namespace odomcalib::cli
