// Set-up of a CANopen node, from "nothing heard" to "configured and sending": identity before any write, then
// what the profile says, read back.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/base/canopen/sdo_sequence.hpp"
#include "drivers/base/controller.hpp"
#include "drivers/base/profile/profile.hpp"

namespace odomcalib::drivers {

class NodeSetup {
 public:
  enum class Phase { absent, identifying, configuring, starting, ready, foreign };
  /// Result of a call of advance().
  enum class Step {
    none,
    no_answer,   ///< nobody is there
    identified,  ///< the node said who it is
    configured,  ///< it has what the profile says, and is started
    running,     ///< it sends what it should: ready
  };
  /// Observations of the node besides its answers.
  struct Seen {
    bool other_master = false;               ///< somebody else is at work
    std::uint8_t state = 0;                  ///< NMT, of its last life sign
    bool positions = false, status = false;  ///< have come since it was configured
  };

  /// @param profile outlives this, as does @param out, where NMT commands go
  NodeSetup(const Profile& profile, std::vector<CanFrame>& out) : profile_(profile), out_(out) {}

  [[nodiscard]] Phase phase() const { return phase_; }
  [[nodiscard]] bool ready() const { return phase_ == Phase::ready; }
  /// Configured, or about to be started: process data are expected.
  [[nodiscard]] bool started() const { return phase_ == Phase::starting || phase_ == Phase::ready; }

  /// Takes the client's result and goes on; to be called until it is ready.
  Step advance(canopen::SdoClient& sdo, const Seen& seen, double now);
  /// The node is no longer what was configured: begins anew. What it is known to have stays known.
  /// @param pause s, until it is asked for
  void begin_again(double now, double pause);
  /// It is there: it is asked for without a pause.
  void look_now(double now) { look_after_ = now; }
  /// Everything in its RAM goes. It is to be set up again afterwards, see begin_again().
  void reset_node() { send_nmt(kNmtResetNode); }

  [[nodiscard]] const std::optional<Identity>& identity() const { return identity_; }
  /// The node watches this program: set up and read back.
  [[nodiscard]] bool watchdog_armed() const { return watchdog_armed_; }
  /// Checks of what was set up.
  [[nodiscard]] const std::vector<canopen::SdoStep>& as_set_up() const { return as_set_up_; }
  /// The node takes process data by this identifier, although the profile does not list it.
  [[nodiscard]] bool receives(std::uint32_t cob_id) const;
  std::vector<ControllerEvent> take_events() { return std::exchange(events_, {}); }

 private:
  static constexpr std::uint8_t kNmtStart = 0x01, kNmtPreOperational = 0x80, kNmtResetNode = 0x81;

  void event(const std::string& code, const std::string& text, bool stop);
  void enter(Phase phase);
  void send_nmt(std::uint8_t command);
  void look_for_node(canopen::SdoClient& sdo, bool other_master);
  void begin_identification(canopen::SdoClient& sdo);
  Step end_identification(canopen::SdoClient& sdo);
  [[nodiscard]] Identity read_identity() const;
  void begin_configuration(canopen::SdoClient& sdo);
  Step end_configuration();
  void note_safety_objects();
  void note_as_set_up();
  Step check_started(const Seen& seen);

  const Profile& profile_;
  std::vector<CanFrame>& out_;
  canopen::SdoSequence sequence_;
  double now_ = 0.0;
  Phase phase_ = Phase::absent;
  double phase_since_ = 0.0;
  std::optional<double> look_after_;  // s, when to ask for the node (again)
  std::optional<Identity> identity_;
  bool watchdog_armed_ = false;
  std::vector<canopen::SdoOutcome> unlisted_;  // receive PDOs (1400h ff.) that the profile does not list
  std::vector<canopen::SdoStep> as_set_up_;
  std::vector<ControllerEvent> events_;
};

}  // namespace odomcalib::drivers
