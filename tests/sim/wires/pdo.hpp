// Process data objects of the slave: communication and mapping parameters in the dictionary, and the frames
// they make.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "tests/sim/wires/frame.hpp"
#include "tests/sim/wires/object_dictionary.hpp"

namespace odomcalib::sim {

/// Default content of one PDO.
struct PdoDefaults {
  std::uint32_t cob_id = 0x80000000U;
  std::uint16_t event_timer_ms = 0;
  std::vector<std::uint32_t> mapping;
};

/// Base class: the parameters, which the master may change in the order that CiA 301 demands.
class Pdo {
 public:
  static constexpr unsigned kEntries = 4;

  /// @param configurable tells whether the node's state allows a change now (not in operational)
  Pdo(ObjectDictionary& dictionary, std::uint16_t communication, std::uint16_t mapping,
      const PdoDefaults& defaults, std::function<bool()> configurable);

  Pdo(const Pdo&) = delete;  // the dictionary refers to it
  Pdo& operator=(const Pdo&) = delete;

  [[nodiscard]] bool valid() const;
  [[nodiscard]] std::uint32_t id() const;

 protected:
  [[nodiscard]] std::uint32_t parameter(std::uint8_t sub) const;
  [[nodiscard]] std::vector<std::uint32_t> mapping() const;
  [[nodiscard]] std::uint32_t mapped_count() const;
  ObjectDictionary& dictionary_;

 private:
  void add_communication(const PdoDefaults& defaults);
  void add_mapping(const PdoDefaults& defaults);
  [[nodiscard]] AbortCode check_cob_id(std::uint32_t value) const;
  [[nodiscard]] AbortCode check_type(std::uint32_t value) const;
  [[nodiscard]] AbortCode check_count(std::uint32_t count) const;
  [[nodiscard]] AbortCode check_entry(std::uint32_t entry) const;

  std::uint16_t communication_, mapping_;
  std::function<bool()> configurable_;
};

/// Sent on a timer, on change, or on every n-th SYNC.
class TransmitPdo : public Pdo {
 public:
  using Pdo::Pdo;
  /// Frame that is due now, if any. @param now s
  std::optional<Frame> poll(double now, bool frozen);
  std::optional<Frame> on_sync(bool frozen);
  /// On entering operational: sent once at the next poll, timers start.
  void start(double now);

 private:
  [[nodiscard]] Frame compose() const;
  Frame send(double now, bool frozen);

  double last_sent_ = 0.0;
  bool first_ = true;
  unsigned syncs_ = 0;
  Frame last_;
};

/// Written into the dictionary when it arrives, or at the next SYNC.
class ReceivePdo : public Pdo {
 public:
  using Pdo::Pdo;
  /// Returns false when the frame is too short for the mapping: it is discarded then.
  bool on_frame(const Frame& frame, double now);
  void on_sync();
  void start();
  /// True when the event timer is set and no frame came within it after the first one.
  [[nodiscard]] bool timed_out(double now) const;

 private:
  void apply(const Frame& frame);

  std::optional<Frame> waiting_;
  std::optional<double> last_received_;
};

}  // namespace odomcalib::sim
