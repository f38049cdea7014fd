// Calibrations by the hundred, each of another robot in virtual time, as `calibrate --apply` makes them:
// measured, driven, solved, written, measured again. What was good is stored and makes the odometry better;
// what was bad is not stored, and the reason says what it was.
#include <cstdlib>
#include <numeric>
#include <random>
#include <vector>

#include "daemon/cli/proven_apply.hpp"
#include "tests/integration/whole_loop.hpp"
#include "tests/sim/world/disturbance.hpp"

namespace odomcalib::campaign_test {
namespace {

using Raw = std::array<std::uint32_t, 3>;

// Differences that a comparison of two scans at rest cannot resolve.
constexpr double kDistanceNoise = 0.002;          // m
constexpr double kTurnNoise = 0.1 / 57.29577951;  // rad
constexpr double kShareBetter = 0.99;

unsigned from_environment(const char* name, unsigned usual) {
  const char* const given = std::getenv(name);
  return given != nullptr ? static_cast<unsigned>(std::strtoul(given, nullptr, 10)) : usual;
}

/// ODOMCALIB_CAMPAIGN of them from the first on; ODOMCALIB_TEST_SEED alone, to see one again.
std::vector<unsigned> seeds() {
  if (const unsigned one = from_environment("ODOMCALIB_TEST_SEED", 0); one != 0) return {one};
  std::vector<unsigned> all(from_environment("ODOMCALIB_CAMPAIGN", 3));
  std::iota(all.begin(), all.end(), 1U);
  return all;
}

class Campaign : public WholeLoop {
 protected:
  void SetUp() override {}
  void TearDown() override {}
  void adjust(sim::SimRobotOptions& options) override {
    options.truth = sim::draw_truth(options.nominal, seed_);
    options.seed = seed_;
  }
  void begin(unsigned seed) {
    seed_ = seed;
    renewing_ = false;
    lease_.clear();
    WholeLoop::SetUp();
    acquire();
  }
  void end() {
    held_.reset();
    client_.reset();
    WholeLoop::TearDown();
  }
  Raw stored() { return robot_->node().geometry_stored(); }
  cli::RunMethod method() {
    return [this](const std::string& name,
                  const nlohmann::ordered_json& parameters) -> Result<nlohmann::ordered_json> {
      // Values to be proven last as long as the connection that wrote them.
      if (name == "Apply") held_ = std::make_unique<TestClient>(folder_ / "control");
      auto wanted = json::parse(parameters.dump());
      if (name == "Apply") wanted["of_this_robot"] = true;
      const auto reply = name == "Apply" ? ask(*held_, name, wanted) : ask(name, wanted);
      if (!reply.error.empty()) return control::error_of(reply);
      return nlohmann::ordered_json::parse(reply.parameters)
          .value("result", nlohmann::ordered_json::object());
    };
  }
  cli::ProvenApply not_begun(const Error& why) {
    cli::ProvenApply applied;
    applied.error = why;
    return applied;
  }
  /// calibrate --quick --one-drive --apply
  cli::ProvenApply calibrate_and_apply() {
    const auto run = method();
    const auto before = cli::drive_errors(run);
    if (!before) return not_begun(before.error());
    const auto solved = run("Calibrate", {{"options", {{"quick", true}}}});
    if (!solved) return not_begun(solved.error());
    const auto calibration = calibration_from_json(solved.value()["calibration"].dump(), "campaign");
    if (!calibration) return not_begun(calibration.error());
    return cli::apply_and_prove(run, run, calibration.value(), before.value());
  }

  std::uint64_t seed_ = 1;
  std::unique_ptr<TestClient> held_;
};

struct Errors {
  double straight = 0.0, spin = 0.0;
};

class GoodCampaign : public Campaign {
 protected:
  Errors measured() { return {straight_error(), spin_error()}; }
  /// Stored, and neither number is worse than before by more than the comparison can tell.
  bool better_and_stored() {
    const Errors before = measured();
    const Raw old = stored();
    const auto applied = calibrate_and_apply();
    if (applied.error) return told(*applied.error);
    power_cycle();
    const Errors after = measured();
    std::printf("seed %3u: straight %5.1f -> %4.1f mm, spin %6.2f -> %5.2f deg\n",
                static_cast<unsigned>(seed_), 1e3 * before.straight, 1e3 * after.straight,
                57.29578 * before.spin, 57.29578 * after.spin);
    return stored() != old && after.straight <= std::max(before.straight, kDistanceNoise) &&
           after.spin <= std::max(before.spin, kTurnNoise);
  }
  [[nodiscard]] bool told(const Error& why) const {
    std::printf("seed %3u: %s\n", static_cast<unsigned>(seed_), why.text().c_str());
    return false;
  }
};

TEST_F(GoodCampaign, of_good_data_is_stored_and_better_in_99_of_100) {
  unsigned good = 0, count = 0;
  for (const unsigned seed : seeds()) {
    begin(seed);
    if (HasFatalFailure()) return;
    good += better_and_stored() ? 1 : 0;
    ++count;
    end();
  }
  std::printf("%u of %u stored and better\n", good, count);
  EXPECT_GE(good, kShareBetter * count);
}

/// A wheel that loses grip for a third of a second, a fifth of the time.
class LosesGrip final : public sim::Disturbance {
 public:
  explicit LosesGrip(std::uint64_t seed) : random_(seed) {}
  [[nodiscard]] std::string name() const override { return "loses_grip"; }
  void on_step(const sim::StepView& view, sim::StepMotion& motion) override {
    if (view.t >= next_) {
      next_ = view.t + 0.33;
      slips_ = std::uniform_real_distribution(0.0, 1.0)(random_) < 0.2;
    }
    if (slips_) motion.travel[sim::kLeft] *= 0.5;
  }

 private:
  std::mt19937_64 random_;
  double next_ = 0.0;
  bool slips_ = false;
};

struct Bad {
  const char* name;
  std::vector<std::string> said;  ///< one of them is in the reason
  void (*world)(sim::SimRobotOptions& options, std::uint64_t seed) = [](auto&, auto) {};
  void (*robot)(sim::SimRobot& robot) = [](auto&) {};
  void (*config)(Config& config) = [](auto&) {};
  json (*file)(std::uint64_t seed) = nullptr;  ///< a calibration from elsewhere instead of a motion
};

std::ostream& operator<<(std::ostream& out, const Bad& bad) { return out << bad.name; }

json file_of(double unit, const std::string& robot, std::uint64_t seed) {
  const sim::Geometry truth = sim::draw_truth(sim::SimRobotOptions{}.nominal, seed);
  json parameters = json::object();
  const std::array values{truth.left_diameter, truth.right_diameter, truth.track_width};
  for (std::size_t i = 0; i < values.size(); ++i)
    parameters[kNames.at(i)] = {{"value", unit * values.at(i)}, {"std", unit * 1e-5}, {"unit", "m"}};
  json made{{"format", "odomcalib-calibration/1"}, {"verdict", "accepted"}, {"parameters", parameters}};
  if (!robot.empty()) made["robot"] = {{"robot_id", robot}};
  return made;
}

class BadCampaign : public Campaign, public testing::WithParamInterface<Bad> {
 protected:
  using Campaign::adjust;
  void adjust(sim::SimRobotOptions& options) override {
    Campaign::adjust(options);
    GetParam().world(options, seed_);
  }
  void adjust(Config& config) override { GetParam().config(config); }

  /// Why nothing was stored; empty: it was.
  std::string refusal() {
    if (GetParam().file != nullptr) {
      const auto reply = ask("Apply", {{"calibration", GetParam().file(seed_)}, {"of_this_robot", true}});
      return reply.error.empty() ? "" : reply.error + " " + reply.parameters;
    }
    GetParam().robot(*robot_);
    const auto applied = calibrate_and_apply();
    return applied.error ? applied.error->text() : "";
  }
};

TEST_P(BadCampaign, is_not_stored_and_told_why) {
  for (const unsigned seed : seeds()) {
    SCOPED_TRACE(testing::Message() << GetParam().name << ", seed " << seed);
    begin(seed);
    if (HasFatalFailure()) return;
    const Raw old = stored();
    const std::string why = refusal();
    EXPECT_EQ(stored(), old) << why;
    const auto& said = GetParam().said;
    const bool right = std::any_of(said.begin(), said.end(), [&](const std::string& text) {
      return why.find(text) != std::string::npos;
    });
    EXPECT_TRUE(right) << why;
    std::printf("%s, seed %u: %u stores, %s\n", GetParam().name, seed, robot_->node().store_count(),
                why.c_str());
    end();
  }
}

/// Both ends are out of the lidar's sight.
void in_a_corridor(sim::SimRobotOptions& options, std::uint64_t /*seed*/) {
  options.room = sim::box_room(60.0, 4.0, 30.0, 2.0);
}

const Bad kBad[] = {
    {.name = "corridor", .said = {"corridor"}, .world = in_a_corridor},
    {.name = "slipping",
     .said = {"odometry and lidar differ", "odometry says", "the robot moved otherwise than its wheels",
              "contradict what the others say of the wheels"},
     .world = [](sim::SimRobotOptions& options,
                 std::uint64_t seed) { options.disturbances.push_back(std::make_shared<LosesGrip>(seed)); }},
    {.name = "swapped_wires",
     .said = {"odometry and lidar differ"},
     .robot = [](sim::SimRobot& robot) { robot.node().faults.swap_sides = true; }},
    {.name = "inches_in_the_configuration",
     .said = {"the configuration says"},
     .config =
         [](Config& config) {
           config.robot.left_wheel_diameter = config.robot.right_wheel_diameter = 0.150 / 0.0254;
         }},
    {.name = "millimetres_in_the_file",
     .said = {"more than 10 m"},
     .file = [](std::uint64_t seed) { return file_of(1e3, "", seed); }},
    {.name = "file_of_another_robot",
     .said = {"robot-B"},
     .config = [](Config& config) { config.robot.robot_id = "robot-A"; },
     .file = [](std::uint64_t seed) { return file_of(1.0, "robot-B", seed); }},
};

INSTANTIATE_TEST_SUITE_P(Kinds, BadCampaign, testing::ValuesIn(kBad),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace odomcalib::campaign_test
