// Reads typed values from a TOML file, remembers the first problem, and knows which keys nobody asked for.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "daemon/config/settings.hpp"
#include "proto/result.hpp"

namespace odomcalib {

/// Keys are dotted paths ("lidar.device"). A missing key yields the default; a value of the wrong type or out
/// of range yields the default too, and problem() says so.
class TomlReader {
 public:
  /// @param manual page that lists the keys, for messages: "odomcalib.toml(5)"
  /// Errors: io, format (line and column).
  static Result<TomlReader> read(const std::filesystem::path& path, const std::string& manual);
  static Result<TomlReader> parse(const std::string& text, const std::string& where,
                                  const std::string& manual);

  TomlReader(TomlReader&&) noexcept;
  TomlReader& operator=(TomlReader&&) noexcept;
  ~TomlReader();

  double number(const std::string& key, double otherwise, const config::settings::Bounds& allowed);
  std::string text(const std::string& key, const std::string& otherwise);
  bool flag(const std::string& key, bool otherwise);
  /// [x, y, yaw] of a lidar in the base: m, m, rad, all within the bounds of the settings.
  std::optional<std::array<double, 3>> pose(const std::string& key);

  /// Whether the file has this section.
  [[nodiscard]] bool has_table(const std::string& key) const;
  /// Keys that begin with `prefix` are somebody else's: problem() does not judge them.
  void leave(const std::string& prefix);
  /// A key of other programs, and what to write here instead: problem() says so.
  void translate(const std::string& foreign, const std::string& instead);

  /// The first wrong value, otherwise the first key that was never asked for (a misspelling), with the key
  /// that was probably meant.
  [[nodiscard]] std::optional<Error> problem() const;

 private:
  struct State;
  explicit TomlReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace odomcalib
