// Recordings are written by a thread of their own: an SD card that stalls for a second must not hold up the
// loop that steers. The loop hands items over through a bounded queue without a lock, so that a writer that
// was put aside by the scheduler holds nothing that the loop waits for.
#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "daemon/service/settings.hpp"
#include "proto/result.hpp"

namespace odomcalib {

struct RecordedItem {
  std::int64_t utime = 0;
  std::string channel;  ///< whole name; empty: `bytes` is a line of the candump log
  std::string bytes;
};

/// Where items go. Made by the loop, then used by the writer's thread alone; may take as long as the disk
/// does.
class RecordingSink {
 public:
  RecordingSink() = default;
  RecordingSink(const RecordingSink&) = delete;
  RecordingSink& operator=(const RecordingSink&) = delete;
  virtual ~RecordingSink() = default;
  virtual Result<void> open() = 0;
  virtual Result<void> write(const RecordedItem& item) = 0;
  virtual Result<void> finish() = 0;  ///< everything to the disk
};

class RecordingWriter {
 public:
  static constexpr std::size_t kMostItems = service::settings::kMostItems;
  static constexpr std::size_t kMostBytes = service::settings::kMostWaitingForDisk_bytes;

  explicit RecordingWriter(std::unique_ptr<RecordingSink> sink);
  ~RecordingWriter();  ///< waits until everything is written
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// Never waits. @return false when the queue is full: the item is lost
  [[nodiscard]] bool push(RecordedItem item);
  /// Nothing more will come.
  void end();
  /// After end(): all of it is on the disk, or nothing more can be done about it.
  [[nodiscard]] bool finished() const { return finished_.load(std::memory_order_acquire); }
  /// The first thing that went wrong; what came after it is not written.
  [[nodiscard]] std::optional<Error> problem() const;
  [[nodiscard]] std::size_t bytes_waiting() const { return waiting_.load(std::memory_order_relaxed); }

 private:
  void run();
  void drain();
  void note(const Result<void>& done);
  void wake();

  std::unique_ptr<RecordingSink> sink_;
  boost::lockfree::spsc_queue<RecordedItem*, boost::lockfree::capacity<kMostItems>> queue_;  // owns
  std::atomic<std::size_t> waiting_ = 0;
  std::atomic<std::uint32_t> calls_ = 0;  // changes when there is something to look at
  std::atomic<bool> ended_ = false, failed_ = false, finished_ = false;
  std::optional<Error> problem_;  // written once, before failed_
  std::thread thread_;            // last: everything it uses exists
};

}  // namespace odomcalib
