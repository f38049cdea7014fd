#include "daemon/cli/interrupts.hpp"

#include <signal.h>
#include <unistd.h>

#include <string_view>

#include "daemon/cli/exit_codes.hpp"

namespace odomcalib::cli {
namespace {

constexpr std::string_view kTold = "\nodomcalibctl: interrupted\n";
constexpr std::string_view kObject =
    R"({"format":"odomcalib-error/1",)"
    R"("error":{"code":"cancelled","what":"interrupted","where":"odomcalibctl","remedy":"start again"}})"
    "\n";

volatile sig_atomic_t prints_json = 0;
volatile sig_atomic_t finish = 0;

// Outputs are written whole or not at all, so the program may end anywhere. Nothing here but what a signal
// handler may call.
void on_interrupt(int /*number*/) {
  (void)!write(STDERR_FILENO, kTold.data(), kTold.size());
  if (prints_json != 0) (void)!write(STDOUT_FILENO, kObject.data(), kObject.size());
  _exit(kCancelled);
}

void on_finish(int /*number*/) { finish = 1; }

}  // namespace

void end_when_interrupted(JsonMode json) {
  prints_json = json == JsonMode::off ? 0 : 1;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    sigaction(number, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = on_interrupt;
    sigaction(number, &action, nullptr);
  }
}

void finish_when_interrupted() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    action.sa_handler = on_finish;
    sigaction(number, &action, nullptr);
  }
}

bool interrupted() { return finish != 0; }

}  // namespace odomcalib::cli
