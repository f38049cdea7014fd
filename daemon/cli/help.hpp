// Output of --help: it fits a terminal as it opens, and every verb shows how it is called.
#pragma once

namespace CLI {  // NOLINT(readability-identifier-naming): the library's name
class App;
}

namespace odomcalib::cli {

/// Lays out the help of this program and of all verbs that are added to it afterwards.
void lay_out_help(CLI::App& app);

}  // namespace odomcalib::cli
