#include "daemon/cli/client.hpp"

#include <poll.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/cli/settings.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;
using RenewalClock = std::chrono::steady_clock;

volatile sig_atomic_t signalled = 0;

void on_signal(int /*number*/) { signalled = 1; }

Error not_running(const std::string& socket, const std::string& what) {
  return {ErrorCode::not_running, what, socket, "start it with: systemctl start odomcalib"};
}

/// Somebody listens there although the file of that name is gone: the kernel keeps the name that the socket
/// was given (unix(7), /proc/net/unix).
bool listens_without_file(const std::string& socket) {
  std::ifstream sockets("/proc/net/unix");
  for (std::string line; std::getline(sockets, line);)
    if (line.ends_with(' ' + socket)) return true;
  return false;
}

// A busy machine must not delay the renewals. Without the right to this the robot may stop early, no more.
// Work after the motion, such as a long report, is as urgent as before: on one processor it would keep
// the daemon from its life signs.
class Hurry {
 public:
  Hurry() : policy_(sched_getscheduler(0)) {
    (void)sched_getparam(0, &before_);
    const sched_param priority{.sched_priority = settings::kPriority};
    (void)sched_setscheduler(0, SCHED_RR | SCHED_RESET_ON_FORK, &priority);
  }
  ~Hurry() { (void)sched_setscheduler(0, policy_, &before_); }
  Hurry(const Hurry&) = delete;
  Hurry& operator=(const Hurry&) = delete;

 private:
  int policy_;
  sched_param before_{};
};

// With its time: a daemon that reads late knows when it was sent.
ordered_json renewal_of(const std::string& lease) {
  const std::chrono::duration<double> now = RenewalClock::now().time_since_epoch();
  return {{"lease", lease}, {"sent", now.count()}};
}

// Progress goes to the caller; a final reply is returned.
std::optional<control::Reply> final_reply(const control::Reply& reply,
                                          const std::function<void(const ordered_json&)>& progress) {
  if (!reply.continues) return reply;
  const auto body = ordered_json::parse(reply.parameters, nullptr, false);
  if (body.is_object() && body.contains("progress")) progress(body["progress"]);
  return std::nullopt;
}

Result<ordered_json> value_of(const control::Reply& reply) {
  if (!reply.error.empty()) return control::error_of(reply);
  return ordered_json::parse(reply.parameters, nullptr, false);
}

/// The next whole frame; nullopt: it has not come yet.
Result<std::optional<control::Reply>> next_reply(control::FrameDecoder& decoder) {
  const auto frame = decoder.next();
  if (!frame) return std::optional<control::Reply>();
  auto reply = control::decode_reply(*frame);
  if (!reply) return reply.error();
  return std::optional(std::move(reply).value());
}

}  // namespace

SignalsCaught::SignalsCaught() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  for (std::size_t i = 0; i < kNumbers.size(); ++i) sigaction(kNumbers.at(i), &action, &before_.at(i));
}

SignalsCaught::~SignalsCaught() {
  for (std::size_t i = 0; i < kNumbers.size(); ++i) sigaction(kNumbers.at(i), &before_.at(i), nullptr);
}

Client::~Client() {
  if (fd_ >= 0) close(fd_);
}

Client::Client(Client&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), decoder_(std::move(other.decoder_)) {}

Result<Client> Client::connect(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path))
    return Error{ErrorCode::usage, "the path of a socket has at most 107 characters", path, ""};
  std::copy(path.begin(), path.end(), std::begin(address.sun_path));
  Client client(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (::connect(client.fd_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0) return client;
  if (errno == EACCES || errno == EPERM)
    return Error{ErrorCode::not_permitted, "you may not use the control socket", path,
                 "join group odomcalib"};
  if (errno == ENOENT && listens_without_file(path))
    return Error{ErrorCode::not_running, "odomcalibd runs, but somebody removed its control socket", path,
                 "restart it with: systemctl restart odomcalib"};
  return not_running(path, "odomcalibd is not running");
}

Result<void> Client::send(const std::string& method, ordered_json parameters, bool more) {
  control::Call call;
  call.method = std::string(control::kInterface) + "." + method;
  call.parameters = std::move(parameters);
  call.more = more;
  const std::string frame = control::encode_call(call);
  for (std::size_t done = 0; done < frame.size();) {
    const ssize_t put = ::send(fd_, frame.data() + done, frame.size() - done, MSG_NOSIGNAL);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return not_running("control socket", "the connection to odomcalibd was lost");
    done += static_cast<std::size_t>(put);
  }
  return {};
}

Result<std::optional<control::Reply>> Client::receive(int timeout_ms) {
  if (auto waiting = next_reply(decoder_); !waiting || waiting.value()) return waiting;
  pollfd polled{fd_, POLLIN, 0};
  if (poll(&polled, 1, timeout_ms) <= 0) return std::optional<control::Reply>();
  std::array<char, 65536> buffer;
  const ssize_t got = read(fd_, buffer.data(), buffer.size());
  if (got == 0 || (got < 0 && errno != EINTR))
    return not_running("control socket", "the connection to odomcalibd was lost");
  if (got > 0) decoder_.feed({buffer.data(), static_cast<std::size_t>(got)});
  return next_reply(decoder_);
}

Result<ordered_json> Client::call(const std::string& method, ordered_json parameters, int timeout_ms) {
  if (auto sent = send(method, std::move(parameters)); !sent) return sent.error();
  const auto until = RenewalClock::now() + std::chrono::milliseconds(timeout_ms);
  while (RenewalClock::now() < until) {
    const auto reply = receive(50);
    if (!reply) return reply.error();
    if (reply.value()) return value_of(*reply.value());
  }
  return Error{ErrorCode::timeout, "odomcalibd does not answer", method, "see systemctl status odomcalib"};
}

Result<ordered_json> call_once(const std::string& socket, const std::string& method, ordered_json parameters,
                               int timeout_ms) {
  auto client = Client::connect(socket);
  if (!client) return client.error();
  return client.value().call(method, std::move(parameters), timeout_ms);
}

Result<ordered_json> call_with_lease(const std::string& socket, const std::string& method,
                                     ordered_json parameters,
                                     const std::function<void(const ordered_json&)>& progress,
                                     WhenInterrupted interrupted, Client* on) {
  if (signalled != 0 && interrupted != WhenInterrupted::begin)
    return Error{ErrorCode::cancelled, "interrupted", method, "start again"};
  auto keeper = Client::connect(socket);
  if (!keeper) return keeper.error();
  auto own = on == nullptr ? std::optional(Client::connect(socket)) : std::nullopt;
  if (own && !*own) return own->error();
  Client& worker = own ? own->value() : *on;
  const SignalsCaught caught;
  const Hurry until_it_ends;
  const auto given = keeper.value().call("Acquire");
  if (!given) return given.error();
  const auto lease = given.value().value("lease", std::string());
  parameters["lease"] = lease;
  if (auto sent = worker.send(method, std::move(parameters), true); !sent) return sent.error();
  auto next = RenewalClock::now();
  while (signalled == 0 || interrupted != WhenInterrupted::stop) {
    if (RenewalClock::now() >= next) {
      next = RenewalClock::now() + settings::kRenewal;
      if (auto sent = keeper.value().send("Renew", renewal_of(lease)); !sent) return sent.error();
    }
    (void)keeper.value().receive(0);
    const auto reply = worker.receive(10);
    if (!reply) return reply.error();
    if (!reply.value()) continue;
    if (const auto last = final_reply(*reply.value(), progress)) return value_of(*last);
  }
  (void)keeper.value().call("Stop", ordered_json::object(), 500);
  return Error{ErrorCode::cancelled, "interrupted, the robot was stopped", method, "start again"};
}

Result<ordered_json> answer_with(ordered_json answer, const std::string& method, const std::string& member) {
  if (answer.is_object() && (member.empty() || answer.contains(member))) return answer;
  return Error{
      ErrorCode::format, "the daemon's answer has no " + (member.empty() ? "members" : member), method,
      "odomcalibd and odomcalibctl are of different versions: install both again, and restart odomcalibd"};
}

bool stands_in_the_way(const ordered_json& check) {
  if (!check.is_object() || !check.contains("outcome")) return true;
  return check["outcome"] != "ok" && check["outcome"] != "warn";
}

}  // namespace odomcalib::cli
