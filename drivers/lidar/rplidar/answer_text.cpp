#include "drivers/lidar/rplidar/answer_text.hpp"

#include <algorithm>

#include "drivers/clean_text.hpp"
#include "drivers/lidar/rplidar/commands.hpp"
#include "drivers/lidar/rplidar/settings.hpp"

namespace odomcalib::drivers::rplidar {
namespace {

using Fields = std::vector<std::pair<std::string, LidarMessage::Value>>;

Fields info_fields(ByteReader reader) {
  const std::int64_t model = reader.u8(), minor = reader.u8(), major = reader.u8(), hardware = reader.u8();
  return {{"model", model},
          {"firmware", std::to_string(major) + "." + std::to_string(minor)},
          {"hardware", hardware},
          {"serial", hex_text(reader.take(16))}};
}

std::string text_of(Bytes bytes) { return {bytes.begin(), std::find(bytes.begin(), bytes.end(), 0)}; }

Fields configuration_fields(ByteReader reader) {
  const std::uint32_t key = reader.u32();
  Fields fields = {{"key", std::int64_t{key}}};
  switch (static_cast<Setting>(key)) {
    case Setting::sample_time:
      fields.emplace_back("sample_time_us", reader.u32() / 256.0);
      break;
    case Setting::range_max:
      fields.emplace_back("range_max", reader.u32() / 256.0);
      break;
    case Setting::packet_type:
      fields.emplace_back("answer_type", std::int64_t{reader.u8()});
      break;
    case Setting::typical_mode:
      fields.emplace_back("typical_mode", std::int64_t{reader.u16()});
      break;
    case Setting::name:
      fields.emplace_back("mode_name", text_of(reader.take(reader.left())));
      break;
    default:
      fields.emplace_back("data", hex_text(reader.take(reader.left())));
  }
  return fields;
}

}  // namespace

LidarMessage describe_answer(std::uint8_t type, Bytes payload) {
  ByteReader reader(payload);
  switch (static_cast<AnswerType>(type)) {
    case AnswerType::info:
      if (payload.size() == 20) return {"rplidar_info", info_fields(reader)};
      break;
    case AnswerType::health:
      if (payload.size() == 3)
        return {"rplidar_health",
                {{"status", std::int64_t{reader.u8()}}, {"error_code", std::int64_t{reader.u16()}}}};
      break;
    case AnswerType::sample_time:
      if (payload.size() == 4)
        return {"rplidar_sample_time",
                {{"standard_us", std::int64_t{reader.u16()}}, {"express_us", std::int64_t{reader.u16()}}}};
      break;
    case AnswerType::configuration:
      if (payload.size() >= 5) return {"rplidar_configuration", configuration_fields(reader)};
      break;
    case AnswerType::motor_board:
      break;
  }
  return {"rplidar_answer", {{"answer_type", std::int64_t{type}}, {"data", hex_text(payload)}}};
}

std::optional<double> reported_sample_time(std::uint8_t type, Bytes payload) {
  ByteReader reader(payload);
  const bool fits = static_cast<AnswerType>(type) == AnswerType::configuration && payload.size() >= 8 &&
                    static_cast<Setting>(reader.u32()) == Setting::sample_time;
  if (!fits) return std::nullopt;
  const double sample = reader.u32() / 256.0 * 1e-6;
  return sample > kLeastSample_s && sample < kMostSample_s ? std::optional(sample) : std::nullopt;
}

}  // namespace odomcalib::drivers::rplidar
