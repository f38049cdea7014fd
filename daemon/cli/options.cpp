#include "daemon/cli/options.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <iostream>

#include "proto/file_bytes.hpp"

namespace odomcalib::cli {
namespace {

namespace fs = std::filesystem;

/// Whether the path leads to this program's standard output by name: /dev/stdout, /dev/fd/1. Another name of
/// the same terminal is not what the user asked for.
bool names_standard_output(fs::path path) {
  constexpr int kMostLinks = 40;  // as the kernel
  std::error_code error;
  const fs::path standard = fs::canonical("/proc/self/fd", error) / "1";
  for (int hops = 0; hops < kMostLinks && !error; ++hops) {
    path = fs::canonical(fs::absolute(path, error).parent_path(), error) / path.filename();
    if (error || path == standard) break;
    const fs::path target = fs::read_symlink(path, error);
    if (!error) path = path.parent_path() / target;
  }
  return !error && path == standard;
}

bool is_standard_output(const fs::path& path) {
  std::error_code error;
  return names_standard_output(path) ||
         (fs::is_regular_file(path, error) && fs::equivalent(path, "/proc/self/fd/1", error));
}

/// Anything but a regular file (a terminal, /dev/null) loses nothing when it is named twice.
bool is_kept(const fs::path& path) {
  std::error_code error;
  const auto status = fs::status(path, error);
  return fs::is_regular_file(status) || !fs::exists(status);
}

fs::path place_of(const std::string& path) {
  std::error_code error;
  return fs::weakly_canonical(fs::absolute(behind_links(path), error), error);
}

/// The same device and inode, or the same path where there is no file yet.
bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) || place_of(a) == place_of(b);
}

Result<void> check_apart(const NamedFile& output, const std::vector<NamedFile>& others) {
  for (const NamedFile& other : others) {
    if (other.path.empty() || !same_file(output.path, other.path)) continue;
    return Error{ErrorCode::usage, output.name + " names the same file as " + other.name, output.path,
                 "give it a name of its own; nothing was written"};
  }
  return {};
}

}  // namespace

CLI::Validator finite(double least, double most) {
  const bool bounded = least > std::numeric_limits<double>::lowest();
  const std::string wanted = bounded ? fmt::format("a number from {} to {}", least, most) : "a finite number";
  const auto problem = [=](std::string& text) {
    double value = 0.0;
    const bool good =
        CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value >= least && value <= most;
    return good ? std::string() : fmt::format("\"{}\" is not {}", text, wanted);
  };
  return {problem, bounded ? fmt::format("in [{} - {}]", least, most) : ""};
}

CLI::Validator whole(int least, int most) {
  const auto problem = [=](std::string& text) {
    int value = 0;
    const bool good = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
    return good ? std::string()
                : fmt::format("\"{}\" is not a whole number from {} to {}", text, least, most);
  };
  return {problem, fmt::format("in [{} - {}]", least, most)};
}

CLI::Option* add_output(CLI::App& verb, const std::string& names, std::string& path,
                        const std::string& help) {
  return verb.add_option(names, path, help)->transform([](const std::string& given) {
    return given == "-" ? std::string("/dev/stdout") : given;
  });
}

Result<void> check_outputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs) {
  std::vector<NamedFile> taken = inputs;
  for (const NamedFile& output : outputs) {
    if (output.path.empty()) continue;
    if (is_kept(output.path))
      if (auto apart = check_apart(output, taken); !apart) return apart;
    if (auto writable = check_output(output.path); !writable) return writable;
    if (is_standard_output(output.path)) std::cout.rdbuf(std::cerr.rdbuf());
    taken.push_back(output);
  }
  return {};
}

std::vector<NamedFile> named(const std::string& name, const std::vector<std::string>& paths) {
  std::vector<NamedFile> files;
  files.reserve(paths.size());
  for (const auto& path : paths) files.push_back({name, path});
  return files;
}

}  // namespace odomcalib::cli
