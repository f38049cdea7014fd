// SDO client of CiA 301: one transfer at a time with one node, expedited and segmented, no clock and no port.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/base/canopen/object.hpp"
#include "drivers/base/canopen/settings.hpp"
#include "drivers/can/transport.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers::canopen {

struct SdoRequest {
  ObjectAddress object;
  bool write = false;
  std::vector<std::uint8_t> data;  ///< write: 1..kSdoMostBytes bytes
  double timeout_s = kSdoTimeout_s;
  int retries = 2;  ///< after a time-out; aborts are answers and are not retried
};

struct SdoResult {
  ObjectAddress object;
  bool write = false;
  std::vector<std::uint8_t> data;      ///< read: what the node holds
  std::optional<std::uint32_t> abort;  ///< the node's abort code
  std::optional<Error> error;          ///< device (abort, protocol) or timeout; empty: done
};

class SdoClient {
 public:
  explicit SdoClient(std::uint8_t node) : node_(node) {}

  [[nodiscard]] bool busy() const { return busy_; }
  /// Begins a transfer. Ignored (false) while another is in progress or when the data is empty or too long.
  bool start(SdoRequest request, double now);
  /// Gives up without a word to the node, e.g. because it was reset.
  void cancel();
  /// Any frame; other nodes' and other services' frames are not touched. True when it was an answer of our
  /// node.
  bool on_frame(const CanFrame& frame, double now);
  void on_time(double now);

  std::vector<CanFrame> take_frames();
  std::optional<SdoResult> take_result();
  /// sdo_transfers, sdo_aborts, sdo_timeouts, sdo_unexpected (answers that came late or twice, or to another
  /// client on the bus), sdo_bad
  [[nodiscard]] Counters counters() const;

 private:
  using Payload = std::array<std::uint8_t, 8>;
  void send(const Payload& payload, double now);
  void begin(double now);
  void begin_write(Payload& payload) const;
  void send_next_segment(double now);
  void on_read_start(const CanFrame& frame, double now);
  void on_read_segment(const CanFrame& frame, double now);
  void on_write_answer(double now);
  void on_abort(std::uint32_t code);
  [[nodiscard]] bool addressed_to_request(const CanFrame& frame) const;
  [[nodiscard]] bool answers_request(std::uint8_t command) const;
  void finish();
  void fail(ErrorCode code, const std::string& what, const std::string& remedy = "");
  void refuse(std::uint32_t code, const std::string& what, double now);

  std::uint8_t node_;
  bool busy_ = false;
  bool segmented_ = false;
  bool toggle_ = false;
  SdoRequest request_;
  std::vector<std::uint8_t> received_;
  std::optional<std::uint32_t> announced_;
  std::size_t sent_bytes_ = 0;
  std::size_t segment_bytes_ = 0;
  double deadline_ = 0.0;
  int tries_left_ = 0;
  std::vector<CanFrame> out_;
  std::optional<SdoResult> result_;
  std::uint64_t transfers_ = 0, aborts_ = 0, timeouts_ = 0, unexpected_ = 0, bad_ = 0;
};

}  // namespace odomcalib::drivers::canopen
