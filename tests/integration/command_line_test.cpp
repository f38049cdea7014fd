// The programs as a shell sees them: files, exit statuses, both outputs. Nothing here needs a daemon.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "daemon/service/control_server.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/file_bytes.hpp"
#include "tests/integration/large_pages.hpp"
#include "tests/integration/processes.hpp"
#include "tests/temporary_folder.hpp"

namespace odomcalib::test_support::command_line_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

struct Outcome {
  int status = -1;
  std::string out, err;
};

class CommandLine : public ::testing::Test {
 protected:
  void SetUp() override {
    write("drive.jsonl", recording(0.0));
    save("cal.json", calibration());
  }

  Outcome run(const std::string& program, const std::string& arguments) {
    const std::string command = "cd '" + folder_.path().string() + "' && { " + program + " " + arguments +
                                "; } >.out 2>.err </dev/null";
    const int status = system(command.c_str());
    return {WEXITSTATUS(status), read(".out"), read(".err")};
  }
  Outcome ctl(const std::string& arguments) { return run(ODOMCALIB_CTL, arguments); }

  void write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name) << content;
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    const auto bytes = read_file_bytes(folder_ / name);
    return bytes ? bytes.value() : "";
  }
  void save(const std::string& name, const Calibration& calibration) const {
    ASSERT_TRUE(write_calibration(calibration, folder_ / name).ok());
  }
  [[nodiscard]] bool exists(const std::string& name) const { return fs::exists(folder_ / name); }

  /// Two metres straight, with poses that agree.
  static std::string recording(double start) {
    std::string text = R"({"type":"robot","wheel_diameter":0.15,"track_width":0.4,"ticks_per_rev":4096})"
                       "\n";
    for (int i = 0; i <= 100; ++i) {
      const json ticks = {{"type", "ticks"}, {"t", start + 0.1 * i}, {"left", 174 * i}, {"right", 174 * i}};
      const json pose = {{"type", "pose"}, {"t", start + 0.1 * i}, {"x", 0.02 * i}, {"y", 0.0}, {"yaw", 0.0}};
      text += ticks.dump() + "\n" + pose.dump() + "\n";
    }
    return text;
  }
  static Calibration calibration() {
    Calibration calibration;
    calibration.robot = {0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};
    calibration.parameters = {{"left_wheel_diameter", {0.15, 1e-4, "m"}},
                              {"right_wheel_diameter", {0.15, 1e-4, "m"}},
                              {"track_width", {0.4, 1e-4, "m"}}};
    calibration.verdict = Verdict::accepted;
    calibration.reasons = {"fits"};
    return calibration;
  }

  TemporaryFolder folder_;
};

// An output that is the input, by whatever name: each line is a verb, %s the output's name.
struct Overwriting {
  const char* name;
  const char* arguments;
  const char* input;
};

class OutputThatIsTheInput : public CommandLine, public ::testing::WithParamInterface<Overwriting> {};

TEST_P(OutputThatIsTheInput, is_refused_by_any_name_and_the_input_stays) {
  const std::string input = GetParam().input;
  if (!exists(input)) write(input, "VERTEX_SE2 0 0 0 0\n");
  const std::string before = read(input);
  fs::create_symlink(input, folder_ / "link");
  fs::create_hard_link(folder_ / input, folder_ / "hard");
  fs::create_directory(folder_ / "sub");
  for (const std::string& name :
       {input, "./sub/../" + input, std::string("link"), std::string("hard"), (folder_ / input).string()}) {
    const auto got = ctl(GetParam().arguments + (" " + name));
    EXPECT_EQ(got.status, 2) << name << got.out << got.err;
    EXPECT_THAT(got.err, HasSubstr("names the same file")) << name;
    EXPECT_EQ(read(input), before) << name;
    EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  }
}

INSTANTIATE_TEST_SUITE_P(
    CommandLine, OutputThatIsTheInput,
    ::testing::Values(Overwriting{"solve_out", "solve drive.jsonl --out", "drive.jsonl"},
                      Overwriting{"solve_report", "solve drive.jsonl --report", "drive.jsonl"},
                      Overwriting{"solve_robot", "solve drive.jsonl --robot robot.toml --out", "robot.toml"},
                      Overwriting{"predict_recording",
                                  "predict drive.jsonl --calibration cal.json --trajectory", "drive.jsonl"},
                      Overwriting{"predict_calibration",
                                  "predict drive.jsonl --calibration cal.json --trajectory", "cal.json"},
                      Overwriting{"report", "report cal.json --html", "cal.json"},
                      Overwriting{"export", "export cal.json --out", "cal.json"},
                      Overwriting{"export_into", "export cal.json --what urdf --into", "cal.json"},
                      Overwriting{"graph_optimize", "graph optimize map.g2o --out", "map.g2o"},
                      Overwriting{"graph_picture", "graph optimize map.g2o --svg", "map.g2o"},
                      Overwriting{"graph_build", "graph build drive.jsonl --out", "drive.jsonl"}),
    [](const auto& one) { return std::string(one.param.name); });

TEST_F(CommandLine, two_outputs_of_one_name_are_refused_before_either_is_written) {
  const auto got = ctl("solve drive.jsonl --out both --report ./both");
  EXPECT_EQ(got.status, 2) << got.err;
  EXPECT_FALSE(exists("both"));
}

TEST_F(CommandLine, both_outputs_may_go_to_a_device) {
  EXPECT_THAT(ctl("graph optimize absent.g2o --out /dev/null --svg /dev/null").err, HasSubstr("absent.g2o"));
}

TEST_F(CommandLine, an_output_that_is_a_fifo_takes_the_result_and_stays_one) {
  ASSERT_EQ(mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  const auto got = ctl("export cal.json --what toml --out fifo & timeout 5 cat fifo; wait $!");
  EXPECT_THAT(got.out, HasSubstr("track_width = 0.4"));
  EXPECT_TRUE(fs::is_fifo(folder_ / "fifo"));
}

TEST_F(CommandLine, a_result_on_standard_output_stands_there_alone_and_the_summary_on_standard_error) {
  // A pipe, and a file that the shell opened.
  for (const std::string end : {" | cat", ""}) {
    const Outcome predicted = ctl("predict drive.jsonl --calibration nominal --trajectory /dev/stdout" + end);
    EXPECT_EQ(predicted.status, 0) << predicted.err;
    EXPECT_EQ(std::count(predicted.out.begin(), predicted.out.end(), '\n'), 101) << predicted.out;
    EXPECT_THAT(predicted.out, Not(HasSubstr("poses")));
    EXPECT_THAT(predicted.err, HasSubstr("101 poses, end x"));
    const Outcome solved = ctl("solve drive.jsonl --effects none --out /proc/self/fd/1" + end);
    EXPECT_FALSE(json::parse(solved.out, nullptr, false).is_discarded()) << solved.out;
    EXPECT_THAT(solved.err, HasSubstr("REFUSED"));
  }
  const Outcome as_json =
      ctl("predict drive.jsonl --calibration nominal --json --trajectory /dev/fd/1 | cat");
  EXPECT_EQ(std::count(as_json.out.begin(), as_json.out.end(), '\n'), 101);
  EXPECT_EQ(json::parse(as_json.err, nullptr, false).value("poses", 0), 101) << as_json.err;
  const Outcome usual = ctl("predict drive.jsonl --calibration nominal --trajectory out.tum");
  EXPECT_THAT(usual.out, HasSubstr("101 poses"));
}

TEST_F(CommandLine, a_result_is_added_to_the_file_that_standard_output_is_added_to) {
  for (const std::string name : {"/dev/stdout", "log"}) {
    write("log", "kept\n");
    const Outcome got = ctl("predict drive.jsonl --calibration nominal --trajectory " + name + " >> log");
    EXPECT_EQ(got.status, 0) << got.err;
    const std::string log = read("log");
    EXPECT_TRUE(log.starts_with("kept\n")) << log.substr(0, 200);
    EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 102) << log;
    EXPECT_THAT(got.err, HasSubstr("101 poses"));
  }
}

TEST_F(CommandLine, a_folder_that_is_not_there_is_told_before_the_daemon_is_asked_to_move) {
  const auto got = ctl("--socket /nonexistent/control calibrate --yes --out absent/cal.json");
  EXPECT_EQ(got.status, 1) << got.err;
  EXPECT_THAT(got.err, HasSubstr("absent/cal.json"));
}

TEST_F(CommandLine, moves_that_were_driven_before_have_no_options_of_a_drive) {
  write("moves.json", "{}");
  for (const auto& [verb, option] : {std::pair("straight", "--repeat 2"),
                                     {"straight", "--one-way"},
                                     {"spin", "--repeat 2"},
                                     {"spin", "--turns 2"},
                                     {"spin", "--direction cw"}}) {
    const std::string call = std::string("--socket /nonexistent/control ") + verb + " --of moves.json ";
    const auto got = ctl(call + option);
    const std::string name = std::string(option).substr(0, std::string(option).find(' '));
    EXPECT_EQ(got.status, 2) << verb << option << got.out;
    EXPECT_THAT(got.err, AllOf(HasSubstr("excludes"), HasSubstr(name), HasSubstr("--of"))) << verb << option;
    EXPECT_THAT(ctl(call).err, Not(HasSubstr("excludes"))) << verb;
  }
  const auto got = ctl("--socket /nonexistent/control straight --of moves.json --distance 2");
  EXPECT_EQ(got.status, 2) << got.out;
  EXPECT_THAT(got.err, HasSubstr("the moves were driven before"));
}

/// As --json of straight and spin prints it: two moves, of which a tape knows nothing yet.
std::string driven(const json& odometry, const json& wheels) {
  const json robot = {{"left_wheel_diameter", 0.15},
                      {"right_wheel_diameter", 0.15},
                      {"track_width", 0.4},
                      {"ticks_per_rev", 4096}};
  const json move = {{"move", "a move"}, {"begin", 1.0},     {"end", 2.0},      {"odometry", odometry},
                     {"lidar", nullptr}, {"error", nullptr}, {"wheels", wheels}};
  return json{{"format", "odomcalib-moves/1"}, {"moves", {move, move}}, {"robot", robot}}.dump();
}

TEST_F(CommandLine, what_cannot_have_been_measured_of_a_move_is_refused_with_the_unit_that_was_meant) {
  write("line.json", driven({1.003, 0.0, 0.0}, {13.374, 13.374}));
  write("turn.json", driven({0.0, 0.0, 6.283}, {-16.755, 16.755}));
  const std::string line = "straight --of line.json --out got.json --measured ",
                    turn = "spin --of turn.json --out got.json --measured-turn ";
  for (const auto& [call, status, said] :
       {std::tuple(line + "1020", 2, "1020 m was measured of a move of 1.003 m: in mm that is 1.02 m"),
        {line + "102", 2, "in cm that is 1.02 m"},
        {line + "40.2", 2, "in inches that is 1.02108 m"},
        {line + "1,02", 2, "what follows a decimal point"},
        {line + "1,1.9", 3, "left wheel diameter would be"},
        {line + "1.02m", 2, "state it in m, with a point, for example 1.0132"},
        {turn + "6.2832", 2, "in rad that is 360.001 degrees"},
        {turn + "1", 2, "in turns that is 360 degrees"},
        {turn + "360deg", 2, "state it in degrees, with a point, for example 361.5"}}) {
    const Outcome got = ctl(call);
    EXPECT_EQ(got.status, status) << call << got.out;
    EXPECT_THAT(got.err, HasSubstr(said)) << call;
    EXPECT_FALSE(exists("got.json")) << call;
    EXPECT_EQ(got.out, "") << call;
  }
  // Before anything moves.
  const Outcome before = ctl("--socket nobody straight --yes --measured 1020");
  EXPECT_EQ(before.status, 2) << before.err;
  for (const std::string& call : {line + "1.02", line + "1.02,1.021", turn + "368"}) {
    fs::remove(folder_ / "got.json");
    EXPECT_EQ(ctl(call).status, 0) << call;
    EXPECT_TRUE(exists("got.json")) << call;
  }
}

TEST_F(CommandLine, values_that_are_no_numbers_are_refused_by_name_where_they_are_used) {
  auto broken = calibration();
  broken.parameters.back().second.value = std::nan("");
  save("nan.json", broken);
  for (const std::string verb : {"predict drive.jsonl --calibration nan.json --trajectory out --json",
                                 "export nan.json --what toml", "export nan.json --what diff_drive"}) {
    const auto got = ctl(verb);
    EXPECT_EQ(got.status, 1) << verb << got.out;
    EXPECT_THAT(got.err, AllOf(HasSubstr("nan.json"), HasSubstr("parameters.track_width"))) << verb;
    EXPECT_THAT(got.out, Not(HasSubstr("nan,"))) << verb;
  }
  EXPECT_FALSE(exists("out"));
}

TEST_F(CommandLine, a_damaged_length_is_refused_by_name_by_all_who_read_it) {
  auto negative = calibration(), none = calibration();
  for (auto& [name, quantity] : negative.parameters)
    if (name == "left_wheel_diameter") quantity.value = -quantity.value;
  none.parameters.back().second.value = std::nan("");
  save("negative.json", negative);
  save("none.json", none);
  for (const auto& [file, member] :
       {std::pair("negative.json", "\"parameters.left_wheel_diameter\" is no length"),
        std::pair("none.json", "\"parameters.track_width\" has no finite value")}) {
    const std::string name = file;
    for (const std::string& call :
         {"predict drive.jsonl --calibration " + name + " --trajectory out", "report " + name,
          "report " + name + " --json", "report " + name + " --html page.html",
          "export " + name + " --what toml"}) {
      const auto got = ctl(call);
      EXPECT_EQ(got.status, 1) << call << got.out;
      EXPECT_THAT(got.err, AllOf(HasSubstr(name), HasSubstr(member))) << call;
      EXPECT_THAT(got.out, Not(HasSubstr("ACCEPTED"))) << call;
    }
  }
  EXPECT_FALSE(exists("page.html"));
  none.verdict = Verdict::refused;
  none.reasons = {"nothing moved"};
  save("none.json", none);
  EXPECT_EQ(ctl("report none.json").status, 0) << "a refused one may have no values, and is shown";
}

TEST_F(CommandLine, a_calibration_of_another_robot_predicts_nothing) {
  auto of_robot = calibration();
  of_robot.robot.robot_id = "r1";
  save("r1.json", of_robot);
  const std::string call = "predict drive.jsonl --calibration r1.json --trajectory out";
  const auto unnamed = ctl(call);
  EXPECT_EQ(unnamed.status, 0) << unnamed.err;
  EXPECT_THAT(unnamed.err, HasSubstr("r1.json is of robot \"r1\", but drive.jsonl names none"));
  fs::remove(folder_ / "out");
  const auto other = ctl(call + " --robot-id r2");
  EXPECT_EQ(other.status, 2) << other.err;
  EXPECT_THAT(other.err,
              AllOf(HasSubstr("r1.json"), HasSubstr("is of robot \"r1\", but \"drive.jsonl\" of \"r2\""),
                    HasSubstr("--robot-id r1")));
  EXPECT_FALSE(exists("out"));
  const auto same = ctl(call + " --robot-id r1");
  EXPECT_EQ(same.status, 0);
  EXPECT_EQ(same.err, "");
  EXPECT_THAT(ctl("predict drive.jsonl --calibration cal.json --trajectory out --robot-id r2").err,
              HasSubstr("drive.jsonl is of robot \"r2\", but cal.json names none"));
  EXPECT_EQ(ctl("predict drive.jsonl --calibration nominal --trajectory out --robot-id r2").err, "");
}

TEST_F(CommandLine, values_in_another_unit_are_refused_by_name_by_all_who_read_them) {
  auto in_mm = calibration();
  in_mm.parameters.back().second = {400.0, 0.1, "mm"};
  save("mm.json", in_mm);
  auto in_degrees = calibration();
  in_degrees.effects.push_back({"backlash", {{"left_play", {3.4, 0.1, "deg"}}}, {}, {}, "host"});
  save("deg.json", in_degrees);
  for (const auto& [file, member] : {std::pair("mm.json", "parameters.track_width.unit"),
                                     std::pair("deg.json", "effects.backlash.parameters.left_play.unit")}) {
    const std::string name = file;
    for (const std::string& call :
         {"predict drive.jsonl --calibration " + name + " --trajectory out", "report " + name,
          "export " + name + " --what diff_drive", "export " + name, "compare cal.json " + name}) {
      const auto got = ctl(call);
      EXPECT_EQ(got.status, 3) << call << got.out;
      EXPECT_THAT(got.err, AllOf(HasSubstr(name), HasSubstr(member), HasSubstr("state value and std in")))
          << call;
    }
  }
  EXPECT_FALSE(exists("out"));
}

constexpr const char* kOwnFile = "a:\n  wheel_separation: 0.41  # m\n  wheel_radius: 0.075\n";
constexpr const char* kOwnFileAfter =
    "a:\n  wheel_separation: 0.4  # m\n  wheel_radius: 0.075\n  wheel_separation_multiplier: 1.0\n"
    "  left_wheel_radius_multiplier: 1.0\n  right_wheel_radius_multiplier: 1.0\n";
constexpr const char* kInto = "export cal.json --what diff_drive --into c.yaml";

TEST_F(CommandLine, a_file_of_ones_own_is_changed_with_consent_alone) {
  write("c.yaml", kOwnFile);
  const auto nobody = ctl(kInto);
  EXPECT_EQ(nobody.status, 2) << nobody.err;
  EXPECT_THAT(nobody.out, HasSubstr("-  wheel_separation: 0.41  # m\n+  wheel_separation: 0.4  # m\n"));
  EXPECT_THAT(nobody.err, AllOf(HasSubstr("add --yes"), HasSubstr("nothing was written")));
  EXPECT_EQ(read("c.yaml"), kOwnFile);
  EXPECT_FALSE(exists("c.yaml~"));

  EXPECT_EQ(ctl(std::string(kInto) + " --yes").status, 0);
  EXPECT_EQ(read("c.yaml"), kOwnFileAfter);
  EXPECT_EQ(read("c.yaml~"), kOwnFile);

  const auto again = ctl(std::string(kInto) + " --yes");
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.err, HasSubstr("holds these values already"));
  EXPECT_EQ(read("c.yaml~"), kOwnFile) << "the old file is still the old one";
}

TEST_F(CommandLine, a_person_on_a_terminal_is_asked_before_a_file_changes) {
  write("c.yaml", kOwnFile);
  const std::string on_terminal = std::string("script -qec '") + ODOMCALIB_CTL + " " + kInto + "' /dev/null";
  const auto no = run("echo no | " + on_terminal, "");
  EXPECT_EQ(no.status, 4) << no.out;
  EXPECT_THAT(no.out, AllOf(HasSubstr("+  wheel_separation: 0.4  # m"), HasSubstr("kept as c.yaml~")));
  EXPECT_EQ(read("c.yaml"), kOwnFile);
  const auto yes = run("echo yes | " + on_terminal, "");
  EXPECT_EQ(yes.status, 0) << yes.out;
  EXPECT_EQ(read("c.yaml"), kOwnFileAfter);
}

TEST_F(CommandLine, a_refused_calibration_changes_no_file) {
  auto refused = calibration();
  refused.verdict = Verdict::refused;
  save("cal.json", refused);
  write("c.yaml", kOwnFile);
  EXPECT_EQ(ctl(std::string(kInto) + " --yes").status, 3);
  EXPECT_EQ(read("c.yaml"), kOwnFile);
}

TEST_F(CommandLine, dead_reckoning_that_leaves_the_numbers_is_refused) {
  auto huge = calibration();
  huge.parameters[0].second.value = huge.parameters[1].second.value = 1e308;
  huge.verdict = Verdict::refused;  // of others such lengths are refused before
  save("huge.json", huge);
  const auto got = ctl("predict drive.jsonl --calibration huge.json --trajectory out --json");
  EXPECT_EQ(got.status, 1) << got.out;
  EXPECT_TRUE(json::parse(got.out, nullptr, false).contains("error")) << got.out;
  EXPECT_FALSE(exists("out"));
}

TEST_F(CommandLine, a_standard_output_that_takes_nothing_is_a_failure) {
  write("graph.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  write("pairs.jsonl", "{}\n");
  for (const std::string verb : {"export cal.json", "report cal.json --json", "graph optimize graph.g2o",
                                 "match pairs.jsonl", "--version"}) {
    const auto got = ctl(verb + " >/dev/full");
    EXPECT_EQ(got.status, 1) << verb;
    EXPECT_THAT(got.err, HasSubstr("standard output")) << verb;
  }
}

TEST_F(CommandLine, effects_that_are_none_are_refused_before_anything_is_read_or_written) {
  const std::string before = read("cal.json");
  for (const std::string names : {"tme_offset", "''", "none,time_offset", "auto,auto", "backlash,backlash"}) {
    const auto got = ctl("solve absent.jsonl --out cal.json --effects " + names);
    EXPECT_EQ(got.status, 2) << names << got.err;
    EXPECT_THAT(got.err, AllOf(HasSubstr("time_offset"), HasSubstr("range_bias"))) << names;
  }
  EXPECT_EQ(read("cal.json"), before);
}

TEST_F(CommandLine, what_was_noticed_of_a_recording_is_told_before_the_error_that_it_ends_with) {
  std::string halves;
  for (int i = 0; i < 20; ++i)
    halves +=
        json{{"type", "wheels"}, {"t", 0.1 * i}, {i % 2 == 0 ? "left" : "right", 0.1 * i}}.dump() + "\n";
  write("halves.jsonl", halves);
  const auto got = ctl("solve halves.jsonl");
  EXPECT_EQ(got.status, 1);
  EXPECT_THAT(got.err, ContainsRegex(
                           "halves.jsonl: wheels: each sample has one wheel only .*\n.*lacks.*--robot FILE"));
  write("halves.jsonl", read("drive.jsonl").substr(0, read("drive.jsonl").find('\n') + 1) + halves);
  EXPECT_THAT(ctl("predict halves.jsonl --calibration nominal --trajectory p.tum").err,
              Not(HasSubstr("lacks")));
}

TEST_F(CommandLine, one_drive_given_twice_is_refused) {
  write("copy.jsonl", read("drive.jsonl"));
  write("packed.jsonl.gz", gzip(read("drive.jsonl")).value());
  for (const std::string second : {"drive.jsonl", "copy.jsonl", "packed.jsonl.gz"}) {
    const auto got = ctl("solve drive.jsonl --out out.json " + second);
    EXPECT_EQ(got.status, 2) << second << got.err;
    EXPECT_THAT(got.err, HasSubstr("same drive")) << second;
  }
  // Cut out of it, and counting from another second.
  std::istringstream whole(read("drive.jsonl"));
  std::string part;
  for (std::string text; std::getline(whole, text);) {
    json line = json::parse(text);
    if (line.at("type") == "robot") line["time_zero"] = 2.0;
    if (line.contains("t")) line["t"] = line.at("t").get<double>() - 2.0;
    if (line.value("t", 0.0) >= 0.0 && line.value("t", 0.0) < 4.05) part += line.dump() + "\n";
  }
  write("part.jsonl", part);
  for (const std::string both : {"drive.jsonl part.jsonl", "part.jsonl drive.jsonl"}) {
    const auto got = ctl("solve --out out.json " + both);
    EXPECT_EQ(got.status, 2) << both << got.err;
    EXPECT_THAT(got.err, HasSubstr("or a part of it")) << both;
  }
  write("later.jsonl", recording(1000.0));
  EXPECT_NE(ctl("solve drive.jsonl later.jsonl").status, 2);
  // The same scans or reference poses beside another record of the wheels.
  const auto drive = [](const std::string& reference, int more) {
    std::string text = recording(0.0).substr(0, recording(0.0).find('\n') + 1);
    for (int i = 0; i <= 100; ++i) {
      const json ticks = {
          {"type", "ticks"}, {"t", 0.1 * i}, {"left", 174 * i + more * (i % 2)}, {"right", i}};
      json other = {{"type", reference}, {"t", 0.1 * i}, {"x", 0.02 * i}, {"y", 0.0}, {"yaw", 0.0}};
      other.update({{"angle_min", -1}, {"angle_increment", 1}, {"ranges", {1.0 + 0.01 * i, 2, 3}}});
      text += ticks.dump() + "\n" + other.dump() + "\n";
    }
    return text;
  };
  for (const char* reference : {"pose", "scan"}) {
    write("one.jsonl", drive(reference, 0));
    write("other.jsonl", drive(reference, 1));
    EXPECT_THAT(ctl("solve one.jsonl other.jsonl").err, HasSubstr("same drive")) << reference;
  }
}

TEST_F(CommandLine, a_refused_calibration_configures_no_robot_and_leads_only_with_a_warning) {
  auto refused = calibration();
  refused.verdict = Verdict::refused;
  refused.reasons = {"nothing moved"};
  save("refused.json", refused);
  const auto toml = ctl("export refused.json --what toml");
  EXPECT_EQ(toml.status, 3) << toml.out;
  EXPECT_EQ(toml.out, "");
  for (const std::string verb :
       {"export refused.json", "predict drive.jsonl --calibration refused.json --trajectory out"}) {
    const auto got = ctl(verb);
    EXPECT_EQ(got.status, 0) << verb << got.err;
    EXPECT_THAT(got.err, AllOf(HasSubstr("warning"), HasSubstr("nothing moved"))) << verb;
  }
  refused.parameters.clear();
  save("refused.json", refused);
  const auto got = ctl("predict drive.jsonl --calibration refused.json --trajectory other");
  EXPECT_EQ(got.status, 3) << got.err;
  EXPECT_FALSE(exists("other"));
}

TEST_F(CommandLine, an_effect_that_this_program_does_not_know_is_told) {
  auto foreign = calibration();
  foreign.effects.push_back({"moon_phase", {{"pull", {0.1, 0.01, "m"}}}, {}, {}, "host"});
  save("foreign.json", foreign);
  const auto got = ctl("predict drive.jsonl --calibration foreign.json --trajectory out");
  EXPECT_EQ(got.status, 0) << got.err;
  EXPECT_THAT(got.err, AllOf(HasSubstr("warning"), HasSubstr("moon_phase")));
  EXPECT_EQ(ctl("predict drive.jsonl --calibration cal.json --trajectory out").err, "");
  const auto exported = ctl("export foreign.json --what diff_drive");
  EXPECT_THAT(exported.err, AllOf(HasSubstr("warning"), HasSubstr("moon_phase")));
  EXPECT_THAT(exported.out, HasSubstr("# not held here: moon_phase"));
}

// Escape sequences of both kinds, a title, a bell: what a terminal would obey.
constexpr const char* kSteering =
    "\x1b[2J\x1b]0;title\x07 \xC2\x9B"
    "31m red\r\x7f";

bool steers(const std::string& text) {
  const bool c1 = text.find("\xC2\x9B") != std::string::npos;
  return c1 || std::any_of(text.begin(), text.end(), [](char c) {
           return (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') || c == '\x7f';
         });
}

TEST_F(CommandLine, what_files_say_does_not_steer_the_terminal) {
  Calibration hostile = calibration();
  hostile.reasons = {kSteering};
  hostile.robot.robot_id = kSteering;
  hostile.data.emplace_back().name = kSteering;
  save("hostile.json", hostile);
  std::string text = recording(0.0);
  text.insert(text.find('}'), R"(,"robot_id":")"
                              "\\u001b[2J"
                              R"(")");
  write("hostile.jsonl", text + "{\"type\":\"\\u001b[2J\",\"t\":1}\n");
  write(std::string("name") + kSteering, "no recording");
  for (const char* arguments :
       {"report hostile.json", "--verbose report hostile.json", "export hostile.json --what toml",
        "export hostile.json --what python", "report hostile.json --json", "report name*",
        "predict hostile.jsonl --calibration nominal", "solve hostile.jsonl", "solve name*",
        "solve name* --json"}) {
    const auto got = ctl(arguments);
    EXPECT_FALSE(steers(got.out)) << arguments << got.out;
    EXPECT_FALSE(steers(got.err)) << arguments << got.err;
  }
  EXPECT_THAT(ctl("report hostile.json").out, HasSubstr("red"));
  const auto document = json::parse(ctl("report hostile.json --json").out, nullptr, false);
  EXPECT_EQ(document["reasons"], json::array({kSteering})) << "in JSON it stays what it is";
}

TEST_F(CommandLine, errors_of_usage_are_json_where_json_is_asked_for) {
  for (const std::string words :
       {"--json fly", "solve --json", "status --fly --json=short", "straight --json --distance nan"}) {
    const auto got = ctl(words);
    EXPECT_EQ(got.status, 2) << words;
    const json body = json::parse(got.out, nullptr, false);
    ASSERT_TRUE(body.is_object()) << words << got.out;
    EXPECT_EQ(body["error"]["code"], "usage");
    EXPECT_NE(body["error"]["what"], "");
  }
}

TEST_F(CommandLine, export_as_json_is_json_with_the_same_text) {
  const json body = json::parse(ctl("export cal.json --json").out, nullptr, false);
  ASSERT_TRUE(body.is_object());
  EXPECT_EQ(body["what"], "parameters");
  EXPECT_EQ(body["text"], ctl("export cal.json").out);
}

TEST_F(CommandLine, both_programs_tell_their_version) {
  const auto got = ctl("--version");
  EXPECT_EQ(got.status, 0);
  EXPECT_THAT(got.out, ContainsRegex("^[0-9]+[.][0-9]+[.][0-9]+\n$"));
  EXPECT_EQ(run(ODOMCALIB_DAEMON, "--version").out, got.out);
}

TEST_F(CommandLine, a_choice_is_made_by_name_and_the_names_are_told) {
  write("graph.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  for (const std::string wrong : {"--start bogus", "--start 1", "--method bogus"}) {
    const auto got = ctl("graph optimize graph.g2o " + wrong);
    EXPECT_EQ(got.status, 2) << wrong;
    EXPECT_THAT(got.err, Not(ContainsRegex("[a-z]->|[{][0-9]"))) << wrong;
  }
  EXPECT_THAT(ctl("graph optimize graph.g2o --start bogus").err, HasSubstr("rotations"));
  EXPECT_EQ(ctl("graph optimize graph.g2o --start tree --method gauss-newton").status, 0);
}

TEST_F(CommandLine, pairs_may_be_packed_and_a_folder_is_called_one) {
  write("pairs.jsonl", "{}\n{}\n");
  write("pairs.jsonl.gz", gzip("{}\n{}\n").value());
  EXPECT_EQ(ctl("match pairs.jsonl.gz").out, ctl("match pairs.jsonl").out);
  const auto got = ctl("match /tmp");
  EXPECT_EQ(got.status, 1);
  EXPECT_THAT(got.err, HasSubstr("folder"));
}

TEST_F(CommandLine, S2_02_matchers_have_names_and_searches_tell_their_score) {
  // A corner: two walls, seen from the same place twice.
  json scan{{"angle_min", 0.0}, {"angle_increment", 0.01}, {"range_max", 9.0}, {"ranges", json::array()}};
  for (int i = 0; i < 157; ++i)
    scan["ranges"].push_back(
        std::min(2.0 / std::max(std::cos(0.01 * i), 1e-6), 3.0 / std::max(std::sin(0.01 * i), 1e-6)));
  write("pairs.jsonl", json{{"reference", scan}, {"scan", scan}, {"guess", {0.0, 0.0, 0.0}}}.dump() + "\n");
  for (const std::string matcher : {"brute", "fast"}) {
    const auto got = json::parse(ctl("match pairs.jsonl --matcher " + matcher).out);
    EXPECT_EQ(got["status"], "ok") << got;
    EXPECT_GT(got["score"].get<double>(), 0.9) << got;
    EXPECT_TRUE(got["covariance"].is_null()) << got;
    EXPECT_NEAR(got["pose"][0].get<double>(), 0.0, 0.11) << got;
  }
  const auto lines = json::parse(ctl("match pairs.jsonl --matcher lines").out);
  EXPECT_FALSE(lines.contains("score")) << lines;
  EXPECT_EQ(ctl("match pairs.jsonl --matcher flann").status, 2);
}

TEST_F(CommandLine, S0_04_noise_of_the_wheels_tells_the_deviation_of_the_end) {
  const std::string call = "predict drive.jsonl --calibration nominal --trajectory out --json --noise ";
  const auto small = json::parse(ctl(call + "0.002,0.001,0.01").out);
  const auto large = json::parse(ctl(call + "0.004,0.002,0.02").out);
  for (const std::size_t axis : {0U, 1U, 2U}) {
    EXPECT_GT(small["std"][axis].get<double>(), 0.0) << small;
    EXPECT_NEAR(large["std"][axis].get<double>(), 2.0 * small["std"][axis].get<double>(), 1e-9) << large;
  }
  for (const std::string wrong : {"0.1", "0.1,0.1", "0.1,0.1,nan", "-1,0.1,0.1"})
    EXPECT_EQ(ctl(call + wrong).status, 2) << wrong;
}

// The wheels' motion over a left-out interval is unknown: no trajectory goes over it without a word.
TEST_F(CommandLine, predict_and_convert_say_what_they_go_on_without) {
  std::string text = recording(0.0);
  text += R"({"type":"ticks","t":10.1,"left":90000,"right":90000})"
          "\n"
          R"({"type":"ticks","t":10.2,"left":90174,"right":90174})"
          "\n"
          R"({"type":"ticks","t":10.2,"left":90200,"right":90200})"
          "\n";
  write("jump.jsonl", text);
  const std::string predict = "predict jump.jsonl --calibration nominal --trajectory out ";
  const auto told = ctl(predict);
  EXPECT_EQ(told.status, 0) << told.err;
  EXPECT_THAT(told.err, HasSubstr("1 of 102 intervals between counts (0.98 %), from 10 to 10 s"));
  EXPECT_THAT(told.err, HasSubstr("1 of 104 counts"));
  EXPECT_THAT(ctl("predict drive.jsonl --calibration nominal --trajectory out").err,
              Not(HasSubstr("intervals")));
  const auto converted = ctl("convert jump.jsonl --out copy.jsonl");
  EXPECT_THAT(converted.out, HasSubstr("not used: 1 of 102 intervals between counts"));
  for (const std::string& call :
       {predict + "--json", std::string("convert jump.jsonl --out copy.jsonl --json")}) {
    const auto document = json::parse(ctl(call).out);
    ASSERT_EQ(document["discarded"].size(), 2U) << document;
    EXPECT_EQ(document["discarded"][0]["what"], "interval");
    EXPECT_EQ(document["discarded"][0]["of"], 102);
    EXPECT_NEAR(document["discarded"][0]["begin"].get<double>(), 10.0, 1e-9);
    EXPECT_TRUE(document["repairs"].is_array());
  }
}

TEST_F(CommandLine, a_result_says_that_recordings_were_taken_for_those_of_one_robot) {
  const auto settings_after = [this](const std::string& options) {
    (void)ctl("solve drive.jsonl --effects none --out said.json" + options);
    return json::parse(read("said.json")).at("settings");
  };
  EXPECT_FALSE(settings_after("").contains("same_robot"));
  const json settings = settings_after(" --same-robot --same-lidar");
  EXPECT_EQ(settings.at("same_robot"), true);
  EXPECT_EQ(settings.at("same_lidar"), true);
}

TEST_F(CommandLine, S3_11_rounds_and_cut_of_the_closed_form_have_limits) {
  for (const std::string wrong : {"--rounds -1", "--rounds 1000", "--cut 0.9", "--cut nan"})
    EXPECT_EQ(ctl("solve drive.jsonl " + wrong).status, 2) << wrong;
  EXPECT_THAT(ctl("solve drive.jsonl --rounds 1e1").err,
              HasSubstr("\"1e1\" is not a whole number from 0 to 100"));
  EXPECT_THAT(ctl("solve drive.jsonl --cut 1,5").err, HasSubstr("\"1,5\" is not a number"));
}

// A FIFO that nobody writes holds the program up while it reads.
TEST_F(CommandLine, an_interrupted_solve_is_cancelled) {
  ASSERT_EQ(mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  for (const int number : {SIGINT, SIGTERM}) {
    Process solve({ODOMCALIB_CTL, "--json", "solve", (folder_ / "fifo").string()}, folder_ / "said");
    // Ready when it waits: signals are caught before the command line is read.
    ASSERT_FALSE(solve.wait(0.5).has_value());
    solve.signal(number);
    EXPECT_EQ(solve.wait(5.0), 4);
  }
  EXPECT_THAT(read("said"), HasSubstr("\"cancelled\""));
  EXPECT_THAT(read("said"), HasSubstr("\"format\":\"odomcalib-error/1\""));
}

TEST_F(CommandLine, solve_has_large_pages_where_the_kernel_gives_them_on_request) {
  ASSERT_EQ(mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  const Process solve({ODOMCALIB_CTL, "solve", (folder_ / "fifo").string()}, folder_ / "said");
  EXPECT_EQ(wait_until([&] { return asks_for_large_pages(solve.id()); }, 1.0),
            kernel_gives_large_pages_on_request());
  const auto process = fs::path("/proc") / std::to_string(solve.id());
  EXPECT_EQ(read_file_bytes(process / "comm").value(), "odomcalibctl\n");
}

/// Gives the lease to everybody, and its calibration to whoever wants to drive.
class CannedDaemon {
 public:
  /// @param answers to other methods than those of the lease and Calibrate, by their names
  CannedDaemon(const fs::path& socket, const Calibration& calibration, std::function<void()> while_driving,
               json answers = json::object())
      : server_(std::move(ControlServer::create(socket, "").value())),
        calibration_(json::parse(to_json(calibration))),
        answers_(std::move(answers)),
        while_driving_(std::move(while_driving)),
        thread_([this] { serve(); }) {}
  ~CannedDaemon() {
    over_ = true;
    thread_.join();
  }
  CannedDaemon(const CannedDaemon&) = delete;
  CannedDaemon& operator=(const CannedDaemon&) = delete;

 private:
  void serve() {
    while (!over_) {
      std::vector<pollfd> polled;
      server_.watch(polled);
      (void)poll(polled.data(), polled.size(), 5);
      server_.step(now_ += 0.005);
      while (const auto incoming = server_.next_call())
        server_.reply(incoming->client, control::encode_reply(answer(incoming->call).dump()));
    }
  }
  json answer(const control::Call& call) {
    const std::string method = call.name();
    if (call.parameters.value("dry_run", false)) return {{"result", json::object()}};
    if (method == "Acquire") return {{"lease", "mine"}, {"ttl_ms", 120}};
    if (answers_.contains(method)) return answers_[method];
    if (method != "Calibrate") return {{"ttl_ms", 120}};
    while_driving_();
    return {{"result", {{"recording", "/state/recordings/drive.lcmlog"}, {"calibration", calibration_}}}};
  }

  ControlServer server_;
  double now_ = 0.0;  ///< s
  json calibration_, answers_;
  std::function<void()> while_driving_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

TEST_F(CommandLine, a_result_that_cannot_be_written_after_the_drive_is_printed_and_the_copy_named) {
  fs::create_directory(folder_ / "results");
  const CannedDaemon daemon(folder_ / "control", calibration(),
                            [this] { fs::remove_all(folder_ / "results"); });
  const auto got = ctl("--socket control calibrate --yes --out results/cal.json");
  EXPECT_EQ(got.status, 1) << got.out;
  EXPECT_THAT(got.out, AllOf(HasSubstr("ACCEPTED"), HasSubstr("400.000")));
  EXPECT_THAT(got.err, AllOf(HasSubstr("/state/calibrations/drive.json"),
                             HasSubstr("/state/recordings/drive.lcmlog")));
}

TEST_F(CommandLine, a_wait_that_ends_says_what_was_missing) {
  const auto daemon = [this](const char* state) {
    return std::make_unique<CannedDaemon>(
        folder_ / "control", calibration(), [] {}, json{{"GetStatus", {{"status", {{"state", state}}}}}});
  };
  auto busy = daemon("moving: straight");
  for (const std::string timeout : {"0", "0.3"}) {
    const Outcome late = ctl("--socket control wait --until idle --timeout " + timeout);
    EXPECT_EQ(late.status, 10) << late.err;
    EXPECT_THAT(late.err,
                AllOf(HasSubstr("not idle after"), ContainsRegex("after [0-9.]+ s: odomcalibd: moving"),
                      Not(HasSubstr("does not answer"))));
  }
  busy.reset();
  const auto idle = daemon("idle");
  EXPECT_EQ(ctl("--socket control wait --until idle --timeout 0").status, 0);
}

TEST_F(CommandLine, values_that_are_tried_at_once_are_not_to_be_applied_next) {
  const json answers = json::parse(R"({
    "GetParameters": {"parameters": []},
    "Straight": {"result": {"moves": [{"lidar": [1, 0, 0], "error": {"distance": 0.001, "yaw": 0.001}}]}},
    "Spin": {"result": {"moves": [{"lidar": [0, 0, 6.28], "error": {"distance": 0, "yaw": 0.001}}]}},
    "Apply": {"result": {}},
    "Store": {"result": {}}})");
  const CannedDaemon daemon(
      folder_ / "control", calibration(), [] {}, answers);
  const Outcome got = ctl("--socket control calibrate --yes --one-drive --apply");
  EXPECT_EQ(got.status, 0) << got.err;
  EXPECT_THAT(got.out, AllOf(HasSubstr("ACCEPTED"), HasSubstr("Next: these values are tried now"),
                             HasSubstr("stored, and proven"), Not(HasSubstr("odomcalibctl apply"))));
  EXPECT_THAT(ctl("--socket control calibrate --yes --one-drive").out, HasSubstr("odomcalibctl apply"));
}

TEST_F(CommandLine, counts_are_compared_where_recordings_have_them) {
  const auto of = [](const char* digest, double counts, bool of_angles) {
    Calibration one = calibration();
    one.robot.ticks_per_rev = counts;
    one.data.resize(1);
    one.data[0].name = one.data[0].sha256 = digest;
    if (of_angles) one.data[0].choices = {"wheel motion from angles of /joint_states"};
    return one;
  };
  save("angles.json", of("1", 1 << 20, true));
  save("counts.json", of("2", 4096.0, false));
  save("others.json", of("3", 8192.0, false));
  const Outcome alike = ctl("compare angles.json counts.json");
  EXPECT_EQ(alike.status, 0) << alike.err;
  EXPECT_THAT(alike.out, Not(HasSubstr("ticks_per_rev")));
  EXPECT_THAT(ctl("compare others.json counts.json").out, HasSubstr("different ticks_per_rev"));
}

TEST_F(CommandLine, a_comparison_says_whose_files_it_took_and_that_there_was_nothing_to_compare) {
  Calibration named = calibration();
  named.robot.robot_id = "r1";
  save("named.json", named);
  EXPECT_THAT(ctl("compare named.json cal.json").out,
              HasSubstr("cal.json names no robot: taken to be of r1"));
  EXPECT_THAT(ctl("compare named.json named.json").out, Not(HasSubstr("names no robot")));
  Calibration wheels = calibration(), track = calibration();
  wheels.parameters.pop_back();
  track.parameters.erase(track.parameters.begin(), track.parameters.begin() + 2);
  save("wheels.json", wheels);
  save("track.json", track);
  const Outcome none = ctl("compare wheels.json track.json");
  EXPECT_EQ(none.status, 2) << none.out;
  EXPECT_THAT(none.err, AllOf(HasSubstr("track.json"), HasSubstr("no value in common with wheels.json")));
  const Outcome some = ctl("compare wheels.json track.json cal.json");
  EXPECT_EQ(some.status, 0) << some.err;
  EXPECT_THAT(some.out, HasSubstr("nothing in common"));
}

TEST_F(CommandLine, a_configuration_says_when_its_robot_was_driven_and_which_version_solved) {
  Calibration dated = calibration();
  dated.driven = Driven{1.7e9, 1.7e9 + 60.0};
  dated.settings.emplace().version = "0.1.7";
  save("dated.json", dated);
  EXPECT_THAT(ctl("export dated.json --what diff_drive").out,
              AllOf(HasSubstr("driven 2023-11-14, 22:13 to 22:14 UTC"), HasSubstr("by odomcalib 0.1.7"),
                    ContainsRegex("exported by odomcalib [0-9]")));
}

/// A metre and a half out and back, two turns each way.
std::string tour() {
  std::string text = R"({"type":"ticks","t":0,"left":0,"right":0})"
                     "\n";
  double t = 0.0, left = 0.0, right = 0.0, x = 0.0, yaw = 0.0;
  for (const auto& [forward, turn] : {std::pair(0.015, 0.0), {-0.015, 0.0}, {0.0, 0.06}, {0.0, -0.06}})
    for (int k = 0; k < (turn == 0.0 ? 100 : 210); ++k) {
      constexpr double kCounts_m = 4096.0 / (M_PI * 0.15);
      t += 0.1;
      left += kCounts_m * (forward - 0.2 * turn);
      right += kCounts_m * (forward + 0.2 * turn);
      x += forward;
      yaw += turn;
      const json ticks = {
          {"type", "ticks"}, {"t", t}, {"left", std::lround(left)}, {"right", std::lround(right)}};
      const json pose = {{"type", "pose"}, {"t", t}, {"x", x}, {"y", 0.0}, {"yaw", yaw}};
      text += ticks.dump() + "\n" + pose.dump() + "\n";
    }
  return text;
}

TEST_F(CommandLine, the_next_command_can_be_typed_as_it_stands) {
  write("robot.toml", "wheel_diameter = 0.15\ntrack_width = 0.4\nticks_per_rev = 4096\n");
  write("Anna's 1.jsonl", tour());
  const std::string arguments = R"('Anna'\''s 1.jsonl' --robot robot.toml)";
  const Outcome got = ctl("inspect " + arguments);
  EXPECT_EQ(got.status, 0) << got.err;
  EXPECT_THAT(got.out, HasSubstr("Next: odomcalibctl solve " + arguments + "\n"));
  write("robot.jsonl", R"({"type":"robot","wheel_diameter":0.15,"track_width":0.4,"ticks_per_rev":4096})"
                       "\n" +
                           tour());
  EXPECT_THAT(ctl("inspect robot.jsonl").out, HasSubstr("Next: odomcalibctl solve robot.jsonl\n"));
  EXPECT_THAT(ctl("report " + std::string(R"('Anna'\''s 1.jsonl')")).err,
              HasSubstr(R"(odomcalibctl solve 'Anna'\''s 1.jsonl' --out)"));
}

TEST_F(CommandLine, a_result_that_cannot_be_written_after_a_solve_is_printed) {
  const Outcome got = ctl("solve drive.jsonl --effects none --out /dev/full");
  EXPECT_EQ(got.status, 1) << got.out;
  EXPECT_THAT(got.out, HasSubstr("REFUSED"));
  EXPECT_THAT(got.err, HasSubstr("/dev/full"));
  const Outcome as_json = ctl("solve drive.jsonl --effects none --json --out /dev/full");
  EXPECT_EQ(as_json.status, 1) << as_json.err;
  EXPECT_EQ(json::parse(as_json.out, nullptr, false).value("verdict", ""), "refused") << as_json.out;
}

TEST_F(CommandLine, a_dash_is_standard_output_for_every_file_that_is_written) {
  const Outcome predicted = ctl("predict drive.jsonl --calibration nominal --trajectory -");
  EXPECT_EQ(std::count(predicted.out.begin(), predicted.out.end(), '\n'), 101) << predicted.out;
  EXPECT_THAT(predicted.err, HasSubstr("101 poses, end x"));
  const Outcome converted = ctl("convert drive.jsonl --out -");
  EXPECT_EQ(std::count(converted.out.begin(), converted.out.end(), '\n'), 203) << converted.err;
  EXPECT_THAT(ctl("export cal.json --what toml --out=-").out, HasSubstr("track_width = 0.4"));
  EXPECT_THAT(ctl("report cal.json --html -").out, HasSubstr("<html"));
  const Outcome solved = ctl("solve drive.jsonl --effects none --out -");
  EXPECT_FALSE(json::parse(solved.out, nullptr, false).is_discarded()) << solved.out;
  EXPECT_FALSE(exists("-"));
  EXPECT_EQ(ctl("export cal.json --what toml --out ./-").status, 0);
  EXPECT_TRUE(exists("-")) << "a file of this name can still be written";
}

TEST_F(CommandLine, a_parameter_has_one_value) {
  const Outcome got = ctl("--socket nobody params set --yes track_width=0.39 track_width=0.4");
  EXPECT_EQ(got.status, 2) << got.err;
  EXPECT_THAT(got.err, HasSubstr("track_width has two values"));
}

TEST_F(CommandLine, a_link_is_of_the_urdf_that_changes) {
  const Outcome got = ctl("export cal.json --what diff_drive --link laser");
  EXPECT_EQ(got.status, 2) << got.out;
  EXPECT_THAT(got.err, HasSubstr("--link"));
}

class Completion : public CommandLine {
 protected:
  /// Completions that bash offers behind these words, the last of which is being typed.
  std::string offered(const std::string& words) {
    write("complete.sh", R"(source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
_odomcalibctl; printf '%s\n' "${COMPREPLY[@]}")");
    return run("bash", "complete.sh " ODOMCALIB_COMPLETION " " ODOMCALIB_CTL " " + words).out;
  }
};

TEST_F(Completion, knows_the_verbs_and_options_that_the_program_knows) {
  EXPECT_EQ(offered("sol"), "solve\n");
  EXPECT_THAT(offered("''"),
              AllOf(HasSubstr("calibrate\n"), HasSubstr("--json\n"), HasSubstr("--version\n")));
  EXPECT_EQ(offered("solve --rep"), "--report\n");
  EXPECT_EQ(offered("graph opt"), "optimize\n");
  EXPECT_EQ(offered("graph optimize --json in.g2o --sv"), "--svg\n");
}

class OtherShells : public CommandLine, public ::testing::WithParamInterface<const char*> {
 protected:
  /// Completions that the shell offers behind these words, the last of which is being typed; zsh leaves out
  /// those that do not fit only afterwards.
  std::string offered(const std::string& words) {
    const std::string shell = GetParam();
    const fs::path program(ODOMCALIB_CTL);
    const std::string path = "PATH=" + program.parent_path().string() + ":$PATH\n";
    if (shell == "fish")
      write("complete.sh", path +
                               "exec fish --no-config -c 'source " ODOMCALIB_FISH_COMPLETION
                               "; complete -C \"odomcalibctl " +
                               words + "\"'\n");
    else
      write("complete.sh", path + "exec zsh -f -c 'source " ODOMCALIB_ZSH_COMPLETION R"(
compadd() { print -rl -- "${(@P)@[-1]}" }
_files() { print FILES }
words=(odomcalibctl )" + words +
                               R"(); CURRENT=$#words; _odomcalibctl'
)");
    return run("bash", "complete.sh").out;
  }
};

TEST_P(OtherShells, know_the_verbs_and_options_that_the_program_knows) {
  EXPECT_THAT(offered("sol"), HasSubstr("solve"));
  EXPECT_THAT(offered("wa"), HasSubstr("wait"));
  EXPECT_THAT(offered("solve --rep"), HasSubstr("--report"));
  EXPECT_THAT(offered("graph opt"), HasSubstr("optimize"));
  EXPECT_THAT(offered("graph optimize --json in.g2o --sv"), HasSubstr("--svg"));
  EXPECT_THAT(offered("graph opt"), Not(HasSubstr("calibrate")));
}

INSTANTIATE_TEST_SUITE_P(Shells, OtherShells, ::testing::Values("fish", "zsh"),
                         [](const auto& shell) { return std::string(shell.param); });

TEST_F(Completion, leaves_files_to_the_shell) { EXPECT_EQ(offered("graph optimize in"), "\n"); }

class DaemonUsage : public CommandLine {
 protected:
  Outcome daemon(const std::string& controller, const std::string& lidar) {
    write("d.toml", "[controller]\n" + controller + "\n[lidar]\n" + lidar + "\n[daemon]\nstate_dir = \"" +
                        (folder_ / "state").string() + "\"\nsocket = \"" + (folder_ / "control").string() +
                        "\"\n");
    return run(ODOMCALIB_DAEMON, "--config d.toml");
  }
  const std::string controller_ =
      "device = \"slcan:/dev/null?bitrate=500000\"\nprofile = \"" ODOMCALIB_PROFILE "\"";
  const std::string lidar_ = "device = \"serial:/dev/null?baud=230400\"";
};

TEST_F(DaemonUsage, words_that_make_no_sense_end_with_2) {
  EXPECT_EQ(run(ODOMCALIB_DAEMON, "--bogus").status, 2);
  EXPECT_EQ(run(ODOMCALIB_DAEMON, "--config").status, 2);
  EXPECT_EQ(run(ODOMCALIB_DAEMON, "--config absent.toml").status, 2);
  EXPECT_EQ(run(ODOMCALIB_DAEMON, "--help").status, 0);
}

TEST_F(DaemonUsage, a_configuration_that_cannot_work_ends_with_2_and_names_file_and_key) {
  write("empty.toml", "");
  const auto empty = run(ODOMCALIB_DAEMON, "--config empty.toml");
  EXPECT_EQ(empty.status, 2);
  EXPECT_THAT(empty.out + empty.err, AllOf(HasSubstr("empty.toml"), HasSubstr("controller.profile")));
  const auto profile = daemon("device = \"slcan:/dev/null\"\nprofile = \"/absent.toml\"", lidar_);
  EXPECT_EQ(profile.status, 2);
  EXPECT_THAT(profile.out + profile.err, AllOf(HasSubstr("d.toml"), HasSubstr("/absent.toml")));
  const auto lidar = daemon(controller_, "device = \"pigeon:/dev/null\"");
  EXPECT_EQ(lidar.status, 2);
  EXPECT_THAT(lidar.out + lidar.err, AllOf(HasSubstr("d.toml"), HasSubstr("pigeon")));
}

}  // namespace
}  // namespace odomcalib::test_support::command_line_test
