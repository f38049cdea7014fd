// Whole sessions at the control socket: what several clients write, when they come and go, and how much time
// passes meanwhile. The daemon's loop serves it with everything that belongs to it; the robot is simulated,
// time is virtual. Each record is a byte (action in its low three bits, client in the others), a byte that
// says how much, and for an action that sends bytes the bytes. A byte 1 among these stands for the lease that
// was given last, which nobody could guess.
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "daemon/service/loop.hpp"
#include "daemon/service/settings.hpp"
#include "drivers/serial/port.hpp"
#include "proto/control/control.hpp"
#include "tests/fuzz/scratch_folder.hpp"
#include "tests/fuzz/session_robot.hpp"
#include "tests/fuzz/share.hpp"

namespace odomcalib::fuzz {
namespace {

SessionRobot* robot_at_the_wires = nullptr;

class MemoryBus final : public drivers::CanTransport {
 public:
  [[nodiscard]] int fd() const override { return -1; }
  Result<void> send(const drivers::CanFrame& frame) override {
    robot_at_the_wires->receive(frame);
    return {};
  }
  Result<std::vector<drivers::CanFrame>> receive(double now) override {
    return robot_at_the_wires->take_frames(now);
  }
  [[nodiscard]] drivers::Counters counters() const override { return {}; }
  [[nodiscard]] std::uint64_t taken() const override { return 0; }
};

class MemoryPort final : public drivers::ByteStream {
 public:
  [[nodiscard]] int fd() const override { return -1; }
  Result<std::vector<std::uint8_t>> read() override { return robot_at_the_wires->take_lidar_bytes(); }
  Result<void> write(std::span<const std::uint8_t> /*bytes*/) override { return {}; }
};

}  // namespace
}  // namespace odomcalib::fuzz

namespace odomcalib::drivers {

Result<std::unique_ptr<CanTransport>> open_can(const std::string& /*device*/) {
  return std::unique_ptr<CanTransport>(std::make_unique<fuzz::MemoryBus>());
}

Result<std::unique_ptr<ByteStream>> open_serial(const std::string& /*path*/, unsigned /*baud*/,
                                                const ModemLines& /*lines*/) {
  return std::unique_ptr<ByteStream>(std::make_unique<fuzz::MemoryPort>());
}

}  // namespace odomcalib::drivers

namespace odomcalib::fuzz {
namespace {

using nlohmann::json;

constexpr double kTurn = 0.010;       // s, virtual, between two turns of the loop
constexpr int kLongestBoot = 600;     // turns until the robot is ready
constexpr int kLongestRest = 60;      // turns until it has come to rest, or a new one is quicker
constexpr int kMostTurns = 150;       // that an input may ask for
constexpr int kLongestEnd = 1000;     // turns from the last stop until nothing runs any more
constexpr int kTurnsToStop = 2;       // until a drive that must not turn is told so
constexpr double kLongestTurn = 2.0;  // s of the processor, with sanitizers; 20 ms without
constexpr std::size_t kClients = 12;  // more than the server takes: eight, and two that may stop
constexpr char kLeaseMark = '\1';

const std::string kInterface = std::string(control::kInterface) + ".";

class VirtualClock final : public Clock {
 public:
  [[nodiscard]] double now() const override { return time += each_look; }
  [[nodiscard]] std::int64_t wall_us() const override {
    return static_cast<std::int64_t>(1.7e15 + time * 1e6);
  }
  mutable double time = 100.0;  // s
  double each_look = 0.0;       // s that pass from one look at the clock to the next
};

double processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// One connection, with what a client may expect of it.
class Peer {
 public:
  explicit Peer(const std::filesystem::path& path)
      : fd_(socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
    open_ = connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  }
  ~Peer() { close(fd_); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  /// Calls that the server has whole with these bytes; none when the connection is gone.
  std::vector<control::Call> put(const std::string& bytes) {
    if (!open_ ||
        ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size())) {
      open_ = false;
      return {};
    }
    std::vector<control::Call> whole;
    sent_.feed(bytes);
    while (const auto frame = sent_.next()) {
      const auto call = control::decode_call(*frame);
      if (call) {
        whole.push_back(call.value());
      } else {
        refused_ = true;  // what is no call ends the connection, after an answer at most
        ++calls_;
      }
    }
    for (const control::Call& call : whole) note(call);
    return whole;
  }
  /// Replies that have come.
  std::vector<control::Reply> take() {
    std::array<char, 65536> buffer;
    ssize_t got = 0;
    while ((got = read(fd_, buffer.data(), buffer.size())) > 0)
      got_.feed({buffer.data(), static_cast<std::size_t>(got)});
    if (got == 0) open_ = false;
    std::vector<control::Reply> replies;
    while (const auto frame = got_.next()) {
      auto reply = control::decode_reply(*frame);
      require(reply.ok());
      if (!reply.value().continues) ++answers_;
      replies.push_back(std::move(reply).value());
    }
    return replies;
  }
  /// No call has more than one answer.
  void check_answers() const { require(answers_ <= calls_); }
  /// Each has one; one that asks for events may do without.
  void check_all_answered() const {
    check_answers();
    require(!open_ || refused_ || answers_ + may_be_silent_ >= calls_);
  }
  [[nodiscard]] bool open() const { return open_; }
  /// It has sent what is no call.
  [[nodiscard]] bool refused() const { return refused_; }

  bool reads = true;

 private:
  void note(const control::Call& call) {
    if (call.oneway) return;  // it asks for no answer, and gets none
    ++calls_;
    if (call.more && call.method == kInterface + "Monitor") ++may_be_silent_;
  }

  int fd_;
  bool open_ = false, refused_ = false;
  std::size_t calls_ = 0, may_be_silent_ = 0, answers_ = 0;
  control::FrameDecoder sent_, got_;
};

std::string frame_of(const std::string& name, const std::string& parameters, bool more = false) {
  return R"({"method":")" + kInterface + name + R"(","parameters":)" + parameters +
         (more ? R"(,"more":true})" : "}") + '\0';
}

/// Whole calls, for inputs that do not spell them.
const std::vector<std::string>& usual_calls() {
  static const std::vector<std::string> kCalls = {
      frame_of("Stop", "{}"),
      frame_of("Acquire", "{}"),
      frame_of("Renew", "{\"lease\":\"\1\"}"),
      frame_of("Straight", "{\"lease\":\"\1\",\"distance\":0.3}", true),
      frame_of("Spin", "{\"lease\":\"\1\",\"turns\":0.2,\"direction\":\"cw\"}"),
      frame_of("Check", "{\"lease\":\"\1\",\"nudge\":true}", true),
      frame_of("Release", "{\"lease\":\"\1\"}"),
      frame_of("GetStatus", "{}"),
      frame_of("Monitor", "{}", true),
      frame_of("Record", "{\"name\":\"fuzz\",\"duration\":0}", true),
      frame_of("Calibrate", "{\"lease\":\"\1\",\"options\":{\"quick\":true}}", true),
      frame_of("Straight", "{\"lease\":\"\1\",\"distance\":1,\"dry_run\":true}"),
      frame_of("SetParameters", "{\"lease\":\"\1\",\"values\":{\"track_width\":0.401}}"),
      frame_of("Rollback", "{\"lease\":\"\1\"}"),
      frame_of("GetParameters", "{}"),
      frame_of("History", "{\"limit\":3}"),
      frame_of("Straight", "{\"lease\":\"guess\",\"distance\":0.3}"),
      frame_of("Describe", "{}"),
  };
  return kCalls;
}

/// A state that must not last longer than stopping takes.
class Late {
 public:
  void check(bool wrong) {
    turns_ = wrong ? turns_ + 1 : 0;
    require(turns_ <= kTurnsToStop);
  }

 private:
  int turns_ = 0;
};

class Session {
 public:
  Session() {
    std::filesystem::remove_all(folder().path() / "state");
    robot_at_the_wires = &robot_;
    loop_ = std::make_unique<Loop>(config_, clock_, Calibrator{}, opened(config_),
                                   std::make_unique<Foreground>(), EventLog{});
    for (int i = 0; i < kLongestBoot && !ready(); ++i) turn();
    require(ready());
    written_ = false;
  }

  void run(std::span<const std::uint8_t> records) {
    while (records.size() >= 2) {
      const auto action = records[0] & 7U;
      const std::size_t client = (records[0] >> 3U) % kClients, much = records[1];
      records = records.subspan(2);
      const auto bytes = records.first(action == 2 ? std::min(much, records.size()) : 0);
      records = records.subspan(bytes.size());
      act(action, client, much, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }
    end();
  }
  /// The next input finds a robot at rest that holds its first values. Starting a daemon for each would take
  /// half of the time.
  [[nodiscard]] bool usable() const { return !written_ && ready(); }

 private:
  static const ScratchFolder& folder() {
    static const ScratchFolder kFolder;
    return kFolder;
  }
  static Config configuration() {
    Config config;
    config.controller_device = "socketcan:memory";
    config.controller_profile = ODOMCALIB_PROFILE;
    config.lidar_device = "serial:memory?baud=230400";
    config.lidar_pose = {0.1, 0.0, 0.0};
    config.countdown = 0.0;
    config.lcm_enabled = false;
    config.state_dir = folder().path() / "state";
    config.socket = folder().path() / "control";
    return config;
  }
  static Opened opened(const Config& config) {
    auto base = BaseLink::create(config.controller_device, config.controller_profile);
    auto lidar = LidarLink::create(config.lidar_device, config.lidar_type);
    auto state = StateFolder::open(config.state_dir);
    auto journal = Journal::open(config.state_dir / "journal");
    auto server = ControlServer::create(config.socket, config.group);
    require(base.ok() && lidar.ok() && state.ok() && journal.ok() && server.ok());
    return {std::move(base).value(),  std::move(lidar).value(),   std::move(server).value(),
            std::move(state).value(), std::move(journal).value(), {}};
  }
  [[nodiscard]] const RobotParts& parts() const { return loop_->parts(); }
  [[nodiscard]] bool moves() const { return loop_->task() != nullptr && loop_->task()->moves(); }
  [[nodiscard]] bool ready() const {
    const Drive& drive = parts().drive;
    return drive.controller().state() == drivers::ControllerState::disabled && drive.values_known &&
           !drive.encoders.stale(clock_.time) && !parts().surroundings.scans.stale(clock_.time) && idle();
  }
  [[nodiscard]] bool idle() const {
    return loop_->task() == nullptr && !parts().write_back.busy() && !parts().outbox.server.calls_wait();
  }

  void act(unsigned action, std::size_t client, std::size_t much, std::string_view bytes) {
    const auto& calls = usual_calls();
    switch (action) {
      case 0:
        return come(client);
      case 1:
        return hang_up(client);
      case 2:
        return put(client, bytes);
      case 3:
        return put(client, calls[much % calls.size()]);
      case 4:
        return turns(much, false);
      case 5:
        return turns(much, true);
      case 6:
        return listen_or_not(client, much % 2 == 0);
      default:
        clock_.each_look = 0.0005 * static_cast<double>(much % 4);
        return;
    }
  }
  void come(std::size_t client) {
    hang_up(client);
    clients_[client] = std::make_unique<Peer>(config_.socket);
    const auto free = std::count(clients_.begin(), clients_.end(), nullptr);
    unlooked_ = unlooked_ || kClients - static_cast<std::size_t>(free) > ControlServer::kMostClients;
  }
  void listen_or_not(std::size_t client, bool listens) {
    if (clients_[client]) clients_[client]->reads = listens;
  }
  void hang_up(std::size_t client) {
    if (!clients_[client]) return;
    clients_[client]->check_answers();
    if (holder_ == clients_[client].get()) holder_gone();
    clients_[client].reset();
  }
  void put(std::size_t client, std::string_view given) {
    if (!clients_[client]) come(client);
    Peer& peer = *clients_[client];
    for (const control::Call& call : peer.put(with_lease(given))) note(call);
    unlooked_ = unlooked_ || peer.refused();
  }
  /// Notes a call's meaning for a robot that moves. A stop that is spelled with escapes waits for its turn.
  void note(const control::Call& call) {
    if (!lease_.empty() &&
        call.parameters.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).find(lease_) !=
            std::string::npos)
      renewed_ = clock_.time;
    stop_sent_ = stop_sent_ || call.method == kInterface + "Stop";
    unlooked_ = unlooked_ || control::answer_introspection(call, {});
  }
  void turns(std::size_t count, bool renewing) {
    for (std::size_t i = 0; i <= count && turns_ < kMostTurns; ++i, ++turns_) {
      if (renewing && i % 4 == 0 && holder_ != nullptr)
        for (const control::Call& call : holder_->put(with_lease(usual_calls()[2]))) note(call);
      turn();
    }
  }
  [[nodiscard]] std::string with_lease(std::string_view given) const {
    std::string text;
    for (const char c : given) c == kLeaseMark ? text += lease_ : text += c;
    return text;
  }
  void holder_gone() {
    holder_ = nullptr;
    renewed_ = std::min(renewed_, clock_.time - safety::kLongestSilence);
  }

  void turn() {
    clock_.time += kTurn;
    robot_.advance(clock_.time - std::exchange(robot_time_, clock_.time));
    const bool moved = moves();
    const auto served = parts().outbox.server.counters().served;
    const double begin = processor_time();
    loop_->wait(0);
    loop_->turn();
    require(processor_time() - begin < kLongestTurn);
    check_served(parts().outbox.server.counters().served - served);
    check_stop(moved);
    for (auto& peer : clients_)
      if (peer && peer->reads) listen(*peer);
    check_motion();
    written_ = written_ || parts().write_back.busy();
  }
  /// A turn serves so many calls of each client, and none after its time.
  void check_served(std::uint64_t served) const {
    require(served <=
            ControlServer::kCallsPerTurn * (ControlServer::kMostClients + ControlServer::kSpareClients));
    if (clock_.each_look > 0.0 && !unlooked_)
      require(static_cast<double>(served) <= 2.0 + service::settings::kCallTime_s / clock_.each_look);
  }
  void check_stop(bool moved) {
    stopping_ = (std::exchange(stop_sent_, false) && moved) || stopping_;
    stopping_ = stopping_ && (moves() || robot_.driven());
    late_for_stop_.check(stopping_);
  }
  void listen(Peer& peer) {
    for (const control::Reply& reply : peer.take()) {
      const auto answer = json::parse(reply.parameters);
      if (!answer.contains("lease") || !answer.contains("ttl_ms")) continue;
      lease_ = answer["lease"];
      holder_ = &peer;
      renewed_ = clock_.time;
    }
    if (!peer.open() && holder_ == &peer) holder_gone();
  }
  /// Nobody but a client that holds a lease and says so moves the robot.
  void check_motion() {
    late_for_lease_.check(robot_.driven() && !parts().lease.active());
    late_for_silence_.check(robot_.driven() && clock_.time - renewed_ > safety::kLongestSilence);
    require(!robot_.driven() || !lease_.empty());
  }

  /// Whatever was asked for, a stop ends it, and everybody has been answered. There is a place for whoever
  /// stops, however many are connected.
  void end() {
    clock_.each_look = 0.0;
    turn();  // whoever waits at the door comes in
    Peer last(config_.socket);
    for (const control::Call& call : last.put(usual_calls()[0])) note(call);
    require(stop_sent_);
    for (auto& peer : clients_)
      if (peer) peer->reads = true;
    turn();
    for (int left = kLongestEnd; left > 0 && !idle(); --left) {
      turn();
      // The thread that writes a recording has a time of its own.
      for (int i = 0; i < 1000 && parts().outbox.telemetry.recorder.finishing(); ++i) wait_for_disk();
    }
    require(idle());
    turn();  // what was left to be sent
    listen(last);
    last.check_all_answered();
    for (std::size_t i = 0; i < kClients; ++i) {
      if (clients_[i]) clients_[i]->check_all_answered();
      hang_up(i);
    }
    for (int i = 0; i < kLongestRest && (i == 0 || !ready()); ++i) turn();
    std::error_code ignored;
    std::filesystem::remove_all(config_.state_dir / "recordings", ignored);
    lease_.clear();
    unlooked_ = false;
    turns_ = 0;
  }
  void wait_for_disk() {
    std::this_thread::sleep_for(std::chrono::microseconds(50));
    turn();
  }

  const Config config_ = configuration();
  SessionRobot robot_;
  VirtualClock clock_;
  std::unique_ptr<Loop> loop_;
  std::array<std::unique_ptr<Peer>, kClients> clients_;
  std::string lease_;       // the last that was given
  Peer* holder_ = nullptr;  // who got it, while connected
  double renewed_ = 0.0;    // s, when a client last named it
  double robot_time_ = clock_.time;
  Late late_for_stop_, late_for_lease_, late_for_silence_;
  bool stop_sent_ = false;  // since the last turn
  bool stopping_ = false;
  bool written_ = false;   // values were, since it was ready
  bool unlooked_ = false;  // the socket answers calls: nobody looks at the clock between them
  int turns_ = 0;
};

}  // namespace
}  // namespace odomcalib::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static std::unique_ptr<odomcalib::fuzz::Session> session;
  if (!session || !session->usable()) {
    session.reset();  // one daemon at a time owns the socket and the folder
    session = std::make_unique<odomcalib::fuzz::Session>();
  }
  session->run({data, size});
  return 0;
}
