// Messages that the daemon publishes on LCM, as they arrive.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace odomcalib::cli {

class LcmFeed {
 public:
  /// @param channel without prefix
  using Take = std::function<void(std::string_view channel, std::string_view bytes)>;

  /// Null when the URL cannot be opened.
  static std::unique_ptr<LcmFeed> open(const std::string& url, const std::string& prefix, Take take);
  virtual ~LcmFeed() = default;
  LcmFeed(const LcmFeed&) = delete;
  LcmFeed& operator=(const LcmFeed&) = delete;
  /// Waits for messages for so long, and hands over those that came. Returns early when a signal comes.
  virtual void serve(int timeout_ms) = 0;

 protected:
  LcmFeed() = default;
};

}  // namespace odomcalib::cli
