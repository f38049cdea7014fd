// SLAMTEC RPLIDAR (A, S and C series): serial or TCP, clockwise, no clock of its own.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "drivers/device_clock.hpp"
#include "drivers/lidar/common/sweep.hpp"
#include "drivers/lidar/common/units.hpp"
#include "drivers/lidar/lidar.hpp"
#include "drivers/lidar/rplidar/answer_text.hpp"
#include "drivers/lidar/rplidar/settings.hpp"
#include "drivers/lidar/rplidar/startup.hpp"
#include "drivers/lidar/rplidar/stream.hpp"

namespace odomcalib::drivers {
namespace {

class Rplidar final : public Lidar {
 public:
  using Mode = rplidar::Startup::Mode;
  Rplidar(const LidarOptions& options, Mode mode, std::optional<rplidar::PacketType> guessed);

  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  std::vector<LidarScan> take_scans() override { return sweep_.take_scans(); }
  std::vector<std::uint8_t> take_output() override { return startup_.take_output(); }
  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const override { return startup_.stop_bytes(); }
  void reset() override;
  void finish() override {
    stream_.finish();
    sweep_.interrupt();
  }
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Counters rejected() const override { return sweep_.rejected(stream_.frames().rejected()); }
  [[nodiscard]] std::string identity() const override { return startup_.identity(); }
  [[nodiscard]] std::optional<Error> problem() const override;

 private:
  /// A capsule whose successor has not come yet.
  struct Waiting {
    std::vector<std::uint8_t> bytes;
    double t_end = 0.0;  // s, end of its measurement and transmission
  };
  void on_item(const rplidar::Item& item, double now);
  void on_packet(const rplidar::Item& item, double now);
  void on_capsule(const rplidar::Item& item, double arrival);
  void emit(const std::vector<rplidar::Point>& points, double t_end, double span);
  double date(unsigned packets, double arrival);
  bool believable(double span, unsigned& packets);
  void report_answer(const rplidar::Item& item) const;
  void report_points(const std::vector<rplidar::Point>& points) const;
  void forget_motion();

  LidarOptions options_;
  rplidar::Stream stream_;
  rplidar::Startup startup_;
  SampleClock clock_;
  Sweep sweep_;
  const rplidar::PacketFormat* format_ = nullptr;
  std::optional<double> reported_sample_s_;  // read along in a recording
  std::optional<Waiting> waiting_;
  double usual_span_ = 0.0;  // degrees per capsule
  std::optional<double> last_angle_;
};

using namespace rplidar;

double forward(double from, double to) { return std::fmod(to - from + 720.0, 360.0); }

}  // namespace

Rplidar::Rplidar(const LidarOptions& options, Mode mode, std::optional<rplidar::PacketType> guessed)
    : options_(options),
      stream_(options.device_time, guessed),
      startup_(mode),
      clock_(options.device_time),
      sweep_(kLimits) {}

void Rplidar::forget_motion() {
  waiting_.reset();
  last_angle_.reset();
  usual_span_ = 0.0;
}

void Rplidar::reset() {
  stream_.reset();
  startup_.reset();
  clock_.reset();
  sweep_.reset();
  forget_motion();
}

void Rplidar::on_bytes(std::span<const std::uint8_t> bytes, double now) {
  for (const Item& item : stream_.on_bytes(bytes)) on_item(item, now);
  if (options_.device_time) return;
  const bool was_discarding = startup_.discarding();
  startup_.step(now);
  if (startup_.discarding() && !was_discarding) sweep_.interrupt();
  if (startup_.discarding()) stream_.expect_descriptor();
}

void Rplidar::on_item(const Item& item, double now) {
  if (item.kind == Item::Kind::packet) return on_packet(item, now);
  if (item.kind == Item::Kind::answer) {
    report_answer(item);
    if (const auto sample = rplidar::reported_sample_time(item.type, item.bytes)) reported_sample_s_ = sample;
    if (!options_.device_time) startup_.on_answer(item.type, item.bytes, now);
    return;
  }
  const rplidar::PacketFormat* format = rplidar::find_format(item.type);
  if (format == nullptr) return;
  sweep_.interrupt();
  forget_motion();
  clock_.reset();
}

/// End of a packet's measurement and transmission; `packets` have passed since the one before.
double Rplidar::date(unsigned packets, double arrival) {
  const double sample = startup_.sample_s().value_or(reported_sample_s_.value_or(format_->sample_s));
  const auto stamp = clock_.on_packet(packets * format_->points * sample, arrival);
  if (!stamp.continuous) sweep_.interrupt();
  return stamp.t;
}

void Rplidar::on_packet(const Item& item, double now) {
  format_ = rplidar::find_format(item.type);
  if (const auto range = startup_.range_max_m()) sweep_.set_range_max(*range);
  if (!options_.device_time) startup_.on_measurements(now);
  const double arrival = now - wire_time(item.bytes_after, options_.baud);
  if (rplidar::is_capsule(format_->type)) return on_capsule(item, arrival);
  const double t_end = date(1, arrival);
  const auto points = rplidar::own_points(format_->type, item.bytes);
  emit(points, t_end, 0.0);
}

/// Whether the angle between two capsules can be theirs; a multiple of the usual one means that some were
/// lost.
bool Rplidar::believable(double span, unsigned& packets) {
  const double fastest = format_->sample_s * format_->points * kFastest_hz * 360.0;
  if (span <= 0.0) {
    stream_.frames().reject("motor_stopped");
    return false;
  }
  const bool lost = usual_span_ > 0.0 && span > kLostFactor * usual_span_;
  if (lost) {
    packets = static_cast<unsigned>(std::lround(span / usual_span_));
    stream_.frames().reject("lost_packets", packets - 1);
  }
  const bool too_fast = span > fastest || span >= kMostSpan_deg;
  if (too_fast && !lost) stream_.frames().reject("bad_span");
  if (!too_fast) usual_span_ += (usual_span_ > 0.0 ? kSpanGain : 1.0) * (span - usual_span_);
  return !lost && !too_fast;
}

void Rplidar::on_capsule(const Item& item, double arrival) {
  const double start = rplidar::start_angle(format_->type, item.bytes);
  const bool follows = waiting_ && !rplidar::begins_run(format_->type, item.bytes);
  unsigned packets = 1;
  if (follows) {
    const double span = forward(rplidar::start_angle(format_->type, waiting_->bytes), start);
    const bool whole = believable(span, packets);
    if (whole)
      emit(rplidar::capsule_points(format_->type, waiting_->bytes, item.bytes, span), waiting_->t_end, span);
  } else if (waiting_) {
    sweep_.interrupt();
  }
  waiting_ = Waiting{item.bytes, date(packets, arrival)};
}

/// Point i of N was measured N - 1 - i samples before the end, and the packet then took its time on the line.
void Rplidar::emit(const std::vector<Point>& points, double t_end, double span) {
  report_points(points);
  const double n = static_cast<double>(points.size());
  const double nominal = startup_.sample_s().value_or(reported_sample_s_.value_or(format_->sample_s));
  const double sample = nominal * clock_.rate();
  const double t_last = t_end - wire_time(format_->bytes, options_.baud) - kFilterDelay * sample;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& point = points[i];
    double step = span / n;
    if (span == 0.0 && last_angle_) {
      step = forward(*last_angle_, point.clockwise);
      if (step > kMostStep_deg && step < 360.0 - kMostBackwards_deg)
        stream_.frames().reject("angle_backwards");
      if (step > kMostStep_deg) step = 0.0;
    }
    last_angle_ = point.clockwise;
    if (point.start) sweep_.begin_turn();
    const double t = t_last - sample * (n - 1.0 - static_cast<double>(i));
    sweep_.add({t, -radians(point.clockwise), 1e-3 * point.range_mm, static_cast<double>(point.quality)},
               radians(step));
  }
}

void Rplidar::report_answer(const Item& item) const {
  if (has_listener()) report(rplidar::describe_answer(item.type, item.bytes));
}

void Rplidar::report_points(const std::vector<Point>& points) const {
  if (!has_listener() || points.size() < 2) return;
  std::vector<double> angles, ranges;
  std::vector<std::int64_t> qualities;
  for (const Point& point : points) {
    angles.push_back(-radians(point.clockwise));
    ranges.push_back(point.range_mm > 0.0 ? 1e-3 * point.range_mm : kNoReading);
    qualities.push_back(point.quality);
  }
  report(
      {std::string("rplidar_") + format_->name,
       {{"angles", std::move(angles)}, {"ranges", std::move(ranges)}, {"intensities", std::move(qualities)}},
       true});
}

Counters Rplidar::counters() const {
  Counters all = stream_.frames().counters();
  sweep_.count_into(all);
  return all;
}

std::optional<Error> Rplidar::problem() const {
  if (stream_.frames().rejected().at("unknown_packet_type") > 0)
    return Error{ErrorCode::format, "the lidar sends measurements in a form that this driver does not know",
                 "rplidar", "use lidar.type = \"rplidar:standard\""};
  if (stream_.frames().rejected().at("ambiguous_capsule") > 0)
    return Error{ErrorCode::format, "the recording does not say whether its capsules are express or dense",
                 "rplidar", "name the type: rplidar:express or rplidar:dense"};
  return startup_.problem();
}

std::unique_ptr<Lidar> make_rplidar(const LidarOptions& options, rplidar::Startup::Mode mode,
                                    std::optional<rplidar::PacketType> guessed) {
  return std::make_unique<Rplidar>(options, mode, guessed);
}

}  // namespace odomcalib::drivers
