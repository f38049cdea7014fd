// YDLIDAR, triangle protocol: serial or TCP, clockwise, no clock of its own.
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "drivers/clean_text.hpp"
#include "drivers/device_clock.hpp"
#include "drivers/lidar/common/sweep.hpp"
#include "drivers/lidar/common/units.hpp"
#include "drivers/lidar/lidar.hpp"
#include "drivers/lidar/ydlidar/packet.hpp"
#include "drivers/lidar/ydlidar/settings.hpp"
#include "drivers/lidar/ydlidar/startup.hpp"

namespace odomcalib::drivers {
namespace {

class Ydlidar final : public Lidar {
 public:
  Ydlidar(const LidarOptions& options, const ydlidar::Model& model);

  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  std::vector<LidarScan> take_scans() override { return sweep_.take_scans(); }
  std::vector<std::uint8_t> take_output() override { return startup_.take_output(); }
  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const override;
  void reset() override;
  void finish() override { sweep_.interrupt(); }
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Counters rejected() const override { return sweep_.rejected(finder_.frames().rejected()); }
  [[nodiscard]] std::string identity() const override {
    return startup_.identity().empty() ? reported_name_ : startup_.identity();
  }
  [[nodiscard]] std::optional<Error> problem() const override;

 private:
  void on_packet(const ydlidar::Packet& packet, double now);
  double date(const ydlidar::Packet& packet, double now);
  [[nodiscard]] double step_of(const ydlidar::Packet& packet) const;
  void report_packet(const ydlidar::Packet& packet) const;
  [[nodiscard]] std::optional<Error> wrong_kind() const;
  [[nodiscard]] std::optional<Error> other_model() const;

  LidarOptions options_;
  const ydlidar::Model& model_;
  ydlidar::PacketFinder finder_;
  ydlidar::Startup startup_;
  SampleClock clock_;
  Sweep sweep_;
  double usual_step_ = 0.0;    // degrees between samples
  std::string reported_name_;  // of a model that sends it unasked
};

}  // namespace

Ydlidar::Ydlidar(const LidarOptions& options, const ydlidar::Model& model)
    : options_(options),
      model_(model),
      finder_(model),
      clock_(options.device_time),
      sweep_({ydlidar::kRangeMin_m, ydlidar::kRangeMax_m, model.intensity_bits != 0}) {}

void Ydlidar::reset() {
  finder_.reset();
  startup_.reset();
  clock_.reset();
  sweep_.reset();
}

std::vector<std::uint8_t> Ydlidar::stop_bytes() const {
  return model_.answers ? ydlidar::Startup::stop_bytes() : std::vector<std::uint8_t>{};
}

/// Moment of the last sample, s: the packet is sent when it is complete, and then takes its time on the line.
double Ydlidar::date(const ydlidar::Packet& packet, double now) {
  const double arrival = now - wire_time(packet.bytes_after, options_.baud);
  const auto stamp =
      clock_.on_packet(static_cast<double>(packet.samples.size()) / model_.samples_per_s, arrival);
  if (!stamp.continuous) sweep_.interrupt();
  return stamp.t - wire_time(packet.size, options_.baud);
}

/// Degrees that a sample stands for. A packet of one sample does not tell.
double Ydlidar::step_of(const ydlidar::Packet& packet) const {
  if (packet.samples.size() < 2) return usual_step_;
  const double span = std::fmod(packet.end - packet.start + 360.0, 360.0);
  return span / static_cast<double>(packet.samples.size() - 1);
}

void Ydlidar::report_packet(const ydlidar::Packet& packet) const {
  if (!has_listener()) return;
  std::vector<double> angles, ranges;
  std::vector<std::int64_t> intensities;
  for (const ydlidar::Sample& sample : packet.samples) {
    angles.push_back(-radians(sample.clockwise));
    ranges.push_back(sample.range_mm > 0.0 ? 1e-3 * sample.range_mm : kNoReading);
    intensities.push_back(sample.intensity);
  }
  LidarMessage message{"ydlidar_packet",
                       {{"zero", std::int64_t{packet.zero}},
                        {"start_deg", packet.start},
                        {"end_deg", packet.end},
                        {"angles", std::move(angles)},
                        {"ranges", std::move(ranges)}},
                       true};
  if (packet.turn_hz > 0.0) message.fields.emplace_back("turn_hz", packet.turn_hz);
  if (model_.intensity_bits != 0) message.fields.emplace_back("intensities", std::move(intensities));
  report(std::move(message));
}

void Ydlidar::on_packet(const ydlidar::Packet& packet, double now) {
  const double t_last = date(packet, now);
  const double sample_s = clock_.rate() / model_.samples_per_s;
  usual_step_ = step_of(packet);
  if (packet.zero) sweep_.begin_turn();
  const double n = static_cast<double>(packet.samples.size());
  for (std::size_t i = 0; i < packet.samples.size(); ++i) {
    const ydlidar::Sample& sample = packet.samples[i];
    const double t = t_last - sample_s * (n - 1.0 - static_cast<double>(i));
    sweep_.add({t, -radians(sample.clockwise), 1e-3 * sample.range_mm, static_cast<double>(sample.intensity)},
               radians(usual_step_));
  }
  report_packet(packet);
}

void Ydlidar::on_bytes(std::span<const std::uint8_t> bytes, double now) {
  const bool talks = model_.answers && !options_.device_time;
  for (const ydlidar::Item& item : finder_.on_bytes(bytes)) {
    if (item.packet) {
      on_packet(*item.packet, now);
      if (talks) startup_.on_measurements(now);
      continue;
    }
    if (item.answer.type == ydlidar::kNameType)
      reported_name_ = clean_text(std::string(item.answer.payload.begin(), item.answer.payload.end()));
    if (has_listener())
      report({"ydlidar_answer",
              {{"answer_type", std::int64_t{item.answer.type}}, {"data", hex_text(item.answer.payload)}}});
    if (talks) startup_.on_answer(item.answer, now);
  }
  if (talks) startup_.step(now);
}

Counters Ydlidar::counters() const {
  Counters all = finder_.frames().counters();
  sweep_.count_into(all);
  return all;
}

/// Samples of another size than the model's: told with the models that have it.
std::optional<Error> Ydlidar::wrong_kind() const {
  if (finder_.packets() > 0 || finder_.other_kind() < ydlidar::kOtherKind) return std::nullopt;
  const bool three = model_.sample_bytes() == 2;
  std::string fitting;
  for (const ydlidar::Model& model : ydlidar::models())
    if ((model.sample_bytes() == 3) == three)
      fitting += std::string(fitting.empty() ? "" : ", ") + "ydlidar:" + model.name;
  const std::string named = reported_name_.empty() ? "" : "; the lidar calls itself " + reported_name_;
  return Error{ErrorCode::format,
               std::string("every checksum is wrong: samples come in ") +
                   (three ? "three bytes" : "two bytes") + ", and model " + model_.name + " has " +
                   (three ? "two" : "three") + named,
               "ydlidar", "set lidar.type to the model that it is, one of " + fitting};
}

/// Samples of one size have different units and angles in different models: the ranges would be wrong, and
/// nothing in the stream would show it.
std::optional<Error> Ydlidar::other_model() const {
  const ydlidar::Model* said = ydlidar::model_that_says(reported_name_);
  if (said == nullptr || std::string(said->name) == model_.name) return std::nullopt;
  return Error{ErrorCode::format,
               "the lidar calls itself " + reported_name_ + ", and lidar.type says model " + model_.name,
               "ydlidar", std::string("set lidar.type to ydlidar:") + said->name};
}

std::optional<Error> Ydlidar::problem() const {
  if (auto wrong = wrong_kind()) return wrong;
  if (auto other = other_model()) return other;
  const FrameBuffer& frames = finder_.frames();
  if (finder_.packets() == 0 && frames.rejected().at("bad_checksum") > ydlidar::kAllWrong)
    return Error{ErrorCode::format, "every checksum is wrong", "ydlidar",
                 std::string("lidar.type says model ") + model_.name +
                     "; a model with another sample format does this: correct lidar.type"};
  return startup_.problem();
}

std::unique_ptr<Lidar> make_ydlidar(const LidarOptions& options, const ydlidar::Model& model) {
  return std::make_unique<Ydlidar>(options, model);
}

}  // namespace odomcalib::drivers
