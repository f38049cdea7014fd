#include "daemon/routines/wiring.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "daemon/routines/settings.hpp"

namespace odomcalib::routines {
namespace {

/// Where a wire is wrong: at the motor, at the counter, or at both alike, as when the sides were mixed up in
/// the profile.
enum class Part { none, both, counter, motor };
constexpr std::array kParts{Part::none, Part::both, Part::counter, Part::motor};

struct Hypothesis {
  Part exchanged = Part::none;
  std::array<Part, 2> inverted{Part::none, Part::none};  // of the wheel that is really left, really right
  bool mirrored = false;                                 // lidar
  int quarters = 0;                                      // of a turn that the lidar's yaw is off
};

using Signs = std::array<double, 2>;

bool at_motor(Part part) { return part == Part::motor || part == Part::both; }
bool at_counter(Part part) { return part == Part::counter || part == Part::both; }

/// How the real wheels turn.
Signs turned(const Hypothesis& h, const Signs& commanded) {
  Signs real = commanded;
  if (at_motor(h.exchanged)) std::swap(real[0], real[1]);
  for (std::size_t i = 0; i < 2; ++i)
    if (at_motor(h.inverted[i])) real[i] = -real[i];
  return real;
}

/// Signs that the counts show then.
Signs counted(const Hypothesis& h, Signs real) {
  for (std::size_t i = 0; i < 2; ++i)
    if (at_counter(h.inverted[i])) real[i] = -real[i];
  if (at_counter(h.exchanged)) std::swap(real[0], real[1]);
  return real;
}

/// -1, 0, 1; nullopt when it is neither a motion nor rest.
std::optional<double> sign_of(double share) {
  if (std::abs(share) < settings::kStood) return 0.0;
  if (std::abs(share) < settings::kMoved) return std::nullopt;
  return share < 0.0 ? -1.0 : 1.0;
}

Signs signs_of(const std::array<double, 2>& values) {
  return {values[0] < 0.0 ? -1.0 : 1.0, values[1] < 0.0 ? -1.0 : 1.0};
}

bool counts_fit(const NudgeMove& move, const Signs& expected) {
  for (std::size_t i = 0; i < 2; ++i)
    if (sign_of(move.counted[i] / std::abs(move.commanded[i])) != expected[i]) return false;
  return true;
}

/// rad, of the lidar's own x axis against the front, from a move that went ahead or back.
double yaw_from(const Pose& seen, double ahead, bool mirrored) {
  const double front = std::atan2(ahead * seen.y, ahead * seen.x);
  return wrapped(mirrored ? front : -front);
}

/// Whether the lidar saw the motion of wheels that turned like this.
bool sight_fits(const Nudge& nudge, const NudgeMove& move, const Signs& real, const Hypothesis& h) {
  if (!move.seen) return true;
  const double rim = nudge.wheel_radius * std::abs(move.commanded[0]);
  const double ahead = 0.5 * (real[0] + real[1]);
  const double left = 0.5 * (real[1] - real[0]);
  const double turn = 2.0 * rim / nudge.track_width;
  if (sign_of(move.seen->yaw / turn) != (h.mirrored ? -left : left)) return false;
  if (ahead == 0.0) return true;  // what it moved aside by depends on where it is mounted
  if (sign_of(std::hypot(move.seen->x, move.seen->y) / rim) != 1.0) return false;
  const double yaw = nudge.lidar_yaw + 0.5 * std::numbers::pi * h.quarters;
  return std::abs(wrapped(yaw_from(*move.seen, ahead, h.mirrored) - yaw)) <= 0.25 * std::numbers::pi;
}

bool explains(const Nudge& nudge, const Hypothesis& h) {
  for (const NudgeMove* move : {&nudge.ahead, &nudge.left}) {
    const Signs real = turned(h, signs_of(move->commanded));
    if (!counts_fit(*move, counted(h, real)) || !sight_fits(nudge, *move, real, h)) return false;
  }
  return true;
}

std::vector<Hypothesis> all_hypotheses() {
  std::vector<Hypothesis> all;
  for (const Part exchanged : kParts)
    for (const Part left : kParts)
      for (const Part right : kParts)
        for (const bool mirrored : {false, true})
          for (int quarters = 0; quarters < 4; ++quarters)
            all.push_back({exchanged, {left, right}, mirrored, quarters});
  return all;
}

int faults(const Hypothesis& h) {
  return static_cast<int>(h.exchanged != Part::none) + static_cast<int>(h.inverted[0] != Part::none) +
         static_cast<int>(h.inverted[1] != Part::none) + static_cast<int>(h.mirrored) +
         static_cast<int>(h.quarters != 0);
}

WiringFault exchanged_fault(Part part) {
  if (part == Part::motor)
    return {"motors_exchanged", "the left and right motors are exchanged", "exchange the motor cables"};
  if (part == Part::counter)
    return {"counts_exchanged", "the counts of left and right are exchanged",
            "exchange the encoder cables, or profile.objects position_left and position_right"};
  return {"sides_exchanged", "left and right are exchanged",
          "exchange left and right in the profile: objects of the two sides, or nodes"};
}

WiringFault inverted_fault(const std::string& side, Part part) {
  if (part == Part::motor)
    return {side + "_motor_inverted", "the " + side + " motor turns the wrong way",
            "exchange two wires of that motor"};
  if (part == Part::counter)
    return {side + "_counts_inverted", "the " + side + " wheel counts backwards",
            "exchange A and B of that encoder"};
  return {side + "_wheel_inverted", "the " + side + " wheel turns and counts backwards",
          "change the sign of profile." + side + "_sign"};
}

std::vector<WiringFault> named(const Hypothesis& h) {
  std::vector<WiringFault> all;
  if (h.exchanged != Part::none) all.push_back(exchanged_fault(h.exchanged));
  if (h.inverted[0] != Part::none) all.push_back(inverted_fault("left", h.inverted[0]));
  if (h.inverted[1] != Part::none) all.push_back(inverted_fault("right", h.inverted[1]));
  if (h.mirrored)
    all.push_back({"lidar_mirrored", "the lidar is upside down, or turns the other way",
                   "mount it upright; check lidar.type"});
  if (h.quarters != 0)
    all.push_back({"lidar_yaw",
                   "the lidar is turned by " +
                       std::string(h.quarters == 1   ? "90"
                                   : h.quarters == 2 ? "180"
                                                     : "-90") +
                       " degrees against its configured yaw",
                   "correct the third value of lidar.pose"});
  return all;
}

std::vector<Hypothesis> fewest_faults(const Nudge& nudge) {
  std::vector<Hypothesis> best;
  for (const Hypothesis& h : all_hypotheses()) {
    if (!best.empty() && faults(h) > faults(best.front())) continue;
    if (!explains(nudge, h)) continue;
    if (!best.empty() && faults(h) < faults(best.front())) best.clear();
    best.push_back(h);
  }
  return best;
}

/// As the move that went ahead or back tells, with the wheels as the hypothesis has them.
std::optional<double> measured_yaw(const Nudge& nudge, const Hypothesis& h) {
  for (const NudgeMove* move : {&nudge.ahead, &nudge.left}) {
    const Signs real = turned(h, signs_of(move->commanded));
    if (real[0] == real[1] && move->seen) return yaw_from(*move->seen, real[0], h.mirrored);
  }
  return std::nullopt;
}

/// A wheel whose counts neither follow nor stand: no sign can be read.
std::optional<std::string> unreadable(const Nudge& nudge) {
  if (!(nudge.wheel_radius > 0.0 && nudge.track_width > 0.0))
    return "wheel diameters or track width are not known";
  for (const NudgeMove* move : {&nudge.ahead, &nudge.left})
    for (std::size_t i = 0; i < 2; ++i) {
      const auto sign = sign_of(move->counted[i] / std::abs(move->commanded[i]));
      if (!sign || *sign == 0.0)
        return std::string("the counts of the ") + (i == 0 ? "left" : "right") + " wheel hardly moved";
    }
  return std::nullopt;
}

}  // namespace

Plan nudge_plan(const Limits& limits) {
  Plan plan{.name = "check", .moves = {}, .limits = limits};
  plan.moves = {straight(settings::kNudge_m, settings::kNudgeSpeed_m_s, settings::kNudgeRest_s),
                straight(-settings::kNudge_m, settings::kNudgeSpeed_m_s, settings::kNudgeRest_s),
                spin(settings::kNudge_rad, settings::kNudgeRate_rad_s, settings::kNudgeRest_s),
                spin(-settings::kNudge_rad, settings::kNudgeRate_rad_s, settings::kNudgeRest_s)};
  for (Move& move : plan.moves) move.open_loop = true;
  return plan;
}

Wiring judge_wiring(const Nudge& nudge) {
  Wiring wiring;
  if (const auto why = unreadable(nudge)) {
    wiring.why = *why;
    return wiring;
  }
  const auto best = fewest_faults(nudge);
  const bool sighted = nudge.ahead.seen && nudge.left.seen;
  if (best.empty() || (!sighted && faults(best.front()) == 0)) {
    wiring.why = sighted ? "no combination of exchanged or inverted wires explains what was seen"
                         : "the counts are as commanded, but the lidar could not measure how it moved";
    return wiring;
  }
  wiring.lidar_yaw = measured_yaw(nudge, best.front());
  wiring.outcome = faults(best.front()) == 0 ? Wiring::Outcome::good : Wiring::Outcome::wrong;
  if (wiring.outcome == Wiring::Outcome::wrong)
    for (const Hypothesis& h : best) wiring.explanations.push_back(named(h));
  return wiring;
}

}  // namespace odomcalib::routines
