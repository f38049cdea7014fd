// Typed access to the keys of a profile; remembers the first problem, with the key and what is allowed.
#pragma once

#include <toml++/toml.h>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "drivers/base/canopen/object.hpp"
#include "drivers/base/canopen/pdo.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers {

/// Shared by the readers of all tables of one file.
struct ProfileProblem {
  std::string where;
  std::optional<Error> first;
};

class ProfileTable {
 public:
  /// @param table may be nullptr: every key is then missing
  ProfileTable(const toml::table* table, std::string prefix, ProfileProblem& problem)
      : table_(table), prefix_(std::move(prefix)), problem_(problem) {}

  [[nodiscard]] bool exists() const { return table_ != nullptr; }
  [[nodiscard]] bool has(std::string_view key) const { return table_ != nullptr && table_->contains(key); }

  std::int64_t integer(std::string_view key, std::optional<std::int64_t> otherwise, std::int64_t least,
                       std::int64_t most);
  double number(std::string_view key, std::optional<double> otherwise, double least, double most);
  std::string text(std::string_view key, std::optional<std::string> otherwise);
  /// "6064:01"; without ":", sub-index 0.
  canopen::ObjectAddress object(std::string_view key, std::optional<std::string> otherwise);
  canopen::NumberType type(std::string_view key, std::optional<std::string> otherwise);
  /// "6064:01/32"
  std::vector<canopen::PdoEntry> entries(std::string_view key);
  ProfileTable table(std::string_view key);
  /// Tables of an array of tables; empty when missing.
  std::vector<ProfileTable> tables(std::string_view key);

  void complain(std::string_view key, const std::string& found, const std::string& allowed);
  /// Every key must have been asked for: a misspelt key must not be a silent default.
  void finish();

 private:
  const toml::node* find(std::string_view key);

  const toml::table* table_;
  std::string prefix_;
  ProfileProblem& problem_;
  std::set<std::string, std::less<>> asked_;
};

struct Profile;
/// The tables that only one family of protocols has (profile_canopen.cpp).
void read_canopen_tables(ProfileTable& table, Profile& profile);

}  // namespace odomcalib::drivers
