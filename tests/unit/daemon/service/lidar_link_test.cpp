// Every lidar driver through real file descriptors: the simulated device sits at the far end of a
// pseudo-terminal or a loopback connection. Time is simulated, so that seconds take milliseconds.
#include "daemon/service/lidar_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>
#include <thread>
#include <utility>

#include "tests/sim/wires/cola_device.hpp"
#include "tests/sim/wires/pty.hpp"
#include "tests/sim/wires/rplidar_device.hpp"
#include "tests/sim/wires/scip_device.hpp"
#include "tests/sim/wires/tcp_port.hpp"
#include "tests/sim/wires/xv11_device.hpp"
#include "tests/sim/wires/ydlidar_device.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::lidar_link_test {
namespace {

constexpr double kTurn = 1e-3;          // s between turns of the loop
constexpr double kTolerance_m = 0.003;  // 2 ms at 1 m/s, and the millimetre of the protocols

class At : public Clock {
 public:
  explicit At(double now) : now_(now) {}
  [[nodiscard]] double now() const override { return now_; }
  [[nodiscard]] std::int64_t wall_us() const override { return 0; }

 private:
  double now_;
};

/// A clock whose owner is put aside for a while after it has looked at it for the first time.
class PutAside : public Clock {
 public:
  PutAside(const double& now, std::function<void()> pause) : now_(now), pause_(std::move(pause)) {}
  [[nodiscard]] double now() const override {
    const double read = now_;
    if (pause_) std::exchange(pause_, nullptr)();
    return read;
  }
  [[nodiscard]] std::int64_t wall_us() const override { return 0; }

 private:
  const double& now_;
  mutable std::function<void()> pause_;
};

/// A device, its port, and a link to it.
template <typename Port>
class Bench {
 public:
  /// @param options of the device string, such as "?baud=256000"
  Bench(std::unique_ptr<sim::LidarDevice> device, const std::string& type, const std::string& options = "")
      : device_(std::move(device)) {
    open_port();
    auto made = LidarLink::create(address() + options, type);
    EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().text());
    link_.emplace(std::move(made).value());
  }

  /// Whole scans of so many seconds.
  std::vector<Scan> run(double seconds) {
    std::vector<Scan> out;
    for (const double end = now + seconds; now < end; now += kTurn) {
      if (device_ && port_) serve();
      link_->step(At(now));
      for (Scan& scan : link_->take_scans()) out.push_back(std::move(scan));
      const auto counters = link_->counters();
      EXPECT_EQ(counters.at("bytes_in"),
                counters.at("good") + counters.at("skipped") + counters.at("buffered"));
    }
    return out;
  }

  /// The link begins a turn, is put aside for so many seconds, and only then reads.
  void put_aside(double seconds) {
    link_->step(PutAside(now, [this, end = now + seconds] {
      for (; now < end; now += kTurn) serve();
    }));
  }

  void unplug() { port_.reset(); }
  void open_port();
  [[nodiscard]] std::string address() const;
  LidarLink& link() { return *link_; }
  sim::LidarDevice& device() { return *device_; }
  Port& port() { return *port_; }
  /// Destroys the link, and returns what it then sent.
  std::string close_link() {
    link_.reset();
    return port_->read();
  }
  double now = 0.0;

 private:
  void serve();

  std::unique_ptr<sim::LidarDevice> device_;
  std::unique_ptr<Port> port_;
  std::uint16_t tcp_port_ = 0;
  std::optional<LidarLink> link_;
};

using SerialBench = Bench<sim::Pty>;
using TcpBench = Bench<sim::TcpPort>;

template <>
std::string SerialBench::address() const {
  return "serial:" + testing::TempDir() + "lidar-" + std::to_string(getpid());
}

template <>
void SerialBench::open_port() {
  port_ = std::move(sim::Pty::open()).value();
  ASSERT_TRUE(port_->link_as(address().substr(7)).ok());
}

template <>
void SerialBench::serve() {
  device_->from_host(port_->read(), now);
  device_->advance(now);
  port_->write(device_->take(now));
}

template <>
std::string TcpBench::address() const {
  return "tcp:127.0.0.1:" + std::to_string(tcp_port_);
}

template <>
void TcpBench::open_port() {
  port_ = value_of(sim::TcpPort::open(tcp_port_));
  tcp_port_ = port_->port();
}

template <>
void TcpBench::serve() {
  port_->accept();
  device_->from_host(port_->read(), now);
  device_->advance(now);
  port_->write(device_->take(now));
}

/// Compares every beam with the moving wall at the beam's own direction and moment.
/// @param front direction that the sensor calls straight ahead, rad
void expect_wall(const std::vector<Scan>& scans, double front = 0.0) {
  for (const Scan& scan : scans) {
    int readings = 0;
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      if (scan.ranges[i] == 0.0F) continue;
      const double after = scan.times.empty() ? *scan.time_increment * static_cast<double>(i)
                                              : static_cast<double>(scan.times[i]);
      const double expected = sim::moving_wall(scan.angle(i) - front, scan.t + after);
      ASSERT_NEAR(scan.ranges[i], expected, kTolerance_m) << "beam " << i << " of the scan at " << scan.t;
      ++readings;
    }
    EXPECT_GT(readings, 0.9 * static_cast<double>(scan.ranges.size()));
  }
}

std::string problem_of(LidarLink& link) { return link.problem() ? link.problem()->text() : ""; }

/// Scans of the third second: by then the clocks are known.
std::vector<Scan> settled(std::vector<Scan> scans) {
  std::erase_if(scans, [](const Scan& scan) { return scan.t < 2.0; });
  return scans;
}

TEST(LidarLinks, rplidar_in_every_mode_shows_the_wall_where_and_when_it_was) {
  using Data = sim::RplidarDevice::Data;
  for (const Data data : {Data::standard, Data::express, Data::dense})
    for (const bool configurable : {true, false}) {
      if (!configurable && data != Data::express) continue;  // old firmware has no other
      sim::RplidarDevice::Options options;
      options.data = data;
      options.configurable = configurable;
      options.bytes_per_s = 25'600.0;
      SerialBench bench(std::make_unique<sim::RplidarDevice>(options), "rplidar", "?baud=256000");
      const auto scans = settled(bench.run(3.0));
      EXPECT_GE(scans.size(), 6U);
      expect_wall(scans);
      EXPECT_NE(bench.link().identity().find("model 18h"), std::string::npos);
      EXPECT_EQ(problem_of(bench.link()), "");
    }
}

// The least delay ever seen dates every scan: one that comes out too small does so for a minute.
TEST(LidarLinks, a_loop_that_is_put_aside_before_it_reads_dates_no_scan_too_early) {
  const auto check = [](auto&& bench) {
    (void)bench.run(2.0);
    for (int i = 0; i < 4; ++i) {
      bench.put_aside(0.015);
      const auto scans = bench.run(0.5);
      EXPECT_GE(scans.size(), 2U);
      expect_wall(scans);
    }
  };
  check(TcpBench(std::make_unique<sim::ScipDevice>(sim::ScipDevice::Options{}), "hokuyo"));
  check(SerialBench(std::make_unique<sim::RplidarDevice>(sim::RplidarDevice::Options{}), "rplidar"));
}

TEST(LidarLinks, rplidar_in_error_is_reset_and_then_measures) {
  sim::RplidarDevice::Options options;
  options.health = 2;
  SerialBench bench(std::make_unique<sim::RplidarDevice>(options), "rplidar");
  (void)bench.run(1.0);
  EXPECT_NE(problem_of(bench.link()).find("error 32770"), std::string::npos) << problem_of(bench.link());
  EXPECT_GT(bench.run(3.0).size(), 3U);
  EXPECT_EQ(dynamic_cast<sim::RplidarDevice&>(bench.device()).resets, 1);
  EXPECT_EQ(problem_of(bench.link()), "");
}

TEST(LidarLinks, rplidar_is_stopped_when_the_link_ends) {
  SerialBench bench(std::make_unique<sim::RplidarDevice>(sim::RplidarDevice::Options{}), "rplidar");
  (void)bench.run(1.0);
  EXPECT_EQ(bench.close_link(), "\xA5\x25");
}

TEST(LidarLinks, ydlidar_models_show_the_wall_where_and_when_it_was) {
  struct Case {
    const char* type;
    bool answers, triangulates, intensity;
    double samples_per_s;
  };
  for (const Case& c :
       {Case{"ydlidar:x4", true, true, false, 5000.0}, Case{"ydlidar:x2", false, true, false, 3000.0},
        Case{"ydlidar:g2", true, true, true, 5000.0}, Case{"ydlidar:tg15", true, false, false, 20'000.0}}) {
    sim::YdlidarDevice::Options options{c.answers, c.triangulates, c.intensity, c.samples_per_s};
    options.bytes_per_s = 51'200.0;
    SerialBench bench(std::make_unique<sim::YdlidarDevice>(options), c.type, "?baud=512000");
    const auto scans = settled(bench.run(3.0));
    EXPECT_GE(scans.size(), 5U) << c.type;
    expect_wall(scans);
    EXPECT_EQ(bench.link().identity().empty(), !c.answers);
  }
}

TEST(LidarLinks, a_wrong_ydlidar_model_is_named_as_such) {
  sim::YdlidarDevice::Options options;
  options.answers = false;
  options.intensity = true;
  options.bytes_per_s = 30'000.0;
  SerialBench bench(std::make_unique<sim::YdlidarDevice>(options), "ydlidar:x2");
  EXPECT_TRUE(bench.run(3.0).empty());
  EXPECT_NE(problem_of(bench.link()).find("every checksum is wrong"), std::string::npos);
}

TEST(LidarLinks, hokuyo_over_tcp_and_serial_shows_the_wall_where_and_when_it_was) {
  for (const std::string type : {"hokuyo", "hokuyo:intensity"}) {
    TcpBench network(std::make_unique<sim::ScipDevice>(sim::ScipDevice::Options{}), type);
    const auto scans = settled(network.run(3.0));
    EXPECT_GE(scans.size(), 30U);
    expect_wall(scans);
    EXPECT_NEAR(*scans.back().time_increment, 0.0251 / 1440.0, 1e-8);
    EXPECT_NE(network.link().identity().find("serial H7"), std::string::npos);
    EXPECT_EQ(scans.back().intensities.size(), type == "hokuyo" ? 0U : 1081U);
  }
  SerialBench serial(std::make_unique<sim::ScipDevice>(sim::ScipDevice::Options{}), "scip");
  expect_wall(settled(serial.run(3.0)));
}

TEST(LidarLinks, what_does_not_print_in_a_name_is_replaced) {
  sim::ScipDevice::Options options;
  options.product = "SIM\xFF\x1B";
  TcpBench bench(std::make_unique<sim::ScipDevice>(options), "hokuyo");
  EXPECT_GT(bench.run(1.0).size(), 5U);
  EXPECT_EQ(bench.link().identity(), "SIM?? firmware 1.0 serial H7");
}

TEST(LidarLinks, hokuyo_that_spins_up_is_asked_again) {
  sim::ScipDevice::Options options;
  options.ready_at = 3.0;
  TcpBench bench(std::make_unique<sim::ScipDevice>(options), "hokuyo");
  EXPECT_TRUE(bench.run(2.9).empty());
  EXPECT_NE(problem_of(bench.link()).find("laser"), std::string::npos) << problem_of(bench.link());
  EXPECT_GT(bench.run(2.0).size(), 10U);
  EXPECT_EQ(problem_of(bench.link()), "");
  EXPECT_EQ(bench.close_link(), "QT\n");
}

TEST(LidarLinks, sick_in_both_dialects_shows_the_wall_where_and_when_it_was) {
  for (const bool binary : {true, false}) {
    sim::ColaDevice::Options options;
    options.binary = binary;
    TcpBench bench(std::make_unique<sim::ColaDevice>(options), "sick");
    const auto scans = settled(bench.run(3.0));
    EXPECT_GE(scans.size(), 30U);
    expect_wall(scans, std::numbers::pi / 2.0);
    EXPECT_EQ(scans.back().ranges[7], 0.0F) << "a code is no reading";
    EXPECT_NEAR(*scans.back().time_increment, 0.02011 / 720.0, 1e-8);
    EXPECT_EQ(bench.link().identity(), "SICK SIM 111 1.0");
    EXPECT_EQ(bench.link().counters()["lost_scans"], 0U);
  }
}

TEST(LidarLinks, sick_that_is_not_ready_or_refuses_says_so) {
  sim::ColaDevice::Options late;
  late.ready_at = 2.0;
  TcpBench waiting(std::make_unique<sim::ColaDevice>(late), "sick");
  (void)waiting.run(1.9);
  EXPECT_NE(problem_of(waiting.link()).find("not ready"), std::string::npos);
  EXPECT_GT(waiting.run(1.5).size(), 10U);
  sim::ColaDevice::Options refusing;
  refusing.refuses = true;
  TcpBench refused(std::make_unique<sim::ColaDevice>(refusing), "sick");
  (void)refused.run(1.0);
  EXPECT_NE(problem_of(refused.link()).find("busy"), std::string::npos) << problem_of(refused.link());
}

TEST(LidarLinks, xv11_shows_the_wall_where_and_when_it_was) {
  SerialBench bench(std::make_unique<sim::Xv11Device>(sim::Xv11Device::Options{}), "xv11");
  const auto scans = settled(bench.run(3.0));
  EXPECT_GE(scans.size(), 4U);
  expect_wall(scans);
  for (const Scan& scan : scans) EXPECT_EQ(scan.ranges.size(), 360U);
}

TEST(LidarLinks, a_wrong_baud_rate_is_named_within_three_seconds) {
  SerialBench bench(std::make_unique<sim::Xv11Device>(sim::Xv11Device::Options{}), "xv11");
  bench.device().set_garbled(true);
  EXPECT_TRUE(bench.run(3.0).empty());
  EXPECT_NE(problem_of(bench.link()).find("baud rate"), std::string::npos) << problem_of(bench.link());
  bench.device().set_garbled(false);
  EXPECT_GT(bench.run(3.0).size(), 5U);
  EXPECT_EQ(problem_of(bench.link()), "");
}

TEST(LidarLinks, another_lidar_on_the_port_gives_no_scans_but_a_named_problem) {
  for (const std::string type : {"ld06", "rplidar", "ydlidar", "hokuyo"}) {
    SerialBench bench(std::make_unique<sim::Xv11Device>(sim::Xv11Device::Options{}), type);
    EXPECT_TRUE(bench.run(3.0).empty()) << type;
    EXPECT_NE(problem_of(bench.link()).find("baud rate"), std::string::npos)
        << type << problem_of(bench.link());
  }
}

TEST(LidarLinks, an_unplugged_lidar_is_found_again_within_two_seconds) {
  SerialBench bench(std::make_unique<sim::RplidarDevice>(sim::RplidarDevice::Options{}), "rplidar");
  EXPECT_GT(bench.run(2.0).size(), 5U);
  bench.unplug();
  (void)bench.run(0.1);  // what was under way
  EXPECT_TRUE(bench.run(5.0).empty());
  EXPECT_FALSE(bench.link().connected());
  EXPECT_NE(problem_of(bench.link()), "");
  bench.open_port();
  EXPECT_GT(bench.run(2.0).size(), 3U);
  EXPECT_EQ(bench.link().counters()["reconnects"], 1U);
}

TEST(LidarLinks, a_network_lidar_that_was_away_is_found_again_within_two_seconds) {
  TcpBench bench(std::make_unique<sim::ColaDevice>(sim::ColaDevice::Options{}), "sick");
  EXPECT_GT(bench.run(1.0).size(), 20U);
  bench.unplug();
  (void)bench.run(0.1);  // what was under way
  EXPECT_TRUE(bench.run(5.0).empty());
  EXPECT_FALSE(bench.link().connected());
  bench.open_port();
  EXPECT_GT(bench.run(2.0).size(), 20U);
  EXPECT_EQ(bench.link().counters()["reconnects"], 1U);
}

TEST(LidarLinks, a_connection_that_falls_silent_is_made_anew) {
  auto device = std::make_unique<sim::ColaDevice>(sim::ColaDevice::Options{});
  auto& sick = *device;
  TcpBench bench(std::move(device), "sick");
  EXPECT_GT(bench.run(1.0).size(), 20U);
  sick.forget();  // the device has restarted and knows nothing of the subscription
  EXPECT_GT(bench.run(3.0).size(), 20U) << "asked again";
  EXPECT_EQ(bench.link().counters()["reconnects"], 0U);
  // A dead peer: the connection stands, nothing comes.
  TcpBench dead(nullptr, "sick");
  (void)dead.run(6.0);
  EXPECT_NE(problem_of(dead.link()).find("nothing arrives"), std::string::npos);
  EXPECT_GE(dead.link().counters()["reconnects"], 1U);
}

TEST(LidarLinks, what_a_lidar_cannot_be_reached_by_is_refused_with_an_example) {
  for (const auto& [device, type] : std::vector<std::pair<std::string, std::string>>{
           {"tcp:192.168.0.1", "ld06"}, {"serial:/dev/ttyUSB0", "sick"}, {"socketcan:can0", "hokuyo"}}) {
    const auto made = LidarLink::create(device, type);
    ASSERT_FALSE(made.ok()) << device;
    EXPECT_EQ(made.error().code, ErrorCode::usage);
    EXPECT_NE(made.error().text().find("needs a device like"), std::string::npos);
  }
  EXPECT_FALSE(LidarLink::create("serial:/dev/x", "ld99").ok());
}

TEST(LidarLinks, an_option_that_is_wrong_is_named) {
  for (const auto& [device, said] : {std::pair("serial:/dev/x?baud=0", "\"0\" is no baud rate"),
                                     {"serial:/dev/x?baud=fast", "\"fast\" is no baud rate"},
                                     {"serial:/dev/x?dtr=maybe", "\"dtr=maybe\" is neither 0 nor 1"}}) {
    const auto made = LidarLink::create(device, "rplidar");
    ASSERT_FALSE(made.ok()) << device;
    EXPECT_EQ(made.error().code, ErrorCode::usage);
    EXPECT_EQ(made.error().what, said);
  }
}

/// Report on a lidar at a name, when the name service has answered. Its own times pass outside of the clock.
std::string told_of(LidarLink& link) {
  for (int k = 0; k < 2000; ++k) {
    link.step(At(0.001 * k));
    const auto problem = link.problem();
    std::string said = link.connected() ? "connected" : problem ? problem->text() : "not open yet";
    if (said.find("is being looked up") == std::string::npos) return said;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return "no answer";
}

TEST(LidarLinks, the_name_of_a_host_is_looked_up_and_what_it_stands_for_is_told) {
  auto port = sim::TcpPort::open(0);
  ASSERT_TRUE(port.ok());
  auto named = value_of(LidarLink::create("tcp:localhost:" + std::to_string(port.value()->port()), "sick"));
  EXPECT_EQ(named.host_name(), "localhost");
  EXPECT_EQ(named.found_address(), "");
  EXPECT_EQ(told_of(named).find("has no address"), std::string::npos);
  EXPECT_THAT(named.found_address(),
              ::testing::AnyOf(::testing::HasSubstr("127.0.0.1:"), ::testing::HasSubstr("[::1]:")));
  EXPECT_EQ(LidarLink::create("tcp:192.168.0.1", "sick").value().host_name(), "");
  EXPECT_EQ(LidarLink::create("tcp:[fe80::1]", "sick").value().host_name(), "");
}

TEST(LidarLinks, a_name_without_an_address_is_no_hindrance_to_start_and_is_told) {
  // Longer than a label may be: name services know that without asking anybody.
  const std::string name(70, 'x');
  auto named = value_of(LidarLink::create("tcp:" + name, "sick"));
  EXPECT_EQ(named.host_name(), name);
  const std::string said = told_of(named);
  EXPECT_NE(said.find("the name \"" + name + "\" has no address"), std::string::npos) << said;
  EXPECT_NE(said.find("in numbers"), std::string::npos) << said;
  EXPECT_FALSE(named.connected());
}

}  // namespace
}  // namespace odomcalib::lidar_link_test
