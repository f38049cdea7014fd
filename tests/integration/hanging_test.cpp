// A loop that is woken again and again and gets nowhere ends its process, with the robot stopped: the service
// manager starts it anew.
#include <signal.h>
#include <sys/eventfd.h>

#include "tests/integration/service_loop.hpp"

namespace odomcalib::hanging_test {
namespace {

/// Says that work is done, and has none.
class CryingWolf final : public Background {
 public:
  explicit CryingWolf(bool cries) : fd_(eventfd(cries ? 1 : 0, EFD_NONBLOCK | EFD_CLOEXEC)) {}
  ~CryingWolf() override { close(fd_); }
  CryingWolf(const CryingWolf&) = delete;
  CryingWolf& operator=(const CryingWolf&) = delete;
  void post(std::function<void()> work, std::function<void()> done) override {
    work();
    done();
  }
  [[nodiscard]] int fd() const override { return fd_; }

 private:
  int fd_;
};

class Hanging : public ServiceLoop, public ::testing::WithParamInterface<bool> {
 protected:
  std::unique_ptr<Background> disk() override { return std::make_unique<CryingWolf>(GetParam()); }
};

TEST_P(Hanging, at_something_that_is_never_taken_ends_the_process) {
  const auto drive = [this] {
    run(5.0);
    _exit(3);
  };
  if (GetParam())
    EXPECT_EXIT(drive(), ::testing::KilledBySignal(SIGABRT), "");
  else
    EXPECT_EXIT(drive(), ::testing::ExitedWithCode(3), "");
}

INSTANTIATE_TEST_SUITE_P(Loop, Hanging, ::testing::Bool());

}  // namespace
}  // namespace odomcalib::hanging_test
