#include "daemon/service/urgency.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "daemon/service/settings.hpp"

namespace odomcalib {
namespace {

namespace settings = service::settings;

bool real_time(int policy) { return policy == SCHED_RR || policy == SCHED_FIFO; }

std::string text_of(int policy, int priority) {
  if (policy == SCHED_RR) return fmt::format("round robin, priority {}", priority);
  if (policy == SCHED_FIFO) return fmt::format("first in first out, priority {}", priority);
  return fmt::format("no real-time priority, niceness {}", getpriority(PRIO_PROCESS, 0));
}

/// Pages in memory now, and those that come into it later, stay: pages that are not used yet cost nothing.
/// With a limit below what will be needed, a later thread or recording would find no memory at all.
bool lock_memory() {
  rlimit limit{};
  const bool enough =
      geteuid() == 0 || (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY);
  if (!enough) errno = ENOMEM;
  return enough && mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0;
}

/// A loop that does not sleep for so long hangs: the kernel ends it, rather than the machine.
void limit_real_time() {
  const rlimit limit{settings::kLongestAwake_us, settings::kLongestAwake_us};
  rlimit present{};
  if (getrlimit(RLIMIT_RTTIME, &present) == 0 && present.rlim_cur == RLIM_INFINITY)
    (void)setrlimit(RLIMIT_RTTIME, &limit);
}

}  // namespace

Urgency made_urgent() {
  int policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
  sched_param priority{};
  (void)sched_getparam(0, &priority);
  if (!real_time(policy)) priority.sched_priority = settings::kLoopPriority;
  const int wanted = real_time(policy) ? policy : SCHED_RR;
  if (sched_setscheduler(0, wanted | SCHED_RESET_ON_FORK, &priority) == 0) policy = wanted;
  if (real_time(policy)) limit_real_time();
  const bool locked = lock_memory();
  const int why = errno;
  Urgency urgency;
  urgency.found = text_of(policy, priority.sched_priority) +
                  (locked ? "; memory locked" : fmt::format("; memory not locked ({})", std::strerror(why)));
  if (!real_time(policy) || !locked)
    urgency.remedy =
        "other programs may hold up the loop; start it by its unit (systemctl start odomcalib), "
        "on a kernel that gives services real time";
  return urgency;
}

void step_back() {
  const sched_param none{};
  (void)sched_setscheduler(0, SCHED_OTHER, &none);
  (void)setpriority(PRIO_PROCESS, 0, settings::kLessUrgent);
}

}  // namespace odomcalib
