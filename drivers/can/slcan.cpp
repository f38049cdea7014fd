#include "drivers/can/slcan.hpp"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <deque>

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
  SlcanTransport(std::unique_ptr<ByteStream> port, std::string name, const SlcanOptions& options)
      : port_(std::move(port)), name_(std::move(name)), options_(options) {}

  ~SlcanTransport() override { (void)port_->write(as_bytes("C\r")); }
  SlcanTransport(const SlcanTransport&) = delete;
  SlcanTransport& operator=(const SlcanTransport&) = delete;

  Result<void> set_up();

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
    std::vector<CanFrame> out;
    for (SlcanItem& item : parser_.on_bytes(bytes.value())) {
      if (item.kind == SlcanItem::Kind::bus_state) note_bus_state(item, now, out);
      if (item.kind != SlcanItem::Kind::frame) continue;
      item.frame.t = time_of(item, now);
      out.push_back(item.frame);
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

 private:
  using Clock = std::chrono::steady_clock;

  Error refuse(const std::string& what, const std::string& remedy) const {
    return {ErrorCode::device, what, name_, remedy};
  }

  /// Waits for bytes until the deadline; false when there were none.
  Result<bool> await_bytes(Clock::time_point deadline, std::vector<SlcanItem>& out) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd state{port_->fd(), POLLIN, 0};
    if (left <= 0 || poll(&state, 1, static_cast<int>(left)) <= 0) return false;
    auto bytes = port_->read();
    if (!bytes) return bytes.error();
    for (auto& item : parser_.on_bytes(bytes.value())) out.push_back(std::move(item));
    return true;
  }

  Result<void> drain() {
    const auto deadline = Clock::now() + std::chrono::milliseconds(kDrain_ms);
    for (std::vector<SlcanItem> ignored;;) {
      const auto more = await_bytes(deadline, ignored);
      if (!more) return more.error();
      if (!more.value()) return {};
    }
  }

  enum class Answer { done, refused, none };
  Result<Answer> ask(const std::string& command, SlcanItem::Kind wanted) {
    if (auto sent = port_->write(as_bytes(command)); !sent) return sent.error();
    const auto deadline = Clock::now() + std::chrono::milliseconds(kAnswer_ms);
    for (;;) {
      std::vector<SlcanItem> items;
      const auto more = await_bytes(deadline, items);
      if (!more) return more.error();
      for (const SlcanItem& item : items) {
        if (item.kind == wanted) return Answer::done;
        if (item.kind == SlcanItem::Kind::refused) return Answer::refused;
      }
      if (!more.value()) return Answer::none;
    }
  }

  /// From the line's first byte to the end of the read, 10 bits a byte: the frame was over before it began.
  double line_time(const SlcanItem& item) const {
    const double bytes = static_cast<double>(item.bytes + item.bytes_after);
    return options_.baud ? 10.0 * bytes / *options_.baud : 0.0;
  }

  double time_of(const SlcanItem& item, double now) {
    const double seen = now - line_time(item);
    return item.stamp_ms ? clock_.to_host(*item.stamp_ms, seen) : seen;
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
  std::string name_;
  SlcanOptions options_;
  SlcanParser parser_;
  DeviceClock clock_{60'000};
  bool silent_ = false;  // acknowledged none of the set-up commands
  std::uint64_t sent_ = 0, send_failed_ = 0, bus_states_ = 0;
};

Result<void> SlcanTransport::set_up() {
  const std::string rate = bitrate_command(options_.bitrate);
  if (rate.empty())
    return Error{ErrorCode::usage, "no command for " + std::to_string(options_.bitrate) + " bit/s", name_,
                 "use 10000, 20000, 50000, 100000, 125000, 250000, 500000, 800000 or 1000000"};
  if (auto sent = port_->write(as_bytes("\r\r\rC\r")); !sent) return sent.error();
  if (auto drained = drain(); !drained) return drained.error();
  const auto rate_set = ask(rate, SlcanItem::Kind::done);
  if (!rate_set) return rate_set.error();
  if (rate_set.value() == Answer::refused)
    return refuse("adapter refuses the bit rate " + std::to_string(options_.bitrate), "check ?bitrate=...");
  if (options_.timestamps) {
    const auto stamps = ask("Z1\r", SlcanItem::Kind::done);  // may be refused: then arrival times serve
    if (!stamps) return stamps.error();
  }
  const auto opened = ask("O\r", SlcanItem::Kind::done);
  if (!opened) return opened.error();
  if (opened.value() == Answer::refused)
    return refuse("adapter does not open the channel", "unplug it, check the CAN wiring, plug it in again");
  // Some adapters acknowledge nothing and work; python-can and the kernel's slcan ask for nothing either.
  silent_ = rate_set.value() == Answer::none && opened.value() == Answer::none;
  return {};
}

}  // namespace

Result<std::unique_ptr<CanTransport>> open_slcan(std::unique_ptr<ByteStream> port, const std::string& name,
                                                 const SlcanOptions& options) {
  auto transport = std::make_unique<SlcanTransport>(std::move(port), name, options);
  if (auto ready = transport->set_up(); !ready) return ready.error();
  return std::unique_ptr<CanTransport>(std::move(transport));
}

}  // namespace odomcalib::drivers
