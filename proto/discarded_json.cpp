#include "proto/discarded_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace odomcalib {
namespace {

using Json = nlohmann::ordered_json;

Json time_or_null(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

template <typename List>
Json each(const List& list) {
  Json out = Json::array();
  for (const auto& one : list) out.push_back(to_json(one));
  return out;
}

}  // namespace

Json to_json(const Discarded& one) {
  return {{"what", one.what},
          {"count", one.count},
          {"of", one.of},
          {"begin", time_or_null(one.begin)},
          {"end", time_or_null(one.end)},
          {"reason", one.reason}};
}

Json to_json(const Repair& one) {
  return {{"what", one.what}, {"chosen", one.chosen}, {"reason", one.reason}};
}

Json to_json(const std::vector<Discarded>& list) { return each(list); }
Json to_json(const std::vector<Repair>& list) { return each(list); }

}  // namespace odomcalib
