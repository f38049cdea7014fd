// Messages that the daemon publishes, with the times at which the kernel and this program saw them.
#pragma once

#include <lcm/lcm.h>

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

namespace odomcalib::bench {

struct Seen {
  std::int64_t count = 0;      ///< left count of a ticks message; 0 for a scan
  std::int64_t published = 0;  ///< ns of CLOCK_REALTIME: the kernel's stamp of the datagram, in whole us
  std::int64_t handled = 0;    ///< ns of CLOCK_REALTIME: in a subscriber's handler
};

class LcmListener {
 public:
  explicit LcmListener(const std::string& url);
  ~LcmListener();
  LcmListener(const LcmListener&) = delete;
  LcmListener& operator=(const LcmListener&) = delete;

  [[nodiscard]] bool usable() const { return lcm_ != nullptr; }
  [[nodiscard]] std::size_t ticks_seen() const { return ticks_count_; }
  /// Ends listening; then the lists may be read.
  void end();
  [[nodiscard]] const std::vector<Seen>& ticks() const { return ticks_; }
  [[nodiscard]] const std::vector<Seen>& scans() const { return scans_; }
  /// Messages that are not what their channel says, and scans without 1081 beams.
  [[nodiscard]] std::size_t wrong() const { return wrong_; }

 private:
  static void on_ticks(const lcm_recv_buf_t* buffer, const char* channel, void* self);
  static void on_scan(const lcm_recv_buf_t* buffer, const char* channel, void* self);
  void listen();

  lcm_t* lcm_;
  std::vector<Seen> ticks_, scans_;
  std::size_t wrong_ = 0;
  std::atomic<std::size_t> ticks_count_ = 0;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

}  // namespace odomcalib::bench
