#include "daemon/service/call_parameters.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace odomcalib {

using nlohmann::ordered_json;

CallParameters::CallParameters(const ordered_json& object, std::string path)
    : object_(&object), path_(std::move(path)) {
  if (!object.is_object()) wrong_ = path_.empty() ? "parameters" : path_;
}

const ordered_json& CallParameters::member(const char* name) const {
  static const ordered_json kNull;
  const auto found = object_->find(name);
  return found == object_->end() ? kNull : *found;
}

void CallParameters::reject(const std::string& name) {
  if (!wrong_) wrong_ = path_.empty() ? name : path_ + "." + name;
}

double CallParameters::number(const char* name) {
  const ordered_json& value = member(name);
  if (value.is_number()) return value.get<double>();
  reject(name);
  return std::numeric_limits<double>::quiet_NaN();
}

double CallParameters::number(const char* name, double otherwise) {
  return object_->contains(name) ? number(name) : otherwise;
}

int CallParameters::whole(const char* name, int otherwise) {
  if (!object_->contains(name)) return otherwise;
  const ordered_json& value = member(name);
  constexpr std::int64_t kMost = std::numeric_limits<int>::max();
  if (value.is_number_unsigned())
    return static_cast<int>(std::min(value.get<std::uint64_t>(), static_cast<std::uint64_t>(kMost)));
  if (value.is_number_integer())
    return static_cast<int>(std::clamp(value.get<std::int64_t>(), -kMost, kMost));
  reject(name);
  return otherwise;
}

std::string CallParameters::text(const char* name, const std::string& otherwise) {
  const ordered_json& value = member(name);
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_null()) reject(name);
  return otherwise;
}

bool CallParameters::flag(const char* name) {
  const ordered_json& value = member(name);
  if (value.is_boolean()) return value.get<bool>();
  if (!value.is_null()) reject(name);
  return false;
}

void CallParameters::only(std::span<const std::string> names) {
  if (!object_->is_object()) return;
  for (const auto& [name, value] : object_->items())
    if (std::find(names.begin(), names.end(), name) == names.end()) reject(name);
}

}  // namespace odomcalib
