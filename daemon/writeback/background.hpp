// Work that may have to wait for a disk, done beside the loop: one piece after the other, in the order in
// which they were posted.
#pragma once

#include <cstdint>
#include <functional>

namespace odomcalib {

class Background {
 public:
  Background() = default;
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  virtual ~Background() = default;

  /// @param work may wait; uses nothing that the loop changes meanwhile
  /// @param done called in the loop once the work is done
  virtual void post(std::function<void()> work, std::function<void()> done) = 0;
  /// Calls `done` of what is done. The loop calls it in every turn.
  virtual void serve() {}
  /// To poll for reading: work is done. -1: there is none.
  [[nodiscard]] virtual int fd() const { return -1; }
  /// Pieces of work of which `done` was called.
  [[nodiscard]] virtual std::uint64_t taken() const { return 0; }
  /// Waits until all work is done; nobody is called any more.
  virtual void finish() {}
};

/// Does it at once: for programs that have no loop to keep turning.
class Foreground final : public Background {
 public:
  void post(std::function<void()> work, std::function<void()> done) override {
    work();
    done();
  }
};

/// One for all: it has no state.
Background& foreground();

}  // namespace odomcalib
