// Parameters of a call, read by type. What is there and is of another type is no default: the call is
// refused.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

namespace odomcalib {

class CallParameters {
 public:
  /// @param object must outlive this; anything but an object is wrong as a whole
  /// @param path of the object inside the call, empty for the call's own parameters
  explicit CallParameters(const nlohmann::ordered_json& object, std::string path = {});

  /// Null is no number, also where the member may be left out: JSON has no NaN and no infinity, and many
  /// writers make null of them.
  double number(const char* name);
  double number(const char* name, double otherwise);
  /// A JSON integer; one too large for an int is the largest.
  int whole(const char* name, int otherwise);
  /// Null is an absent member for what follows, as Varlink has it.
  std::string text(const char* name, const std::string& otherwise);
  bool flag(const char* name);
  /// The member, or null where there is none.
  const nlohmann::ordered_json& member(const char* name) const;

  /// Rejects what is of another name: a switch that is misspelt must not be left out in silence.
  void only(std::span<const std::string> names);

  /// Notes that the member is wrong, unless one was before.
  void reject(const std::string& name);
  /// Path of the first member that is missing, of a wrong type or unknown.
  [[nodiscard]] const std::optional<std::string>& wrong() const { return wrong_; }

 private:
  const nlohmann::ordered_json* object_;
  std::string path_;
  std::optional<std::string> wrong_;
};

}  // namespace odomcalib
