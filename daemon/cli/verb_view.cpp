// A page on loopback that shows what the robot does while it does it. It asks and listens; it holds no lease.
#include <fmt/format.h>
#include <lcm/lcm.h>
#include <poll.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <functional>
#include <iostream>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "daemon/cli/client.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/interrupts.hpp"
#include "daemon/cli/live/live_page.hpp"
#include "daemon/cli/live/live_state.hpp"
#include "daemon/cli/live/page_server.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/settings.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

struct Options {
  int port = 8038;
  double duration = 0.0;
};

/// The newest document, between the loop that makes it and the threads that serve it.
class Board {
 public:
  void put(std::string text) {
    const std::scoped_lock lock(mutex_);
    text_ = std::move(text);
  }
  std::string get() const {
    const std::scoped_lock lock(mutex_);
    return text_;
  }

 private:
  mutable std::mutex mutex_;
  std::string text_;
};

Result<ordered_json> ask(Client& client, const char* method, const char* member) {
  const auto answer = client.call(method, ordered_json::object(), settings::kAnswerWithin_ms);
  if (!answer) return answer.error();
  return answer.value().is_object() ? answer.value().value(member, ordered_json()) : ordered_json();
}

constexpr std::array kChannels = {"ODOM", "ODOM_CALIBRATED", "SCAN", "PROGRESS", "RESULT"};

/// Messages that the daemon publishes on LCM, as they arrive.
class LcmFeed {
 public:
  /// @param channel without prefix
  using Take = std::function<void(std::string_view channel, std::string_view bytes)>;
  /// Null when the URL cannot be opened.
  static std::unique_ptr<LcmFeed> open(const std::string& url, const std::string& prefix, Take take) {
    lcm_t* lcm = lcm_create(url.c_str());
    return lcm != nullptr ? std::make_unique<LcmFeed>(lcm, prefix, std::move(take)) : nullptr;
  }
  LcmFeed(lcm_t* lcm, std::string prefix, Take take)
      : lcm_(lcm), prefix_(std::move(prefix)), take_(std::move(take)) {
    for (const char* channel : kChannels)
      lcm_subscribe(lcm_, (prefix_ + channel).c_str(), &LcmFeed::on_message, this);
  }
  ~LcmFeed() { lcm_destroy(lcm_); }
  LcmFeed(const LcmFeed&) = delete;
  LcmFeed& operator=(const LcmFeed&) = delete;
  /// Waits for messages for so long, and hands over those that came. Returns early when a signal comes.
  void serve(int timeout_ms) {
    pollfd ready{lcm_get_fileno(lcm_), POLLIN, 0};
    if (poll(&ready, 1, timeout_ms) <= 0) return;
    for (int taken = 0; taken < settings::kMostMessages && lcm_handle_timeout(lcm_, 0) > 0; ++taken) {
    }
  }

 private:
  // A subscription is a regular expression, which a prefix may happen to be: the name decides.
  static void on_message(const lcm_recv_buf_t* buffer, const char* channel, void* self) {
    const auto& feed = *static_cast<const LcmFeed*>(self);
    std::string_view name = channel;
    if (!name.starts_with(feed.prefix_)) return;
    name.remove_prefix(feed.prefix_.size());
    feed.take_(name, {static_cast<const char*>(buffer->data), buffer->data_size});
  }

  lcm_t* lcm_;
  std::string prefix_;
  Take take_;
};

/// The daemon as this program sees it: a connection that may be lost and come back, and its messages.
class Watch {
 public:
  explicit Watch(std::string socket) : socket_(std::move(socket)) {}

  Result<void> connect() {
    auto client = Client::connect(socket_);
    if (!client) return client.error();
    const auto description = ask(client.value(), "Describe", "description");
    if (!description) return description.error();
    client_.emplace(std::move(client).value());
    subscribe(description.value());
    return {};
  }

  /// Takes what is new at the daemon; afterwards messages until the time.
  void serve(Clock::time_point until) {
    if (const auto done = client_ ? look() : try_again(); !done) {
      client_.reset();
      feed_.reset();
      state_.disconnect(done.error().text());
    }
    ++turn_;
    for (auto left = until - Clock::now(); left > Clock::duration::zero() && !interrupted();
         left = until - Clock::now())
      wait(static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(left).count()));
  }

  [[nodiscard]] ordered_json document() const { return state_.document(); }

 private:
  void subscribe(const ordered_json& description) {
    const auto lcm = description.value("lcm", ordered_json::object());
    const std::string url = lcm.value("url", "");
    feed_.reset();
    if (!url.empty())
      feed_ = LcmFeed::open(
          url, lcm.value("channel_prefix", ""),
          [this](std::string_view channel, std::string_view bytes) { state_.take_message(channel, bytes); });
    state_.connect(description, feed_ != nullptr);
  }

  Result<void> look() {
    const auto status = ask(*client_, "GetStatus", "status");
    if (!status) return status.error();
    state_.take_status(status.value());
    // An older daemon does not know the method: it shows no scan then.
    if (state_.needs_scan())
      if (const auto scan = ask(*client_, "GetScan", "scan")) state_.take_scan_answer(scan.value());
    if (turn_ % settings::kTurnsPerTable != 0) return {};
    const auto parameters = ask(*client_, "GetParameters", "parameters");
    if (!parameters) return parameters.error();
    state_.take_parameters(parameters.value());
    return {};
  }

  Result<void> try_again() {
    if (turn_ % settings::kTurnsPerTry != 0) return {};
    return connect();
  }

  void wait(int milliseconds) {
    if (feed_)
      feed_->serve(milliseconds);
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
  }

  std::string socket_;
  std::optional<Client> client_;
  LiveState state_;
  std::unique_ptr<LcmFeed> feed_;  ///< after the state that it writes to
  int turn_ = 0;
};

std::string text_of(const ordered_json& document) {
  return document.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

int watch(Watch& daemon, Board& board, const Options& options, const Session& session) {
  const auto begin = Clock::now();
  auto next = begin;
  while (!interrupted() && std::cout) {
    if (options.duration > 0.0 && std::chrono::duration<double>(next - begin).count() >= options.duration)
      break;
    next = std::max(next + settings::kLiveTurn, Clock::now());
    daemon.serve(next);
    const std::string text = text_of(daemon.document());
    if (session.json != JsonMode::off) std::cout << text << std::endl;
    board.put(text);
  }
  return kDone;
}

int view(const Options& options, const Session& session) {
  finish_when_interrupted();
  Watch daemon(session.socket);
  if (const auto connected = daemon.connect(); !connected)
    return report_error(connected.error(), session.json);
  Board board;
  board.put(text_of(daemon.document()));
  const auto server =
      PageServer::open(options.port, std::string(live_page()), [&board] { return board.get(); });
  if (!server) return report_error(server.error(), session.json);
  const std::string url = fmt::format("http://127.0.0.1:{}/", server.value()->port());
  if (session.json == JsonMode::off)
    std::cout << url << std::endl;
  else
    tell(url);
  return watch(daemon, board, options, session);
}

}  // namespace

void add_view(CLI::App& app, Session& session) {
  const auto [verb, options] = add_verb(
      app, session, "view", "Page on this machine that shows scan, paths and progress, until Ctrl-C", view);
  verb->add_option("--port", options->port, "on 127.0.0.1, 0: any that is free")
      ->check(whole(0, 65535))
      ->capture_default_str();
  verb->add_option("--duration", options->duration, "s, 0: until Ctrl-C")->check(finite(0.0, 86400.0));
}

}  // namespace odomcalib::cli
