#include "drivers/lidar/scip/parameters.hpp"

#include <charconv>

#include "drivers/lidar/scip/settings.hpp"

namespace odomcalib::drivers::scip {
namespace {

unsigned number(const std::map<std::string, std::string>& fields, const std::string& key) {
  const auto found = fields.find(key);
  if (found == fields.end()) return 0;
  unsigned value = 0;
  const std::string& text = found->second;
  (void)std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

}  // namespace

std::map<std::string, std::string> fields_of(const std::vector<std::string>& lines) {
  std::map<std::string, std::string> out;
  for (const std::string& line : lines)
    if (const std::size_t colon = line.find(':'); colon != std::string::npos)
      out[line.substr(0, colon)] = line.substr(colon + 1);
  return out;
}

std::optional<Parameters> read_parameters(const std::vector<std::string>& lines) {
  const auto fields = fields_of(lines);
  Parameters out;
  out.steps_per_turn = number(fields, "ARES");
  out.first = number(fields, "AMIN");
  out.last = number(fields, "AMAX");
  out.front = number(fields, "AFRT");
  out.min_mm = number(fields, "DMIN");
  out.max_mm = number(fields, "DMAX");
  out.turns_per_minute = number(fields, "SCAN");
  const bool sensible = out.steps_per_turn > 0 && out.steps_per_turn <= kMostSteps && out.last > out.first &&
                        out.last - out.first <= out.steps_per_turn && out.front <= kMostSteps &&
                        out.max_mm > out.min_mm && out.turns_per_minute > 0;
  return sensible ? std::optional(out) : std::nullopt;
}

std::optional<Parameters> known_parameters(const std::string& model) {
  // As commonly stated for the two families, not checked on devices; what a sensor tells itself goes before.
  if (model == "utm30lx") return Parameters{1440, 0, 1080, 540, 23, 60'000, 2400};
  if (model == "urg04lx") return Parameters{1024, 44, 725, 384, 20, 5600, 600};
  return std::nullopt;
}

}  // namespace odomcalib::drivers::scip
