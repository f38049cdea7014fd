#include "daemon/service/publisher.hpp"

#include <lcm/lcm.h>

#include "daemon/service/settings.hpp"

namespace odomcalib {
namespace {

class LcmOutlet final : public Outlet {
 public:
  explicit LcmOutlet(lcm_t* lcm) : lcm_(lcm) {}
  ~LcmOutlet() override { lcm_destroy(lcm_); }
  LcmOutlet(const LcmOutlet&) = delete;
  LcmOutlet& operator=(const LcmOutlet&) = delete;
  bool publish(const std::string& channel, const std::string& message) override {
    return lcm_publish(lcm_, channel.c_str(), message.data(), static_cast<unsigned>(message.size())) == 0;
  }

 private:
  lcm_t* lcm_;
};

}  // namespace

std::unique_ptr<Outlet> open_lcm(const std::string& url) {
  lcm_t* lcm = lcm_create(url.c_str());
  return lcm != nullptr ? std::make_unique<LcmOutlet>(lcm) : nullptr;
}

Publisher::Publisher(std::string url, std::string prefix, Open open)
    : url_(std::move(url)), prefix_(std::move(prefix)), open_(std::move(open)) {
  if (!url_.empty()) outlet_ = open_(url_);
}

void Publisher::serve(double now) {
  if (url_.empty() || outlet_) return;
  if (!next_try_) next_try_ = now + service::settings::kPublisherRetry_s;
  if (now < *next_try_) return;
  next_try_ = now + service::settings::kPublisherRetry_s;
  outlet_ = open_(url_);
}

void Publisher::send(const std::string& channel, const std::string& message) {
  if (url_.empty()) return;
  ++(outlet_ && outlet_->publish(prefix_ + channel, message) ? sent_ : failed_);
}

}  // namespace odomcalib
