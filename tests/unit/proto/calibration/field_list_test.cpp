// The list of the calibration file's members against the structs, the reader and the writer.
#include "proto/calibration/field_list.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "tests/value_of.hpp"

namespace odomcalib::field_list_test {
namespace {

/// Gives every member of the list a value that no other has, and that it does not have by itself.
class Filling {
 public:
  void fill(double& value) { value = next_ += 0.25; }
  void fill(bool& value) { value = !value; }
  void fill(int& value) { value = static_cast<int>(next_ += 1.0); }
  void fill(std::size_t& value) { value = static_cast<std::size_t>(next_ += 1.0); }
  void fill(std::string& value) { value = "text " + std::to_string(next_ += 1.0); }
  void fill(Verdict& value) { value = Verdict::accepted_with_warnings; }
  void fill(Middleware& value) { value = Middleware::ros1; }
  void fill(Driven& value) { value = {1.5e9, 1.5e9 + 12.0}; }
  template <typename T>
  void fill(std::optional<T>& value) {
    fill(value.emplace());
  }
  template <typename T, std::size_t kSize>
  void fill(std::array<T, kSize>& values) {
    for (T& value : values) fill(value);
  }
  template <typename T>
  void fill(std::vector<T>& values) {
    values.resize(2);
    for (T& value : values) fill(value);
  }
  template <typename T>
  void fill(std::vector<std::pair<std::string, T>>& values) {
    values.resize(2);
    for (auto& [name, value] : values) {
      fill(name);
      fill(value);
    }
  }
  void fill(std::vector<MethodResult>& methods) {
    methods.resize(2);
    for (MethodResult& method : methods) fill(method.name);
    fill(methods[0]);
    fill(methods[1].refused.emplace());
  }
  template <fields::IsRow T>
  void fill(T& row) {
    std::array<double, fields::Row<T>::kCount> numbers{};
    for (double& value : numbers) value = std::ceil(next_ += 1.0);
    row = fields::Row<T>::from(numbers);
  }
  template <fields::IsObject T>
  void fill(T& value) {
    fill_list(fields::Members<T>::list(), value);
  }
  template <typename List, typename T>
  void fill_list(const List& list, T& value) {
    std::apply([&](const auto&... field) { (fill_field(field, value), ...); }, list);
  }

 private:
  template <typename T, typename Member>
  void fill_field(const fields::Field<T, Member>& field, T& value) {
    fill(value.*field.member);
  }
  template <typename T>
  void fill_field(const fields::PairField<T>& field, T& value) {
    fill(value.*field.first);
    fill(value.*field.second);
  }
  template <typename T, typename... Fields>
  void fill_field(const fields::Group<Fields...>& group, T& value) {
    fill_list(group.list, value);
  }

  double next_ = 1000.0;  // all names sort as they were given
};

Calibration full() {
  Calibration calibration;
  Filling filling;
  filling.fill_list(fields::contract(), calibration);
  filling.fill_list(fields::additions(), calibration);
  calibration.covariance = {{1.0, 0.5}, {0.5, 2.0}};  // as many as there are names
  return calibration;
}

/// Compares the members of the list; names those that differ.
class Comparing {
 public:
  template <typename T>
  void compare(const T& a, const T& b, const std::string& path) {
    if constexpr (fields::IsRow<T>)
      note(fields::Row<T>::numbers(a) == fields::Row<T>::numbers(b), path);
    else if constexpr (fields::IsObject<T>)
      compare_list(fields::Members<T>::list(), a, b, path);
    else
      note(a == b, path);
  }
  void compare(const Driven& a, const Driven& b, const std::string& path) {
    note(a.begin == b.begin && a.end == b.end, path);
  }
  template <typename T>
  void compare(const std::optional<T>& a, const std::optional<T>& b, const std::string& path) {
    note(a.has_value() == b.has_value(), path);
    if (a && b) compare(*a, *b, path);
  }
  template <typename T>
  void compare(const std::vector<T>& a, const std::vector<T>& b, const std::string& path) {
    note(a.size() == b.size(), path);
    for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
      compare(a[k], b[k], path + "[" + std::to_string(k) + "]");
  }
  template <typename T>
  void compare(const std::pair<std::string, T>& a, const std::pair<std::string, T>& b,
               const std::string& path) {
    note(a.first == b.first, path);
    compare(a.second, b.second, path + "." + a.first);
  }
  template <typename List, typename T>
  void compare_list(const List& list, const T& a, const T& b, const std::string& path) {
    std::apply([&](const auto&... field) { (compare_field(field, a, b, path), ...); }, list);
  }
  [[nodiscard]] const std::vector<std::string>& differing() const { return differing_; }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  template <typename T, typename Member>
  void compare_field(const fields::Field<T, Member>& field, const T& a, const T& b, const std::string& path) {
    compare(a.*field.member, b.*field.member, path + "." + std::string(field.key));
  }
  template <typename T>
  void compare_field(const fields::PairField<T>& field, const T& a, const T& b, const std::string& path) {
    note(a.*field.first == b.*field.first && a.*field.second == b.*field.second,
         path + "." + std::string(field.key));
  }
  template <typename T, typename... Fields>
  void compare_field(const fields::Group<Fields...>& group, const T& a, const T& b, const std::string& path) {
    compare_list(group.list, a, b, path + "." + std::string(group.key));
  }
  void note(bool same, const std::string& path) {
    ++count_;
    if (!same) differing_.push_back(path);
  }

  std::vector<std::string> differing_;
  std::size_t count_ = 0;
};

std::vector<std::string> differing(const Calibration& a, const Calibration& b) {
  Comparing comparing;
  comparing.compare_list(fields::contract(), a, b, "");
  comparing.compare_list(fields::additions(), a, b, "");
  EXPECT_GT(comparing.count(), 150U) << "it sees hardly anything";
  return comparing.differing();
}

TEST(FieldList, every_member_is_written_and_read) {
  const Calibration written = full();
  const std::string text = to_json(written);
  EXPECT_EQ(text.find("null"), std::string::npos) << "a member was not filled:\n" << text;
  const Calibration read = value_of(calibration_from_json(text, "test"));
  EXPECT_EQ(differing(written, read), std::vector<std::string>{});
  EXPECT_EQ(to_json(read), text);
  EXPECT_TRUE(read.unknown.empty()) << read.unknown.begin()->second.begin()->first;
}

/// Bytes of a struct that members of the list, and others that are named, stand on.
template <typename T>
class Coverage {
 public:
  template <typename List>
  void add_list(const List& list) {
    std::apply([&](const auto&... field) { (add_field(field), ...); }, list);
  }
  template <typename Member>
  void add(Member T::*member) {
    const auto at =
        reinterpret_cast<std::uintptr_t>(&(example_.*member)) - reinterpret_cast<std::uintptr_t>(&example_);
    for (std::size_t k = 0; k < sizeof(Member); ++k) covered_.at(at + k) = true;
  }
  /// The longest piece that nothing stands on: what is shorter than a word is between two members.
  [[nodiscard]] std::size_t longest_gap() const {
    std::size_t longest = 0, now = 0;
    for (const bool one : covered_) longest = std::max(longest, now = one ? 0 : now + 1);
    return longest;
  }

 private:
  template <typename Member>
  void add_field(const fields::Field<T, Member>& field) {
    add(field.member);
  }
  void add_field(const fields::PairField<T>& field) {
    add(field.first);
    add(field.second);
  }
  template <typename... Fields>
  void add_field(const fields::Group<Fields...>& group) {
    add_list(group.list);
  }

  T example_{};
  std::array<bool, sizeof(T)> covered_{};
};

template <typename T, typename... Besides>
void expect_whole(const char* name, Besides... besides) {
  Coverage<T> coverage;
  coverage.add_list(fields::Members<T>::list());
  (coverage.add(besides), ...);
  EXPECT_LT(coverage.longest_gap(), sizeof(void*)) << name << " has a member that is not in the list";
}

TEST(FieldList, has_every_member_of_every_struct) {
#define WHOLE(T, ...) expect_whole<T>(#T __VA_OPT__(, ) __VA_ARGS__)
  WHOLE(RobotDescription);
  WHOLE(Quantity);
  WHOLE(LinearCorrection);
  WHOLE(MethodResult, &MethodResult::name, &MethodResult::refused);
  WHOLE(Evidence);
  WHOLE(EffectResult);
  WHOLE(Unexplained);
  WHOLE(ResidualReport);
  WHOLE(DataUse);
  WHOLE(Discarded, &Discarded::copies);  // which is of those who read, not of the file
  WHOLE(Repair);
  WHOLE(Bounded);
  WHOLE(DriveError);
  WHOLE(PathTrace);
  WHOLE(ScanTrace);
  WHOLE(ResidualTrace);
  WHOLE(ResidualAxis);
  WHOLE(Picture);
  WHOLE(SmoothTermEntry);
  WHOLE(AxisNoise);
  WHOLE(ContactNoise);
  WHOLE(LidarCurve);
  WHOLE(OutlierReport);
  WHOLE(StampTimes);
  WHOLE(GyroResult);
  WHOLE(Detectable);
  WHOLE(ConsideredTerm);
  WHOLE(Scale);
  WHOLE(EstimateAlone);
  WHOLE(ClockAlone);
  WHOLE(RecordingAlone);
  WHOLE(FarthestParameter);
  WHOLE(HomogeneityTest);
  WHOLE(SolveSettings);
  WHOLE(DriveErrors);
  WHOLE(ErrorEntry);
  WHOLE(ProofEntry);
  WHOLE(ProposedValue);
  WHOLE(MoveError);
  WHOLE(ProposalEntry);
#undef WHOLE
  Coverage<Calibration> coverage;
  coverage.add_list(fields::contract());
  coverage.add_list(fields::additions());
  coverage.add(&Calibration::unknown);
  EXPECT_LT(coverage.longest_gap(), sizeof(void*)) << "Calibration has a member that is not in the list";
}

std::string with(const char* pointer, const nlohmann::json& value) {
  auto json = nlohmann::json::parse(to_json(full()));
  json[nlohmann::json::json_pointer(pointer)] = value;
  return json.dump();
}

TEST(FieldList, members_that_every_file_has_are_refused_beyond_their_limits) {
  EXPECT_TRUE(calibration_from_json(with("/discarded/0/count", 1), "cal.json").ok());
  const auto none = calibration_from_json(with("/discarded/0/count", 0), "cal.json");
  ASSERT_FALSE(none.ok());
  EXPECT_NE(none.error().text().find("\"discarded[0].count\" is not at least 1"), std::string::npos)
      << none.error().text();
  EXPECT_TRUE(calibration_from_json(with("/discarded/0/of", 0), "cal.json").ok());
  EXPECT_FALSE(calibration_from_json(with("/discarded/0/of", -1), "cal.json").ok()) << "a count";
}

TEST(FieldList, additions_beyond_their_limits_are_not_understood_and_kept) {
  for (const char* axis : {"forward", "sideways", "yaw"}) {
    const std::string pointer = std::string("/contact_noise/") + axis + "/value";
    EXPECT_TRUE(value_of(calibration_from_json(with(pointer.c_str(), 0.0), "test")).contact_noise);
    for (const nlohmann::json& wrong : {nlohmann::json(-1e-9), nlohmann::json("1"), nlohmann::json()}) {
      const auto read = value_of(calibration_from_json(with(pointer.c_str(), wrong), "test"));
      EXPECT_FALSE(read.contact_noise) << wrong;
      EXPECT_EQ(nlohmann::json::parse(to_json(read))[nlohmann::json::json_pointer(pointer)], wrong);
    }
  }
}

TEST(FieldList, an_addition_without_a_member_is_not_understood_and_kept) {
  for (const auto& [name, member] : std::vector<std::pair<std::string, std::string>>{
           {"scale", "source"}, {"stamps", "ticks"}, {"picture", "paths"}, {"settings", "version"}}) {
    auto json = nlohmann::json::parse(to_json(full()));
    json[name].erase(member);
    const auto read = value_of(calibration_from_json(json.dump(), "test"));
    EXPECT_EQ(read.unknown.at("").count(name), 1U) << name;
    EXPECT_EQ(nlohmann::json::parse(to_json(read))[name], json[name]);
  }
}

TEST(FieldList, additions_of_earlier_versions_are_understood) {
  auto json = nlohmann::json::parse(to_json(full()));
  for (auto& axis : json["picture"]["axes"]) axis.erase("wheels_std");
  json["picture"].erase("growth");
  for (auto& curve : json["curves"])
    for (const char* later : {"knots", "patches", "law_of", "wave"}) curve.erase(later);
  for (auto& point : json["picture"]["paths"][0]["points"]) point.erase(2);
  json["stamps"].erase("clocks");
  const auto read = value_of(calibration_from_json(json.dump(), "test"));
  ASSERT_TRUE(read.picture);
  EXPECT_TRUE(read.picture->growth.empty());
  EXPECT_TRUE(std::isnan(read.picture->axes.at(0).wheels_std));
  EXPECT_TRUE(std::isnan(read.picture->paths.at(0).points.at(0)[2]));
  ASSERT_EQ(read.curves.size(), 2U);
  EXPECT_EQ(read.curves[0].knots, SmoothTermEntry{}.knots);
  EXPECT_FALSE(read.stamps->clocks);
  EXPECT_TRUE(read.unknown.empty());
}

// A newer program adds members anywhere; this one must not lose them when it writes the file again.
TEST(FieldList, members_of_a_newer_program_are_kept_wherever_they_stand) {
  const std::string first = full().parameters[0].first, method = full().methods[0].name;
  const std::vector<std::string> objects = {"",
                                            "/robot",
                                            "/driven",
                                            "/parameters/" + first,
                                            "/covariance",
                                            "/linear_correction",
                                            "/methods/" + method,
                                            "/effects/1",
                                            "/effects/1/evidence",
                                            "/unexplained",
                                            "/residual",
                                            "/residual/before",
                                            "/data/0",
                                            "/discarded/1",
                                            "/repairs/0",
                                            "/drive_errors/0",
                                            "/drive_errors/0/after",
                                            "/picture",
                                            "/picture/axes/1",
                                            "/picture/traces/0",
                                            "/curves/0",
                                            "/contact_noise/yaw",
                                            "/gyros/1",
                                            "/homogeneity/worst",
                                            "/recordings/0/clock",
                                            "/settings",
                                            "/proposal"};
  auto json = nlohmann::json::parse(to_json(full()));
  for (const std::string& object : objects)
    json[nlohmann::json::json_pointer(object)]["of_a_newer_one"] = {{"deep", {1, nullptr, object}}};
  const auto read = value_of(calibration_from_json(json.dump(), "test"));
  EXPECT_EQ(differing(full(), read), std::vector<std::string>{});
  EXPECT_EQ(nlohmann::json::parse(to_json(read)), json);
  EXPECT_EQ(to_json(value_of(calibration_from_json(to_json(read), "test"))), to_json(read));
}

struct Example {
  std::optional<double> labelled, plain, unset;
  double number = 3.0;
};

// A number that has a label in the list needs no line of code to be in the report.
TEST(FieldList, numbers_with_a_label_are_shown) {
  const auto list =
      std::tuple{fields::field("a", &Example::labelled, {.label = "creep of the wheels", .unit = "m"}),
                 fields::field("b", &Example::plain), fields::field("c", &Example::unset, {.label = "unset"}),
                 fields::field("d", &Example::number, {.label = "not optional"})};
  const auto figures = fields::labelled(list, Example{1.5, 2.0, std::nullopt});
  ASSERT_EQ(figures.size(), 1U);
  EXPECT_EQ(figures[0].label, "creep of the wheels");
  EXPECT_EQ(figures[0].value, 1.5);
  EXPECT_EQ(figures[0].unit, "m");
  EXPECT_TRUE(labelled_figures(Calibration{}).empty());
}

TEST(FieldList, keys_stand_once) {
  const auto expect_once = [](const auto& list) {
    std::set<std::string> keys;
    std::size_t count = 0;
    std::apply([&](const auto&... field) { (keys.insert(std::string(field.key)), ...); }, list);
    count = std::tuple_size_v<std::decay_t<decltype(list)>>;
    EXPECT_EQ(keys.size(), count);
  };
  expect_once(std::tuple_cat(fields::contract(), fields::additions()));
  expect_once(fields::Members<SmoothTermEntry>::list());
  expect_once(fields::Members<ResidualAxis>::list());
}

}  // namespace
}  // namespace odomcalib::field_list_test
