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

bool real_time(int policy) { return policy == SCHED_RR || policy == SCHED_FIFO; }

std::string text_of(int policy, int priority) {
  if (policy == SCHED_RR) return fmt::format("round robin, priority {}", priority);
  if (policy == SCHED_FIFO) return fmt::format("first in first out, priority {}", priority);
  return fmt::format("no real-time priority, niceness {}", getpriority(PRIO_PROCESS, 0));
}

/// What is in memory now, and whatever comes into it, stays: pages that are not used yet cost nothing.
/// With a limit below what will be needed, a later thread or recording would find no memory at all.
bool lock_memory() {
  rlimit limit{};
  const bool enough =
      geteuid() == 0 || (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY);
  if (!enough) errno = ENOMEM;
  return enough && mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0;
}

}  // namespace

Urgency made_urgent() {
  const int policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
  sched_param priority{};
  (void)sched_getparam(0, &priority);
  // The unit has it already, and forbids to ask.
  if (real_time(policy)) (void)sched_setscheduler(0, policy | SCHED_RESET_ON_FORK, &priority);
  const bool locked = lock_memory();
  const int why = errno;
  Urgency urgency;
  urgency.found = text_of(policy, priority.sched_priority) +
                  (locked ? "; memory locked" : fmt::format("; memory not locked ({})", std::strerror(why)));
  if (!real_time(policy) || !locked)
    urgency.remedy = "other programs may hold up the loop; start it by its unit: systemctl start odomcalib";
  return urgency;
}

void step_back() {
  const sched_param none{};
  (void)sched_setscheduler(0, SCHED_OTHER, &none);
  (void)setpriority(PRIO_PROCESS, 0, service::settings::kLessUrgent);
}

}  // namespace odomcalib
