// Hokuyo sensors with SCIP 2.0 (URG, UTM, UST): serial, USB or TCP, counter-clockwise, millisecond clock.
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "drivers/device_clock.hpp"
#include "drivers/lidar/common/stamp_line.hpp"
#include "drivers/lidar/common/units.hpp"
#include "drivers/lidar/lidar.hpp"
#include "drivers/lidar/scip/startup.hpp"

namespace odomcalib::drivers {
namespace {

class Scip final : public Lidar {
 public:
  Scip(const LidarOptions& options, bool intensities, std::optional<scip::Parameters> known);

  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  std::vector<LidarScan> take_scans() override;
  std::vector<std::uint8_t> take_output() override { return startup_.take_output(); }
  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const override { return {'Q', 'T', '\n'}; }
  void reset() override;
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Counters rejected() const override { return finder_.frames().rejected(); }
  [[nodiscard]] std::string identity() const override { return startup_.identity(); }
  [[nodiscard]] std::optional<Error> problem() const override { return startup_.problem(); }

 private:
  void on_reply(const scip::Reply& reply, double arrival);
  void on_measurement(const scip::Measurement& measurement, double arrival);
  [[nodiscard]] LidarScan make_scan(const scip::Measurement& measurement, double t_first,
                                    double period) const;
  void report_reply(const scip::Reply& reply) const;

  LidarOptions options_;
  scip::ReplyFinder finder_;
  scip::Startup startup_;
  DeviceClock clock_;
  StampLine line_;
  std::optional<scip::Parameters> parameters_;
  std::optional<std::uint32_t> last_stamp_;
  double began_ = 0.0;  // s, when the first byte of the reply in progress came
  std::vector<LidarScan> scans_;
  std::uint64_t published_ = 0;
};

using scip::Measurement;
using scip::Parameters;

/// Steps from the rear of the sensor, where its stamp is taken, to `step`.
double steps_from_rear(const Parameters& parameters, double step) {
  return step - (parameters.front - 0.5 * parameters.steps_per_turn);
}

double nominal_period(const Parameters& parameters) { return 60.0 / parameters.turns_per_minute; }

}  // namespace

Scip::Scip(const LidarOptions& options, bool intensities, std::optional<Parameters> known)
    : options_(options),
      startup_(intensities),
      clock_(scip::kClockModulus_ms, 1e-3, options.device_time),
      parameters_(known) {}

void Scip::reset() {
  finder_.reset();
  startup_.reset();
  clock_.reset();
  line_.reset();
  last_stamp_.reset();
}

void Scip::on_bytes(std::span<const std::uint8_t> bytes, double now) {
  if (finder_.frames().buffered() == 0) began_ = now;
  for (const scip::Reply& reply : finder_.on_bytes(bytes)) {
    on_reply(reply, began_);
    began_ = now;
    if (!options_.device_time) startup_.on_reply(reply, now);
  }
  if (!options_.device_time) startup_.step(now, !bytes.empty());
}

void Scip::on_reply(const scip::Reply& reply, double arrival) {
  if (reply.measurement) {
    if (!parameters_) {
      finder_.frames().reject("no_parameters");
      return report_reply(reply);
    }
    return on_measurement(*reply.measurement, arrival);
  }
  report_reply(reply);
  if (reply.echo.starts_with("PP") && reply.status == "00")
    if (const auto parameters = scip::read_parameters(reply.lines)) parameters_ = parameters;
}

/// The stamp is of the start of the revolution. Nothing can arrive before the last step was measured.
void Scip::on_measurement(const Measurement& measurement, double arrival) {
  if (last_stamp_ == measurement.stamp_ms) return finder_.frames().reject("repeated_scans");
  last_stamp_ = measurement.stamp_ms;
  const Parameters& p = *parameters_;
  const double nominal = nominal_period(p);
  const double sweep = nominal * steps_from_rear(p, measurement.last_step) / p.steps_per_turn;
  const auto stamp = line_.add(clock_.to_host(measurement.stamp_ms, arrival - sweep), nominal);
  finder_.frames().reject("lost_scans", stamp.lost);
  const double period = line_.period();
  const double to_first = period * steps_from_rear(p, measurement.first_step) / p.steps_per_turn;
  scans_.push_back(make_scan(measurement, stamp.t + to_first, period));
  ++published_;
}

LidarScan Scip::make_scan(const Measurement& measurement, double t_first, double period) const {
  const Parameters& p = *parameters_;
  const double step = 2.0 * std::numbers::pi / p.steps_per_turn;
  LidarScan out;
  out.device_time = 1e-3 * measurement.stamp_ms;
  Scan& scan = out.scan;
  scan.t = t_first;
  // A cluster is shown in its middle.
  scan.angle_min = step * (measurement.first_step + 0.5 * (measurement.cluster - 1) - p.front);
  scan.angle_increment = step * measurement.cluster;
  scan.time_increment = period / p.steps_per_turn * measurement.cluster;
  scan.range_min = 1e-3 * p.min_mm;
  scan.range_max = 1e-3 * p.max_mm;
  for (const std::uint32_t range : measurement.ranges_mm) {
    const bool valid = range >= p.min_mm && range <= p.max_mm;  // below are error codes
    scan.ranges.push_back(valid ? static_cast<float>(1e-3 * range) : 0.0F);
  }
  scan.intensities.assign(measurement.intensities.begin(), measurement.intensities.end());
  return out;
}

void Scip::report_reply(const scip::Reply& reply) const {
  if (!has_listener()) return;
  LidarMessage message{"scip_reply", {{"echo", reply.echo}, {"status", reply.status}}};
  for (const auto& [key, value] : scip::fields_of(reply.lines)) message.fields.emplace_back(key, value);
  if (reply.measurement) {
    std::vector<double> ranges;
    for (const std::uint32_t range : reply.measurement->ranges_mm) ranges.push_back(1e-3 * range);
    message.fields.emplace_back("device_time", 1e-3 * reply.measurement->stamp_ms);
    message.fields.emplace_back("ranges", std::move(ranges));
  } else if (message.fields.size() == 2 && !reply.lines.empty()) {
    std::string text;
    for (const std::string& line : reply.lines) text += (text.empty() ? "" : "\n") + line;
    message.fields.emplace_back("text", text);
  }
  report(std::move(message));
}

std::vector<LidarScan> Scip::take_scans() { return std::exchange(scans_, {}); }

Counters Scip::counters() const {
  Counters all = finder_.frames().counters();
  all["scans"] = published_;
  return all;
}

std::unique_ptr<Lidar> make_scip(const LidarOptions& options, bool intensities,
                                 std::optional<scip::Parameters> known) {
  return std::make_unique<Scip>(options, intensities, known);
}

}  // namespace odomcalib::drivers
