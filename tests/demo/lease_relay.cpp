#include "tests/demo/lease_relay.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>
#include <optional>

namespace odomcalib::demo {
namespace {

/// s of real time without a renewal after which a client counts as gone: the service's own 0.12 s, and the
/// pauses of a machine that simulates with all it has.
constexpr double kSilence = 0.5;
/// s of the service's time between renewals, a quarter of what a lease lasts.
constexpr double kRenewal = 0.03;

std::optional<sockaddr_un> address_of(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.string().size() >= sizeof address.sun_path) return std::nullopt;
  path.string().copy(address.sun_path, sizeof address.sun_path - 1);
  return address;
}

/// Reads all bytes that have arrived. Whether the other end is still there.
bool read_all(int fd, std::string& bytes) {
  std::array<char, 65536> buffer;
  for (;;) {
    const ssize_t got = read(fd, buffer.data(), buffer.size());
    if (got == 0) return false;
    if (got < 0) return errno == EAGAIN || errno == EINTR;
    bytes.append(buffer.data(), static_cast<std::size_t>(got));
  }
}

bool send_all(int fd, std::string& bytes) {
  while (!bytes.empty()) {
    const ssize_t put = send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (put < 0) return errno == EAGAIN || errno == EINTR;
    bytes.erase(0, static_cast<std::size_t>(put));
  }
  return true;
}

}  // namespace

Result<std::unique_ptr<LeaseRelay>> LeaseRelay::create(const std::filesystem::path& front,
                                                       std::filesystem::path back) {
  const auto address = address_of(front);
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  std::error_code absent;
  std::filesystem::remove(front, absent);
  if (!address || fd < 0 || bind(fd, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0 ||
      listen(fd, 8) != 0) {
    close(fd);
    return Error{ErrorCode::io, "cannot listen", front.string(),
                 "choose a shorter path in an existing folder"};
  }
  return std::unique_ptr<LeaseRelay>(new LeaseRelay(fd, std::move(back)));
}

LeaseRelay::~LeaseRelay() {
  drop_all();
  close(listener_);
}

void LeaseRelay::drop_all() {
  for (const Pair& pair : pairs_) {
    close(pair.client);
    close(pair.service);
  }
  pairs_.clear();
}

bool LeaseRelay::leased() const {
  for (const Pair& pair : pairs_)
    if (!pair.lease.empty()) return true;
  return false;
}

void LeaseRelay::accept_clients() {
  const auto address = address_of(back_);
  for (int client = -1; (client = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)) >= 0;) {
    const int service = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (address && connect(service, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) == 0) {
      Pair pair;
      pair.client = client;
      pair.service = service;
      pairs_.push_back(std::move(pair));
    } else {
      close(client);
      close(service);
    }
  }
}

// A client's own renewals are kept back: they are of its time.
void LeaseRelay::read_calls(Pair& pair, double real_now) {
  std::string bytes;
  pair.over = !read_all(pair.client, bytes) || pair.over;
  pair.calls.feed(bytes);
  while (const auto frame = pair.calls.next()) {
    const auto call = control::decode_call(*frame);
    if (call && call.value().name() == "Renew")
      pair.renewed = real_now;
    else
      pair.to_service.append(*frame).push_back('\0');
  }
}

void LeaseRelay::read_replies(Pair& pair) {
  std::string bytes;
  pair.over = !read_all(pair.service, bytes) || pair.over;
  pair.to_client += bytes;
  pair.replies.feed(bytes);
  while (const auto frame = pair.replies.next()) {
    const auto reply = control::decode_reply(*frame);
    if (!reply || reply.value().continues) continue;
    const auto body = nlohmann::json::parse(reply.value().parameters, nullptr, false);
    if (body.is_object() && body.contains("lease") && body["lease"].is_string())
      pair.lease = body["lease"].get<std::string>();
  }
}

void LeaseRelay::renew(Pair& pair, double real_now, double service_now) {
  if (pair.lease.empty()) return;
  if (pair.passed_on == 0.0) pair.renewed = real_now;
  if (real_now - pair.renewed > kSilence) {
    pair.lease.clear();  // and the service will stop what it holds
    return;
  }
  if (service_now - pair.passed_on < kRenewal) return;
  pair.passed_on = service_now;
  control::Call call;
  call.method = std::string(control::kInterface) + ".Renew";
  call.parameters = {{"lease", pair.lease}};
  call.oneway = true;
  pair.to_service += control::encode_call(call);
}

void LeaseRelay::serve(double real_now, double service_now) {
  accept_clients();
  for (Pair& pair : pairs_) {
    read_calls(pair, real_now);
    read_replies(pair);
    renew(pair, real_now, service_now);
    pair.over =
        !send_all(pair.service, pair.to_service) || !send_all(pair.client, pair.to_client) || pair.over;
  }
  std::erase_if(pairs_, [](const Pair& pair) {
    if (pair.over) {
      close(pair.client);
      close(pair.service);
    }
    return pair.over;
  });
}

}  // namespace odomcalib::demo
