// Messages of the daemon to systemd: that it is ready before any device is there, and WATCHDOG=1 from the
// loop itself. Its loop is stopped, its other threads are not: the message must stay away.
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "tests/integration/processes.hpp"

namespace odomcalib::test_support::watchdog_test {
namespace {

namespace fs = std::filesystem;

class Watchdog : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = "/tmp/odomcalib-wd-XXXXXX";
    folder_ = mkdtemp(name.data());
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    (folder_ / "notify").string().copy(address.sun_path, sizeof(address.sun_path) - 1);
    ASSERT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    std::ofstream(folder_ / "d.toml")
        << "[controller]\ndevice = \"slcan:" << (folder_ / "absent").string()
        << "?bitrate=500000\"\nprofile = \"" ODOMCALIB_PROFILE
        << "\"\n[lidar]\ndevice = \"serial:" << (folder_ / "none").string()
        << "?baud=230400\"\n[lcm]\nenabled = false\n[daemon]\nstate_dir = \"" << (folder_ / "state").string()
        << "\"\nsocket = \"" << (folder_ / "control").string() << "\"\n";
    daemon_ = std::make_unique<Process>(
        std::vector<std::string>{"/usr/bin/env", "NOTIFY_SOCKET=" + (folder_ / "notify").string(),
                                 "WATCHDOG_USEC=400000", ODOMCALIB_DAEMON, "--config", folder_ / "d.toml"},
        folder_ / "log");
  }
  void TearDown() override {
    daemon_.reset();
    close(socket_);
    fs::remove_all(folder_);
  }
  /// Messages with this text that have come and were not read.
  int heard(const std::string& text) {
    std::array<char, 4096> buffer{};
    int count = 0;
    for (ssize_t got = 0; (got = recv(socket_, buffer.data(), buffer.size(), 0)) > 0;)
      if (std::string(buffer.data(), static_cast<std::size_t>(got)).find(text) != std::string::npos) ++count;
    return count;
  }
  bool hears(const std::string& text, double seconds) {
    return wait_until([&] { return heard(text) > 0; }, seconds);
  }

  fs::path folder_;
  int socket_ = -1;
  std::unique_ptr<Process> daemon_;
};

TEST_F(Watchdog, is_fed_by_the_loop_and_by_nothing_else) {
  ASSERT_TRUE(hears("READY=1", 10.0)) << "without any device";
  ASSERT_TRUE(hears("WATCHDOG=1", 2.0));
  ASSERT_TRUE(hears("no bus", 2.0)) << "the status line says what is missing";
  const fs::path tasks = "/proc/" + std::to_string(daemon_->id()) + "/task";
  ASSERT_GT(std::distance(fs::directory_iterator(tasks), fs::directory_iterator()), 1)
      << "other threads run on";
  ASSERT_EQ(ptrace(PTRACE_SEIZE, daemon_->id(), nullptr, nullptr), 0);
  ASSERT_EQ(ptrace(PTRACE_INTERRUPT, daemon_->id(), nullptr, nullptr), 0);
  int status = 0;
  ASSERT_EQ(waitpid(daemon_->id(), &status, __WALL), daemon_->id());
  ASSERT_TRUE(WIFSTOPPED(status));
  (void)heard("");
  EXPECT_FALSE(hears("WATCHDOG=1", 1.5)) << "five times its period";
  ASSERT_EQ(ptrace(PTRACE_DETACH, daemon_->id(), nullptr, nullptr), 0);
  EXPECT_TRUE(hears("WATCHDOG=1", 2.0));
}

}  // namespace
}  // namespace odomcalib::test_support::watchdog_test
