// SICK LMS1xx, LMS5xx, TiM5xx, TiM7xx, MRS1000: CoLa over TCP, counter-clockwise, microsecond clock.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "drivers/clean_text.hpp"
#include "drivers/device_clock.hpp"
#include "drivers/lidar/cola/settings.hpp"
#include "drivers/lidar/cola/startup.hpp"
#include "drivers/lidar/common/stamp_line.hpp"
#include "drivers/lidar/common/units.hpp"
#include "drivers/lidar/lidar.hpp"

namespace odomcalib::drivers {
namespace {

class Cola final : public Lidar {
 public:
  explicit Cola(const LidarOptions& options);

  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  std::vector<LidarScan> take_scans() override { return std::exchange(scans_, {}); }
  std::vector<std::uint8_t> take_output() override { return startup_.take_output(); }
  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const override { return startup_.stop_bytes(); }
  void reset() override;
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Counters rejected() const override { return finder_.frames().rejected(); }
  [[nodiscard]] std::string identity() const override { return startup_.identity(); }
  [[nodiscard]] std::optional<Error> problem() const override;

 private:
  void on_telegram(const cola::Telegram& telegram, double arrival);
  void on_scan(const cola::ScanData& data, double arrival);
  bool is_repeated(const cola::ScanData& data);
  double date(const cola::ScanData& data, double arrival, double sweep_turns);
  std::uint64_t lost_scans(unsigned between);
  void report_telegram(const cola::Telegram& telegram) const;

  LidarOptions options_;
  cola::TelegramFinder finder_;
  cola::Startup startup_;
  DeviceClock clock_;
  StampLine line_;
  std::optional<std::tuple<unsigned, unsigned, int>> last_counters_;  // telegram, scan, layer
  std::set<int> layers_;                                              // seen
  unsigned turns_per_scan_ = cola::kMostLayers;                       // of one layer, the fewest seen
  unsigned status_ = 0;
  double began_ = 0.0;  // s, when the first byte of the telegram in progress came
  std::vector<LidarScan> scans_;
  std::uint64_t published_ = 0;
};

using namespace cola;

constexpr std::uint64_t kClockModulus_us = std::uint64_t{1} << 32U;
constexpr unsigned kError = 1, kPollution = 4;  // bits of the status

}  // namespace

Cola::Cola(const LidarOptions& options)
    : options_(options), clock_(kClockModulus_us, 1e-6, options.device_time) {}

void Cola::reset() {
  finder_.reset();
  startup_.reset();
  clock_.reset();
  line_.reset();
  last_counters_.reset();
  layers_.clear();
  turns_per_scan_ = cola::kMostLayers;
}

void Cola::on_bytes(std::span<const std::uint8_t> bytes, double now) {
  if (finder_.frames().buffered() == 0) began_ = now;
  for (const cola::Telegram& telegram : finder_.on_bytes(bytes)) {
    on_telegram(telegram, began_);
    began_ = now;
    if (!options_.device_time) startup_.on_telegram(telegram, now);
  }
  if (!options_.device_time) startup_.step(now);
}

void Cola::on_telegram(const cola::Telegram& telegram, double arrival) {
  if (!telegram.scan) return report_telegram(telegram);
  if (is_repeated(*telegram.scan)) return finder_.frames().reject("repeated_scans");
  // Only the horizontal layer of a sensor with several can be matched in the plane.
  if (layers_.size() < cola::kMostLayers) layers_.insert(telegram.scan->layer);
  if (telegram.scan->layer != 0) return finder_.frames().reject("other_layers");
  on_scan(*telegram.scan, arrival);
}

/// The same scan can arrive twice; a gap in the counter means lost ones.
bool Cola::is_repeated(const ScanData& data) {
  const std::tuple counters(data.telegram_counter, data.scan_counter, data.layer);
  if (last_counters_ == counters) return true;
  last_counters_ = counters;
  return false;
}

/// Time of the first beam. The device's clock is mapped by its moment of transmission.
/// @param sweep_turns part of a turn from the first to the last beam
double Cola::date(const ScanData& data, double arrival, double sweep_turns) {
  const double nominal = 100.0 / data.turns_chz;
  const double since_start = 1e-6 * (data.sent_us - data.started_us);  // modulo 2^32 us
  const double started = clock_.to_host(data.sent_us, arrival) - since_start;
  finder_.frames().reject("lost_scans", lost_scans(line_.add(started, nominal).lost));
  const double sweep = sweep_turns * line_.period();
  return since_start < sweep ? started - sweep + kUntilEnd_s : started;
}

/// In a sensor with several layers the turns between two scans of one may belong to the others.
/// @param between turns without a scan of this layer
std::uint64_t Cola::lost_scans(unsigned between) {
  const auto layers = static_cast<unsigned>(layers_.size());
  turns_per_scan_ = std::min({turns_per_scan_, between + 1, layers});
  return static_cast<std::uint64_t>(std::lround((between + 1.0) / turns_per_scan_)) - 1;
}

void Cola::on_scan(const ScanData& data, double arrival) {
  status_ = data.status & 0xFFU;
  const Channel& distances = *data.find("DIST1");
  const double step = cola::true_step(distances.step);
  const double beams = static_cast<double>(distances.values.size());
  LidarScan out;
  out.device_time = 1e-6 * data.started_us;
  out.counter = data.telegram_counter;
  Scan& scan = out.scan;
  scan.t = date(data, arrival, step * (beams - 1.0) / 360.0);
  scan.angle_min = radians(1e-4 * distances.start);
  scan.angle_increment = radians(step);
  scan.time_increment = line_.period() * step / 360.0;
  scan.range_min = kRangeMin_m;
  scan.range_max = kRangeMax_m;
  for (const std::uint16_t raw : distances.values) {
    const double range = 1e-3 * (double{distances.factor} * raw + double{distances.offset});
    const bool valid = raw >= kFirstDistance && range >= kRangeMin_m && range <= kRangeMax_m;
    scan.ranges.push_back(valid ? static_cast<float>(range) : 0.0F);
  }
  const Channel* strengths = data.find("RSSI1");
  if (strengths != nullptr && strengths->values.size() == distances.values.size())
    for (const std::uint16_t raw : strengths->values)
      scan.intensities.push_back(strengths->factor * static_cast<float>(raw) + strengths->offset);
  scans_.push_back(std::move(out));
  ++published_;
}

void Cola::report_telegram(const cola::Telegram& telegram) const {
  if (!has_listener()) return;
  const auto& arguments = telegram.arguments;
  const bool text = telegram.dialect == cola::Dialect::ascii;
  report({"cola_telegram",
          {{"kind", telegram.kind},
           {"command", telegram.name},
           {"data", text ? std::string(arguments.begin(), arguments.end()) : hex_text(arguments)}}});
}

Counters Cola::counters() const {
  Counters all = finder_.frames().counters();
  all["scans"] = published_;
  return all;
}

std::optional<Error> Cola::problem() const {
  if (startup_.problem()) return startup_.problem();
  if ((status_ & (kError | kPollution)) == 0) return std::nullopt;
  return Error{ErrorCode::device,
               (status_ & kError) != 0 ? "the sensor reports a device error" : "the sensor's window is dirty",
               "sick", "clean the window; see the sensor's display or SOPAS"};
}

std::unique_ptr<Lidar> make_cola(const LidarOptions& options) { return std::make_unique<Cola>(options); }

}  // namespace odomcalib::drivers
