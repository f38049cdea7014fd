#include "daemon/service/control_server.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <grp.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>

#include "odomcalib_version.hpp"

namespace odomcalib {
namespace {

// A frame that has not had its turn.
struct Waiting {
  std::string frame;
  double arrived = 0.0;
  bool stopped_since = false;
};

struct Client {
  int fd = -1;
  control::FrameDecoder decoder;
  std::deque<Waiting> waiting;
  std::size_t waiting_bytes = 0;
  std::size_t served = 0;  // calls in this turn
  std::string output;
  std::string name;  // for people
  std::uint32_t user = 0;
  bool spare = false;  // came when all places were taken
  bool gone = false;
};

const std::string kStop = std::string(control::kInterface) + ".Stop";

// Many frames may have to be looked through: only one that contains the name is decoded. A client that spells
// it with escapes is obeyed when its turn comes.
bool is_stop(const std::string& frame) {
  if (frame.find(kStop + '"') == std::string::npos) return false;
  const auto call = control::decode_call(frame);
  return call && call.value().method == kStop;
}

Error failed(const std::string& what, const std::filesystem::path& path) {
  return {ErrorCode::io, what + ": " + std::strerror(errno), path.string(),
          "check that the folder exists and belongs to the daemon's user"};
}

Result<sockaddr_un> address_of(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string text = path.string();
  if (text.size() >= sizeof(address.sun_path))
    return Error{ErrorCode::usage, "the path of a socket has at most 107 characters", text,
                 "choose a shorter one"};
  std::copy(text.begin(), text.end(), std::begin(address.sun_path));
  return address;
}

bool answers(const sockaddr_un& address) {
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool alive = connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(fd);
  return alive;
}

// Asked before the loop begins: a directory may take seconds to answer.
std::optional<gid_t> number_of_group(const std::string& name) {
  const struct group* entry = getgrnam(name.c_str());
  return entry == nullptr ? std::nullopt : std::optional(entry->gr_gid);
}

/// Why members of the group cannot use the socket; empty: they can.
std::string give_to_group(const std::filesystem::path& path, const std::string& name,
                          std::optional<gid_t> group) {
  if (!group)
    return fmt::format("there is no group \"{}\": only root and the daemon's user may use the control socket",
                       name);
  struct stat now {};
  if (stat(path.c_str(), &now) == 0 && now.st_gid == *group) return {};
  if (chown(path.c_str(), static_cast<uid_t>(-1), *group) == 0) return {};
  return fmt::format(
      "the control socket cannot be given to the group \"{0}\": {1}; only root and the daemon's user may use "
      "it; let "
      "the service have the group: systemctl edit odomcalib, [Service] Group={0}",
      name, std::strerror(errno));
}

/// Groups of whoever is at the other end, in numbers: the kernel knows them, no directory has to be asked.
std::vector<gid_t> groups_of(int fd, gid_t first) {
  std::vector<gid_t> groups(64);
  socklen_t size = 0;
  const auto ask = [&] {
    size = static_cast<socklen_t>(groups.size() * sizeof(gid_t));
    return getsockopt(fd, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &size) == 0;
  };
  bool known = ask();
  if (!known && errno == ERANGE) {
    groups.resize(size / sizeof(gid_t));
    known = ask();
  }
  groups.resize(known ? size / sizeof(gid_t) : 0);  // before Linux 4.13 the first one alone
  groups.push_back(first);
  return groups;
}

Result<int> listen_at(const std::filesystem::path& path) {
  const auto address = address_of(path);
  if (!address) return address.error();
  if (answers(address.value()))
    return Error{ErrorCode::io, "another daemon answers at this socket", path.string(), "stop it first"};
  std::error_code ignored;
  std::filesystem::create_directories(path.parent_path(), ignored);
  if (std::filesystem::is_socket(path, ignored)) std::filesystem::remove(path, ignored);
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return failed("socket", path);
  const mode_t before = umask(0117);
  const int bound = bind(fd, reinterpret_cast<const sockaddr*>(&address.value()), sizeof(sockaddr_un));
  umask(before);
  if (bound != 0 || listen(fd, 8) != 0) {
    const Error error = failed("bind", path);
    close(fd);
    return error;
  }
  return fd;
}

}  // namespace

bool may_connect(uid_t user, std::span<const gid_t> groups, std::optional<gid_t> group) {
  if (user == 0 || user == geteuid()) return true;
  return group && std::find(groups.begin(), groups.end(), *group) != groups.end();
}

struct ControlServer::State {
  int listener = -1;
  std::filesystem::path path;
  std::string group, warning;
  std::optional<gid_t> group_id;
  std::map<ClientId, Client> clients;
  ClientId next = 1;
  ClientId served_last = 0;
  double now = 0.0;  // s, of this turn
  bool stop = false;
  std::vector<ClientId> gone;
  Counters counters;

  void accept_all();
  void accept_one(int fd);
  [[nodiscard]] std::size_t count(bool spare) const;
  void drop_oldest_spare();
  void read_from(Client& client);
  void take_frames(Client& client);
  void stopped();
  [[nodiscard]] bool may_be_served(const Client& client) const;
  /// The client whose turn it is, the clients one after the other; end: none has a call for this turn.
  std::map<ClientId, Client>::iterator next_client();
  std::optional<control::Call> decode(Client& client, const std::string& frame);
  std::optional<control::Call> answer_some(Client& client, control::Call call) const;
  void write_to(Client& client);
  void drop_gone();
};

void ControlServer::State::accept_all() {
  for (int i = 0; i < service::settings::kAcceptsPerTurn; ++i) {
    const int fd = accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd < 0) return;
    accept_one(fd);
  }
}

void ControlServer::State::accept_one(int fd) {
  ucred peer{};
  socklen_t size = sizeof(peer);
  const bool known = getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0;
  if (!known || !may_connect(peer.uid, groups_of(fd, peer.gid), group_id)) {
    ++counters.not_permitted;
    const std::string frame =
        control::encode_error({ErrorCode::not_permitted, "you are not in group \"" + group + "\"",
                               path.string(), "ask the administrator to add you, then log in again"});
    (void)!write(fd, frame.data(), frame.size());
    close(fd);
    return;
  }
  ++counters.accepted;
  const bool spare = count(false) >= kMostClients;
  if (spare && count(true) >= kSpareClients) drop_oldest_spare();
  if (spare) ++counters.too_many;
  Client& client = clients[next];
  client.fd = fd;
  client.name = fmt::format("user {}, process {}", peer.uid, peer.pid);
  client.user = peer.uid;
  client.spare = spare;
  // Data that came with the connection counts at once: it may be a stop.
  read_from(client);
  ++next;
}

std::size_t ControlServer::State::count(bool spare) const {
  const auto same = [spare](const auto& entry) { return entry.second.spare == spare; };
  return static_cast<std::size_t>(std::count_if(clients.begin(), clients.end(), same));
}

void ControlServer::State::drop_oldest_spare() {
  const auto oldest =
      std::find_if(clients.begin(), clients.end(), [](const auto& entry) { return entry.second.spare; });
  if (oldest == clients.end()) return;
  write_to(oldest->second);
  close(oldest->second.fd);
  gone.push_back(oldest->first);
  clients.erase(oldest);
}

// Calls made before a stop must not begin after it.
void ControlServer::State::stopped() {
  stop = true;
  for (auto& [id, client] : clients)
    for (Waiting& one : client.waiting) one.stopped_since = true;
}

void ControlServer::State::take_frames(Client& client) {
  while (auto frame = client.decoder.next()) {
    const bool stops = is_stop(*frame);
    client.waiting_bytes += frame->size();
    client.waiting.push_back({std::move(*frame), now, false});
    if (stops) stopped();
  }
}

void ControlServer::State::read_from(Client& client) {
  std::array<char, 65536> buffer;
  const ssize_t got = read(client.fd, buffer.data(), buffer.size());
  if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) client.gone = true;
  if (got <= 0) return;
  counters.bytes += static_cast<std::uint64_t>(got);
  client.decoder.feed({buffer.data(), static_cast<std::size_t>(got)});
  take_frames(client);
  if (client.decoder.counters().oversized > 0) {
    ++counters.malformed;
    client.gone = true;
  }
  if (client.waiting_bytes > kMostWaiting) {
    ++counters.flooded;
    client.gone = true;
  }
}

bool ControlServer::State::may_be_served(const Client& client) const {
  return !client.gone && !client.waiting.empty() && client.served < kCallsPerTurn;
}

std::map<ClientId, Client>::iterator ControlServer::State::next_client() {
  const auto ready = [this](const auto& entry) { return may_be_served(entry.second); };
  const auto behind = clients.upper_bound(served_last);
  const auto found = std::find_if(behind, clients.end(), ready);
  if (found != clients.end()) return found;
  const auto wrapped = std::find_if(clients.begin(), behind, ready);
  return wrapped == behind ? clients.end() : wrapped;
}

// A frame that is no call is counted, and answered with what is wrong with it; then the connection ends.
std::optional<control::Call> ControlServer::State::decode(Client& client, const std::string& frame) {
  auto call = control::decode_call(frame);
  if (call) return answer_some(client, std::move(call).value());
  ++counters.malformed;
  if (const auto answer = control::answer_to_malformed(frame)) client.output += *answer;
  write_to(client);
  client.gone = true;
  return std::nullopt;
}

/// The call, unless the socket itself has the answer.
std::optional<control::Call> ControlServer::State::answer_some(Client& client, control::Call call) const {
  const control::ServiceInfo info{.version = kVersion};
  if (const auto answer = control::answer_introspection(call, info)) {
    if (!call.oneway) client.output += *answer;
    return std::nullopt;
  }
  if (!client.spare || call.name() == "Stop") return call;
  if (call.oneway) return std::nullopt;
  client.output += control::encode_error({ErrorCode::refused, "too many clients are connected", path.string(),
                                          "end one of them; stopping works all the same"});
  return std::nullopt;
}

void ControlServer::State::write_to(Client& client) {
  if (client.output.empty()) return;
  const ssize_t put = send(client.fd, client.output.data(), client.output.size(), MSG_NOSIGNAL);
  if (put > 0) {
    counters.bytes += static_cast<std::uint64_t>(put);
    client.output.erase(0, static_cast<std::size_t>(put));
  }
  if (put < 0 && errno != EAGAIN && errno != EINTR) client.gone = true;
  if (client.output.size() <= kMostOutput) return;
  if (!client.gone) ++counters.too_slow;
  client.gone = true;
  client.output.clear();
}

void ControlServer::State::drop_gone() {
  std::erase_if(clients, [this](const auto& entry) {
    if (!entry.second.gone) return false;
    close(entry.second.fd);
    gone.push_back(entry.first);
    return true;
  });
}

ControlServer::ControlServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
ControlServer::ControlServer(ControlServer&&) noexcept = default;
ControlServer& ControlServer::operator=(ControlServer&&) noexcept = default;

ControlServer::~ControlServer() {
  if (!state_) return;
  for (auto& [id, client] : state_->clients) {
    state_->write_to(client);
    close(client.fd);
  }
  close(state_->listener);
  std::error_code ignored;
  std::filesystem::remove(state_->path, ignored);
}

Result<ControlServer> ControlServer::create(const std::filesystem::path& path, const std::string& group) {
  const auto fd = listen_at(path);
  if (!fd) return fd.error();
  auto state = std::make_unique<State>();
  state->listener = fd.value();
  state->path = path;
  state->group = group;
  state->group_id = number_of_group(group);
  state->warning = give_to_group(path, group, state->group_id);
  return ControlServer(std::move(state));
}

void ControlServer::watch(std::vector<pollfd>& polled) const {
  polled.push_back({state_->listener, POLLIN, 0});
  for (const auto& [id, client] : state_->clients)
    polled.push_back({client.fd, static_cast<short>(client.output.empty() ? POLLIN : POLLIN | POLLOUT), 0});
}

void ControlServer::step(double now) {
  state_->now = now;
  for (auto& [id, client] : state_->clients) {
    client.served = 0;
    state_->read_from(client);
    state_->write_to(client);
  }
  state_->drop_gone();  // first: their places are free for those who come
  state_->accept_all();
}

bool ControlServer::take_stop() { return std::exchange(state_->stop, false); }

bool ControlServer::calls_wait() const {
  return std::any_of(state_->clients.begin(), state_->clients.end(),
                     [](const auto& entry) { return !entry.second.waiting.empty(); });
}

std::optional<IncomingCall> ControlServer::next_call() {
  for (auto it = state_->next_client(); it != state_->clients.end(); it = state_->next_client()) {
    auto& [id, client] = *it;
    const Waiting taken = std::move(client.waiting.front());
    client.waiting.pop_front();
    client.waiting_bytes -= taken.frame.size();
    ++client.served;
    ++state_->counters.served;
    state_->served_last = id;
    if (auto call = state_->decode(client, taken.frame))
      return IncomingCall{id, std::move(*call), taken.arrived, taken.stopped_since};
  }
  return std::nullopt;
}

std::vector<ClientId> ControlServer::take_gone() { return std::exchange(state_->gone, {}); }

void ControlServer::reply(ClientId client, const std::string& frame) {
  const auto found = state_->clients.find(client);
  if (found == state_->clients.end()) return;
  found->second.output += frame;
  state_->write_to(found->second);
}

std::string ControlServer::name_of(ClientId client) const {
  const auto found = state_->clients.find(client);
  return found == state_->clients.end() ? "" : found->second.name;
}

std::optional<std::uint32_t> ControlServer::user_of(ClientId client) const {
  const auto found = state_->clients.find(client);
  return found == state_->clients.end() ? std::nullopt : std::optional(found->second.user);
}

bool ControlServer::connected(ClientId client) const { return state_->clients.contains(client); }
std::size_t ControlServer::clients() const { return state_->clients.size(); }
const std::string& ControlServer::warning() const { return state_->warning; }
const ControlServer::Counters& ControlServer::counters() const { return state_->counters; }

}  // namespace odomcalib
