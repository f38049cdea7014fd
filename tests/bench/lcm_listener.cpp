#include "tests/bench/lcm_listener.hpp"

#include "proto/wire/messages.hpp"
#include "tests/bench/wire_player.hpp"

namespace odomcalib::bench {
namespace {

constexpr std::size_t kBeams = 1081;
constexpr int kPatience = 50;  // ms

std::string_view bytes_of(const lcm_recv_buf_t* buffer) {
  return {static_cast<const char*>(buffer->data), buffer->data_size};
}

}  // namespace

LcmListener::LcmListener(const std::string& url) : lcm_(lcm_create(url.c_str())) {
  if (lcm_ == nullptr) return;
  // The handlers' queue must hold a stall of this program.
  lcm_subscription_set_queue_capacity(lcm_subscribe(lcm_, "ODOMCALIB_TICKS", on_ticks, this), 100'000);
  lcm_subscription_set_queue_capacity(lcm_subscribe(lcm_, "ODOMCALIB_SCAN", on_scan, this), 10'000);
  ticks_.reserve(1'000'000);
  thread_ = std::thread([this] { listen(); });
}

LcmListener::~LcmListener() {
  end();
  if (lcm_ != nullptr) lcm_destroy(lcm_);
}

void LcmListener::end() {
  ended_ = true;
  if (thread_.joinable()) thread_.join();
}

void LcmListener::listen() {
  while (!ended_) (void)lcm_handle_timeout(lcm_, kPatience);
}

void LcmListener::on_ticks(const lcm_recv_buf_t* buffer, const char* /*channel*/, void* self) {
  auto& me = *static_cast<LcmListener*>(self);
  const auto message = messages::decode_ticks(bytes_of(buffer));
  if (!message) {
    ++me.wrong_;
    return;
  }
  me.ticks_.push_back({message->ticks.left, 1000 * buffer->recv_utime, wall_ns()});
  ++me.ticks_count_;
}

void LcmListener::on_scan(const lcm_recv_buf_t* buffer, const char* /*channel*/, void* self) {
  auto& me = *static_cast<LcmListener*>(self);
  const auto message = messages::decode_scan(bytes_of(buffer));
  if (!message || message->scan.ranges.size() != kBeams)
    ++me.wrong_;
  else
    me.scans_.push_back({0, 1000 * buffer->recv_utime, wall_ns()});
}

}  // namespace odomcalib::bench
