// Two CANopen drives with one axis each (docs/user/profiles.md, style "pair"): the left and the right wheel.
// Each is a DualAxis with one axis; together they are one controller.
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/base/cia402/dual_axis.hpp"
#include "drivers/base/motion/settings.hpp"
#include "drivers/base/motion/wheel_counts.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib::drivers {
namespace {

class AxisPair final : public Controller {
 public:
  /// @param profile with two sides
  explicit AxisPair(const Profile& profile);

  void on_frame(const CanFrame& frame) override;
  void on_time(double now) override;
  std::vector<CanFrame> take_frames() override;
  std::vector<TickSample> take_ticks() override { return std::exchange(ticks_, {}); }
  std::vector<ControllerEvent> take_events() override { return std::exchange(events_, {}); }

  /// State of the drive that is further from moving.
  [[nodiscard]] ControllerState state() const override;
  void enable(double now) override;
  void disable(double now) override;
  Result<void> command(double left_rad_s, double right_rad_s, double now) override;
  void quick_stop(double now) override;
  [[nodiscard]] double watchdog_time() const override;
  [[nodiscard]] bool at_rest() const override { return drives_[0].at_rest() && drives_[1].at_rest(); }

  Result<void> start_read_parameters(double now) override;
  Result<void> start_write_parameters(const std::vector<ParameterValue>& values, double now) override;
  Result<void> start_store(double now) override;
  std::optional<ParameterJobResult> take_job_result() override;
  [[nodiscard]] std::optional<double> touched() const override {
    return std::max(drives_[0].touched(), drives_[1].touched());
  }

  [[nodiscard]] std::optional<Identity> identity() const override;
  [[nodiscard]] std::vector<Identity> devices() const override;
  [[nodiscard]] RobotDescription description() const override { return robot_; }
  [[nodiscard]] std::vector<Capability> capabilities() const override;
  [[nodiscard]] Counters counters() const override;

 private:
  /// A job goes to one drive after the other; when the second fails, what the first one wrote is taken back.
  struct Job {
    explicit Job(ParameterJobResult::Kind what) : kind(what) {}
    ParameterJobResult::Kind kind;
    std::array<std::vector<ParameterValue>, 2> values;
    std::size_t side = 0;
    std::vector<StoredParameter> before, done;
    enum class Step { before, main, undo } step = Step::main;
    std::optional<Error> error;
  };

  void collect();
  void collect_events(std::size_t side);
  void collect_ticks(std::size_t side);
  void stop_the_other(std::size_t side);
  void send_sync();
  void advance_job();
  void start_side();
  void side_done(ParameterJobResult result);
  void finish_job(std::optional<Error> error);
  Result<void> begin(Job job);

  RobotDescription robot_;
  double sync_period_s_;
  std::uint8_t host_node_;
  std::array<DualAxis, 2> drives_;
  TickPairing pairing_;
  std::array<std::int32_t, 2> segments_{};
  double now_ = 0.0, sync_due_ = 0.0;
  std::optional<Job> job_;
  std::optional<ParameterJobResult> job_result_;
  std::vector<CanFrame> out_;
  std::vector<TickSample> ticks_;
  std::vector<ControllerEvent> events_;
};

constexpr std::array kSides = {"left", "right"};

/// Smaller is further from moving.
int readiness(ControllerState state) {
  switch (state) {
    case ControllerState::absent:
      return 0;
    case ControllerState::configuring:
      return 1;
    case ControllerState::fault:
      return 2;
    case ControllerState::disabled:
      return 3;
    case ControllerState::enabling:
      return 4;
    case ControllerState::enabled:
      return 5;
  }
  return 0;
}

}  // namespace

AxisPair::AxisPair(const Profile& profile)
    : robot_(profile.robot),
      sync_period_s_(profile.sync_period_s),
      host_node_(profile.sides[0].host_node),
      drives_{DualAxis(profile.sides[0]), DualAxis(profile.sides[1])} {}

void AxisPair::on_frame(const CanFrame& frame) {
  now_ = std::max(now_, frame.t);
  for (DualAxis& drive : drives_) drive.on_frame(frame);
  collect();
}

void AxisPair::on_time(double now) {
  now_ = std::max(now_, now);
  send_sync();
  for (DualAxis& drive : drives_) drive.on_time(now_);
  collect();
  advance_job();
}

/// Both drives sample on the same SYNC: their counts belong to one instant.
void AxisPair::send_sync() {
  const bool wanted = drives_[0].wants_sync() || drives_[1].wants_sync();
  if (sync_period_s_ <= 0.0 || !wanted || now_ < sync_due_) return;
  // A late call does not shift the beat, a long pause does.
  const bool in_time = now_ - sync_due_ < sync_period_s_;
  sync_due_ = (in_time ? sync_due_ : now_) + sync_period_s_;
  CanFrame frame;
  frame.id = 0x080;
  out_.push_back(frame);
  for (DualAxis& drive : drives_) drive.on_sync(now_);
}

void AxisPair::collect() {
  for (std::size_t side = 0; side < drives_.size(); ++side) {
    collect_events(side);
    collect_ticks(side);
  }
}

void AxisPair::collect_events(std::size_t side) {
  for (ControllerEvent& event : drives_[side].take_events()) {
    if (event.stop) stop_the_other(side);
    event.text = std::string(kSides[side]) + " drive: " + event.text;
    if (events_.size() < motion::kMostQueued) events_.push_back(std::move(event));
  }
}

void AxisPair::stop_the_other(std::size_t side) {
  DualAxis& other = drives_[1 - side];
  if (other.state() == ControllerState::enabled || other.state() == ControllerState::enabling)
    other.quick_stop(now_);
}

void AxisPair::collect_ticks(std::size_t side) {
  for (const TickSample& sample : drives_[side].take_ticks()) {
    if (sample.segment != segments_[side]) pairing_.forget();
    segments_[side] = sample.segment;
    const auto pair = pairing_.add(side == 0 ? Side::left : Side::right, sample.t, sample.left);
    if (pair && ticks_.size() < motion::kMostQueued)
      ticks_.push_back({pair->t, pair->left, pair->right, segments_[0] + segments_[1]});
  }
}

/// Both drives watch the same program: one of the two heartbeats is enough.
std::vector<CanFrame> AxisPair::take_frames() {
  std::vector<CanFrame> out = std::exchange(out_, {});
  bool alive = false;
  for (DualAxis& drive : drives_)
    for (const CanFrame& frame : drive.take_frames()) {
      const bool heartbeat = frame.id == 0x700u + host_node_;
      if (!heartbeat || !alive) out.push_back(frame);
      alive = alive || heartbeat;
    }
  return out;
}

ControllerState AxisPair::state() const {
  const ControllerState left = drives_[0].state(), right = drives_[1].state();
  const bool one_is_on =
      left != right && (left == ControllerState::enabled || right == ControllerState::enabled);
  const ControllerState worse = readiness(left) < readiness(right) ? left : right;
  // One drive that has torque already, or still: not disabled.
  return worse == ControllerState::disabled && one_is_on ? ControllerState::enabling : worse;
}

void AxisPair::enable(double now) {
  now_ = std::max(now_, now);
  const auto ready = [](const DualAxis& drive) {
    return drive.state() == ControllerState::disabled || drive.state() == ControllerState::fault;
  };
  if (job_ || !ready(drives_[0]) || !ready(drives_[1])) {
    events_.push_back(
        {now_, "enable_refused", "both drives must be configured and no parameter job running", false});
    return;
  }
  for (DualAxis& drive : drives_) drive.enable(now_);
  collect();
}

void AxisPair::disable(double now) {
  for (DualAxis& drive : drives_) drive.disable(now);
}

void AxisPair::quick_stop(double now) {
  for (DualAxis& drive : drives_) drive.quick_stop(now);
}

Result<void> AxisPair::command(double left_rad_s, double right_rad_s, double now) {
  const std::array speeds{left_rad_s, right_rad_s};
  for (std::size_t side = 0; side < drives_.size(); ++side) {
    auto given = drives_[side].command(speeds[side], 0.0, now);
    if (given) continue;
    drives_[0].quick_stop(now);
    drives_[1].quick_stop(now);
    return given;
  }
  return {};
}

double AxisPair::watchdog_time() const {
  const bool both = drives_[0].watchdog_armed() && drives_[1].watchdog_armed();
  return both ? std::max(drives_[0].watchdog_time(), drives_[1].watchdog_time()) : 0.0;
}

Result<void> AxisPair::begin(Job job) {
  if (job_)
    return Error{ErrorCode::refused, "another parameter job is in progress",
                 "controller " + robot_.controller, "wait for it"};
  // A drive in fault may be read: it is, before a person starts it again.
  const auto allowed = [&](ControllerState state) {
    return state == ControllerState::disabled ||
           (job.kind == ParameterJobResult::Kind::read && state == ControllerState::fault);
  };
  for (const DualAxis& drive : drives_)
    if (!allowed(drive.state()))
      return Error{ErrorCode::refused, "both drives must be configured and disabled",
                   "controller " + robot_.controller, "stop and disable first"};
  job_ = std::move(job);
  job_result_.reset();
  start_side();
  return {};
}

Result<void> AxisPair::start_read_parameters(double now) {
  now_ = std::max(now_, now);
  return begin(Job(ParameterJobResult::Kind::read));
}

Result<void> AxisPair::start_write_parameters(const std::vector<ParameterValue>& values, double now) {
  now_ = std::max(now_, now);
  Job job(ParameterJobResult::Kind::write);
  job.step = Job::Step::before;
  for (const ParameterValue& value : values) {
    const bool left = is_name_of(value.quantity, BaseQuantity::left_wheel_diameter);
    if (!left && !is_name_of(value.quantity, BaseQuantity::right_wheel_diameter))
      return Error{ErrorCode::refused, "does not store \"" + value.quantity + "\"",
                   "controller " + robot_.controller, "keep it on the host"};
    job.values[left ? 0 : 1].push_back(value);
  }
  return begin(std::move(job));
}

Result<void> AxisPair::start_store(double now) {
  now_ = std::max(now_, now);
  return begin(Job(ParameterJobResult::Kind::store));
}

/// Starts the present step at the present side, or at the next one that has something to do.
void AxisPair::start_side() {
  Result<void> started;
  DualAxis& drive = drives_[job_->side];
  if (job_->step == Job::Step::before || job_->kind == ParameterJobResult::Kind::read) {
    started = drive.start_read_parameters(now_);
  } else if (job_->kind == ParameterJobResult::Kind::store) {
    started = drive.start_store(now_);
  } else {
    const auto& values = job_->values[job_->side];
    if (values.empty()) return side_done({});
    started = drive.start_write_parameters(values, now_);
  }
  if (!started) side_done({job_->kind, started.error(), {}});
}

void AxisPair::advance_job() {
  if (!job_) return;
  if (auto result = drives_[job_->side].take_job_result()) side_done(std::move(*result));
}

void AxisPair::side_done(ParameterJobResult result) {
  Job& job = *job_;
  auto& found = job.step == Job::Step::before ? job.before : job.done;
  found.insert(found.end(), result.parameters.begin(), result.parameters.end());
  if (job.step == Job::Step::undo) {
    if (result.error) job.error->code = ErrorCode::write_unknown;
    return finish_job(job.error);
  }
  const bool undo = result.error && job.kind == ParameterJobResult::Kind::write &&
                    job.step == Job::Step::main && job.side == 1 && !job.values[0].empty();
  if (undo) {
    job.error = result.error;
    job.step = Job::Step::undo;
    job.side = 0;
    for (ParameterValue& value : job.values[0])
      for (const StoredParameter& old : job.before)
        if (old.quantity == value.quantity) value.value = old.value;
    job.done.clear();
    return start_side();
  }
  if (result.error) return finish_job(result.error);
  if (job.side == 0) {
    job.side = 1;
    return start_side();
  }
  if (job.step != Job::Step::before) return finish_job(std::nullopt);
  job.step = Job::Step::main;
  job.side = 0;
  start_side();
}

void AxisPair::finish_job(std::optional<Error> error) {
  job_result_ = ParameterJobResult{job_->kind, std::move(error), std::move(job_->done)};
  job_.reset();
}

std::optional<ParameterJobResult> AxisPair::take_job_result() { return std::exchange(job_result_, {}); }

/// The left drive and both names identify the pair; which two they are is said by devices().
std::optional<Identity> AxisPair::identity() const {
  const auto left = drives_[0].identity(), right = drives_[1].identity();
  if (!left || !right) return std::nullopt;
  Identity both = *left;
  both.name = left->name + " (serial " + std::to_string(left->serial) + ") and " + right->name + " (serial " +
              std::to_string(right->serial) + ")";
  return both;
}

std::vector<Identity> AxisPair::devices() const {
  const auto left = drives_[0].identity(), right = drives_[1].identity();
  if (!left || !right) return {};
  return {*left, *right};
}

std::vector<Capability> AxisPair::capabilities() const {
  std::vector<Capability> all = drives_[0].capabilities();
  for (Capability& one : all)
    for (const Capability& right : drives_[1].capabilities())
      if (right.quantity == one.quantity && right.readable) one = right;
  return all;
}

Counters AxisPair::counters() const {
  Counters all;
  for (std::size_t side = 0; side < drives_.size(); ++side)
    for (const auto& [name, value] : drives_[side].counters())
      all[std::string(kSides[side]) + "_" + name] = value;
  all["unpaired_counts"] = pairing_.unpaired();
  return all;
}

std::unique_ptr<Controller> make_axis_pair(const Profile& profile) {
  return std::make_unique<AxisPair>(profile);
}

}  // namespace odomcalib::drivers
