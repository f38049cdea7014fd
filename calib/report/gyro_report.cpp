#include "calib/report/gyro_report.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace odomcalib::calib::report {

bool is_silent(const estimation::GyroWitness& witness) {
  return std::none_of(witness.gyros.begin(), witness.gyros.end(), [](const auto& g) { return g.used > 0; });
}

std::string to_json(const estimation::GyroWitness& witness, std::span<const Recording> recordings) {
  auto list = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < witness.gyros.size(); ++k) {
    const estimation::GyroFinding& gyro = witness.gyros[k];
    if (gyro.used == 0) continue;
    nlohmann::ordered_json entry = {
        {"file", recordings[k].name}, {"used", gyro.used},     {"scale", gyro.scale}, {"scale_std", nullptr},
        {"bias", gyro.bias},          {"offset", gyro.offset}, {"left_out", nullptr}};
    if (gyro.scale_std >= 0.0) entry["scale_std"] = gyro.scale_std;
    if (gyro.fault) entry["left_out"] = *gyro.fault;
    list.push_back(std::move(entry));
  }
  return list.dump();
}

std::vector<std::string> remarks_on(const estimation::GyroWitness& witness,
                                    std::span<const Recording> recordings) {
  std::vector<std::string> remarks;
  for (std::size_t k = 0; k < witness.gyros.size(); ++k)
    if (const auto& fault = witness.gyros[k].fault)
      remarks.push_back(recordings.size() > 1 ? recordings[k].name + ": " + *fault : *fault);
  return remarks;
}

}  // namespace odomcalib::calib::report
