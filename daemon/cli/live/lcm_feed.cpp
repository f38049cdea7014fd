#include "daemon/cli/live/lcm_feed.hpp"
#include "daemon/cli/settings.hpp"

#include <lcm/lcm.h>
#include <poll.h>

#include <array>

namespace odomcalib::cli {
namespace {

constexpr std::array kChannels = {"ODOM", "ODOM_CALIBRATED", "SCAN", "PROGRESS", "RESULT"};

class Subscription final : public LcmFeed {
 public:
  Subscription(lcm_t* lcm, std::string prefix, Take take)
      : lcm_(lcm), prefix_(std::move(prefix)), take_(std::move(take)) {
    for (const char* channel : kChannels)
      lcm_subscribe(lcm_, (prefix_ + channel).c_str(), &Subscription::on_message, this);
  }
  ~Subscription() override { lcm_destroy(lcm_); }
  Subscription(const Subscription&) = delete;
  Subscription& operator=(const Subscription&) = delete;

  void serve(int timeout_ms) override {
    pollfd ready{lcm_get_fileno(lcm_), POLLIN, 0};
    if (poll(&ready, 1, timeout_ms) <= 0) return;
    for (int taken = 0; taken < settings::kMostMessages && lcm_handle_timeout(lcm_, 0) > 0; ++taken) {
    }
  }

 private:
  // A subscription is a regular expression, which a prefix may happen to be: the name decides.
  static void on_message(const lcm_recv_buf_t* buffer, const char* channel, void* self) {
    const auto& feed = *static_cast<const Subscription*>(self);
    std::string_view name = channel;
    if (!name.starts_with(feed.prefix_)) return;
    name.remove_prefix(feed.prefix_.size());
    feed.take_(name, {static_cast<const char*>(buffer->data), buffer->data_size});
  }

  lcm_t* lcm_;
  std::string prefix_;
  Take take_;
};

}  // namespace

std::unique_ptr<LcmFeed> LcmFeed::open(const std::string& url, const std::string& prefix, Take take) {
  lcm_t* lcm = lcm_create(url.c_str());
  if (lcm == nullptr) return nullptr;
  return std::make_unique<Subscription>(lcm, prefix, std::move(take));
}

}  // namespace odomcalib::cli
