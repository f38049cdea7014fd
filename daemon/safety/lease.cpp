#include "daemon/safety/lease.hpp"

#include <fmt/format.h>

#include <random>

namespace odomcalib::safety {
namespace {

Error refused(const std::string& what, const std::string& remedy) {
  return {ErrorCode::not_permitted, what, "motion lease", remedy};
}

// Clients of one group share the socket: the name keeps them from renewing each other's lease by accident.
std::string new_id() {
  std::random_device source;
  return fmt::format("{:08x}{:08x}", source(), source());
}

}  // namespace

Result<std::string> Lease::acquire(std::uint64_t owner, double now) {
  if (active(now))
    return refused("another client holds the lease", "wait, or stop it with odomcalibctl stop");
  id_ = new_id();
  owner_ = owner;
  renewed_ = now;
  return id_;
}

Result<void> Lease::renew(const std::string& id, double now) {
  if (!holds(id, now)) return refused("the lease has lapsed or was never given", "acquire a new one");
  renewed_ = now;
  return {};
}

void Lease::release(const std::string& id) {
  if (id == id_) id_.clear();
}

void Lease::lost(std::uint64_t owner) {
  if (owner == owner_) id_.clear();
}

bool Lease::holds(const std::string& id, double now) const { return active(now) && id == id_; }

bool Lease::active(double now) const { return !id_.empty() && now - renewed_ <= kLeaseTime; }

}  // namespace odomcalib::safety
