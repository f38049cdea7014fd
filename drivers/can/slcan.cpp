#include "drivers/can/slcan.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "drivers/can/settings.hpp"
#include "drivers/can/slcan_parser.hpp"
#include "drivers/device_clock.hpp"

namespace odomcalib::drivers {
namespace {

using namespace can;

std::span<const std::uint8_t> as_bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// S0..S8; empty when the protocol has no such rate.
std::string bitrate_command(unsigned bitrate) {
  constexpr std::array<unsigned, 9> kRates = {10'000,  20'000,  50'000,  100'000,  125'000,
                                              250'000, 500'000, 800'000, 1'000'000};
  const auto* const found = std::find(kRates.begin(), kRates.end(), bitrate);
  return found == kRates.end() ? std::string() : "S" + std::to_string(found - kRates.begin()) + "\r";
}

class SlcanTransport final : public CanTransport {
 public:
  SlcanTransport(std::unique_ptr<ByteStream> port, std::string name, std::string rate,
                 const SlcanOptions& options)
      : port_(std::move(port)), name_(std::move(name)), rate_(std::move(rate)), options_(options) {}

  ~SlcanTransport() override { (void)port_->write(as_bytes("C\r")); }
  SlcanTransport(const SlcanTransport&) = delete;
  SlcanTransport& operator=(const SlcanTransport&) = delete;

  Result<bool> ready(double now) override;

  [[nodiscard]] int fd() const override { return port_->fd(); }

  [[nodiscard]] std::string note() const override {
    if (!silent_ || parser_.counters().at("good") > 0) return {};
    return "the adapter at \"" + name_ +
           "\" acknowledges nothing and has passed no frame yet; if it stays silent, check the port's name, "
           "its "
           "baud rate (&baud=...) and ?bitrate=...";
  }

  Result<void> send(const CanFrame& frame) override {
    const std::string line = slcan_line(frame);
    if (line.empty()) return Error{ErrorCode::usage, "an error frame cannot be sent", name_, ""};
    auto written = port_->write(as_bytes(line));
    ++(written ? sent_ : send_failed_);
    return written;
  }

  Result<std::vector<CanFrame>> receive(double now) override {
    auto bytes = port_->read();
    if (!bytes) return bytes.error();
    std::vector<CanFrame> out = std::exchange(early_, {});
    for (SlcanItem& item : parser_.on_bytes(bytes.value())) {
      if (item.kind == SlcanItem::Kind::bus_state) note_bus_state(item, now, out);
      if (item.kind == SlcanItem::Kind::frame) take(item, now, out);
    }
    return out;
  }

  [[nodiscard]] Counters counters() const override {
    Counters all = parser_.counters();
    all["frames_sent"] = sent_;
    all["send_failed"] = send_failed_;
    all["bus_state_lines"] = bus_states_;
    all["unacknowledged"] = silent_ ? 1 : 0;
    return all;
  }
  [[nodiscard]] std::uint64_t taken() const override { return parser_.bytes_in(); }

 private:
  enum class Step { draining, setting_rate, asking_stamps, opening, open };
  enum class Answer { done, refused, none };

  Error refuse(const std::string& what, const std::string& remedy) const {
    return {ErrorCode::device, what, name_, remedy};
  }
  Result<void> begin(Step step, double now, const std::string& command, double patience);
  /// Answer to the step that is under way; nullopt: not yet.
  Result<std::optional<Answer>> answer(double now);
  Result<void> next(Answer given, double now);

  /// From the line's first byte to the end of the read, 10 bits a byte: the frame was over before it began.
  double line_time(const SlcanItem& item) const {
    const double bytes = static_cast<double>(item.bytes + item.bytes_after);
    return options_.baud ? 10.0 * bytes / *options_.baud : 0.0;
  }

  double time_of(const SlcanItem& item, double now) {
    const double seen = now - line_time(item);
    return item.stamp_ms ? clock_.to_host(*item.stamp_ms, seen) : seen;
  }

  void take(SlcanItem& item, double now, std::vector<CanFrame>& out) {
    item.frame.t = time_of(item, now);
    out.push_back(item.frame);
  }

  /// "sb...": bus-off is passed on like SocketCAN's error frame, so that there is one way to learn of it.
  void note_bus_state(const SlcanItem& item, double now, std::vector<CanFrame>& out) {
    ++bus_states_;
    if (item.text.size() < 2 || item.text[0] != 's') return;
    CanFrame frame;
    frame.error = true;
    frame.length = 8;
    frame.t = now;
    if (item.text[1] == 'b') frame.id = 0x040;
    if (item.text[1] == 'p' || item.text[1] == 'w') {
      frame.id = 0x004;
      frame.data[1] = item.text[1] == 'p' ? 0x30 : 0x0C;
    }
    if (frame.id != 0) out.push_back(frame);
  }

  std::unique_ptr<ByteStream> port_;
  std::string name_, rate_;
  SlcanOptions options_;
  Step step_ = Step::draining;
  std::optional<double> deadline_;  // s, of this step; unset: nothing was asked yet
  std::vector<CanFrame> early_;     // came with the answer that the channel is open
  SlcanParser parser_;
  DeviceClock clock_{60'000};
  bool silent_ = false;  // acknowledged none of the set-up commands
  std::uint64_t sent_ = 0, send_failed_ = 0, bus_states_ = 0;
};

Result<void> SlcanTransport::begin(Step step, double now, const std::string& command, double patience) {
  step_ = step;
  deadline_ = now + patience;
  return port_->write(as_bytes(command));
}

Result<std::optional<SlcanTransport::Answer>> SlcanTransport::answer(double now) {
  auto bytes = port_->read();
  if (!bytes) return bytes.error();
  std::optional<Answer> given;
  for (SlcanItem& item : parser_.on_bytes(bytes.value())) {
    if (step_ == Step::draining) continue;  // of whoever had the adapter before
    if (item.kind == SlcanItem::Kind::done && !given) given = Answer::done;
    if (item.kind == SlcanItem::Kind::refused && !given) given = Answer::refused;
    if (item.kind == SlcanItem::Kind::frame) take(item, now, early_);
  }
  if (!given && now >= deadline_) given = Answer::none;
  return given;
}

Result<void> SlcanTransport::next(Answer given, double now) {
  const bool refused = given == Answer::refused;
  switch (step_) {
    case Step::draining:
      return begin(Step::setting_rate, now, rate_, kAnswer_s);
    case Step::setting_rate:
      if (refused)
        return refuse("adapter refuses the bit rate " + std::to_string(options_.bitrate),
                      "check ?bitrate=...");
      silent_ = given == Answer::none;
      if (options_.timestamps) return begin(Step::asking_stamps, now, "Z1\r", kAnswer_s);
      [[fallthrough]];
    case Step::asking_stamps:  // may be refused: then arrival times serve
      return begin(Step::opening, now, "O\r", kAnswer_s);
    default:
      if (refused)
        return refuse("adapter does not open the channel",
                      "unplug it, check the CAN wiring, plug it in again");
      // Some adapters acknowledge nothing and work; python-can and the kernel's slcan ask for nothing either.
      silent_ = silent_ && given == Answer::none;
      step_ = Step::open;
      return {};
  }
}

Result<bool> SlcanTransport::ready(double now) {
  if (step_ == Step::open) return true;
  if (!deadline_) {
    if (auto begun = begin(Step::draining, now, "\r\r\rC\r", kDrain_s); !begun) return begun.error();
    return false;
  }
  const auto given = answer(now);
  if (!given) return given.error();
  if (!given.value()) return false;
  if (auto done = next(*given.value(), now); !done) return done.error();
  return step_ == Step::open;
}

}  // namespace

Result<std::unique_ptr<CanTransport>> open_slcan(std::unique_ptr<ByteStream> port, const std::string& name,
                                                 const SlcanOptions& options) {
  const std::string rate = bitrate_command(options.bitrate);
  if (rate.empty())
    return Error{ErrorCode::usage, "no command for " + std::to_string(options.bitrate) + " bit/s", name,
                 "use 10000, 20000, 50000, 100000, 125000, 250000, 500000, 800000 or 1000000"};
  return std::unique_ptr<CanTransport>(
      std::make_unique<SlcanTransport>(std::move(port), name, rate, options));
}

}  // namespace odomcalib::drivers
