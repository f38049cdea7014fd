// The calibration file, member by member: one list from which reader, writer, schema and checks are made. A
// member that is not in the list is not in the file.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "proto/calibration/calibration.hpp"
#include "proto/calibration/figures.hpp"

namespace odomcalib::fields {

/// How a value stands in the file, where its type leaves a choice.
enum class Form {
  plain,           ///< a number or null, a text, a list ...
  finite,          ///< a number, never null
  zero,            ///< a number; null is read as zero
  deviation,       ///< a number; null, in memory negative, where it was not estimated
  nullable,        ///< a text; null where it is empty
  null_by_type,    ///< null where it is not set; the schema has that as a type
  null_or_object,  ///< the same, and the schema has it as an alternative
  by_axis,         ///< three numbers as {x, y, yaw}
  answer           ///< quantities with their deviation in true metres, where the scale is known
};

/// When a member is written, and what a reader makes of a file without it.
enum class Presence {
  always,  ///< in every file
  later,   ///< in every file of today; earlier ones lack it
  usual,   ///< the same, and its initial value in memory is what they mean
  if_set   ///< only where it says something
};

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct About {
  const char* meaning = "";     ///< with the unit, where a number has one
  const char* label = nullptr;  ///< of a number that the report shows in its table of further figures
  const char* unit = "1";       ///< of that number
  Form form = Form::plain;
  Presence presence = Presence::always;
  double low = -kInfinity, high = kInfinity;  ///< what is beyond is refused
  std::span<const char* const> values = {};   ///< of a text: those that this program writes
  const char* pattern = nullptr;              ///< of such a text
  std::size_t fewest = 0;                     ///< of an array of numbers: earlier files have fewer
};

template <typename Owner, typename Member>
struct Field {
  std::string_view key;
  Member Owner::*member;
  About about;
};
template <typename Owner, typename Member>
constexpr Field<Owner, Member> field(std::string_view key, Member Owner::*member, const About& about = {}) {
  return {key, member, about};
}

/// Two numbers that stand in one list.
template <typename Owner>
struct PairField {
  std::string_view key;
  double Owner::*first;
  double Owner::*second;
  About about;
};

/// Members of the owner that stand in an object of their own.
template <typename... Fields>
struct Group {
  std::string_view key;
  std::tuple<Fields...> list;
};
template <typename... Fields>
constexpr Group<Fields...> group(std::string_view key, Fields... list) {
  return {key, {list...}};
}

/// Members of an object, in the order of the file: list().
template <typename T>
struct Members;

template <typename T>
concept IsObject = requires {
  Members<T>::list();
};

/// An object whose schema stands once, under this name: kDefinition.
template <typename T>
concept IsDefined = requires {
  Members<T>::kDefinition;
};

/// An object whose members are all alike, with names of this pattern: kPattern.
template <typename T>
concept IsPatterned = requires {
  Members<T>::kPattern;
};

/// A value that stands as a list of numbers: numbers(), from(), kCount.
template <typename T>
struct Row;

template <typename T>
concept IsRow = requires {
  Row<T>::kCount;
};

// --- Members of the first version ------------------------------------------------------------------------

template <>
struct Members<RobotDescription> {
  static constexpr auto list() {
    using R = RobotDescription;
    return std::tuple{
        field(name_of(BaseQuantity::left_wheel_diameter), &R::left_wheel_diameter, {.form = Form::zero}),
        field(name_of(BaseQuantity::right_wheel_diameter), &R::right_wheel_diameter, {.form = Form::zero}),
        field(name_of(BaseQuantity::track_width), &R::track_width, {.form = Form::zero}),
        field("ticks_per_rev", &R::ticks_per_rev, {.form = Form::zero}),
        field("lidar_pose", &R::lidar_pose, {.meaning = "m, m, rad"}),
        field("robot_id", &R::robot_id, {.form = Form::nullable, .presence = Presence::later}),
        field("controller", &R::controller, {.presence = Presence::if_set}),
        field("controller_id", &R::controller_id,
              {.meaning = "vendor/product/serial number of each drive, or its name",
               .presence = Presence::if_set})};
  }
};

template <>
struct Members<Quantity> {
  static constexpr const char* kDefinition = "quantity";
  static constexpr auto list() {
    return std::tuple{field("value", &Quantity::value),
                      field("std", &Quantity::std, {.form = Form::deviation, .low = 0.0}),
                      field("unit", &Quantity::unit)};
  }
};

template <>
struct Members<LinearCorrection> {
  static constexpr auto list() {
    using L = LinearCorrection;
    return std::tuple{field("matrix", &L::matrix), field("condition", &L::condition),
                      field("rms", &L::rms, {.meaning = "m, m, rad"})};
  }
};

/// Members of a method that gave a result; one that did not has the reason alone.
template <>
struct Members<MethodResult> {
  static constexpr auto list() {
    using M = MethodResult;
    return std::tuple{field("parameters", &M::parameters), field("rms", &M::rms, {.meaning = "m, m, rad"}),
                      field("used", &M::used), field("discarded", &M::discarded)};
  }
};

template <>
struct Members<Evidence> {
  static constexpr auto list() {
    using E = Evidence;
    return std::tuple{field("p_value", &E::p_value), field("held_out_before", &E::held_out_before),
                      field("held_out_after", &E::held_out_after)};
  }
};

template <>
struct Members<EffectResult> {
  static constexpr std::array<const char*, 2> kStores = {"controller", "host"};
  static constexpr auto list() {
    using E = EffectResult;
    return std::tuple{field("name", &E::name), field("parameters", &E::parameters),
                      field("evidence", &E::evidence), field("aliases", &E::aliases),
                      field("stored_in", &E::stored_in, {.values = kStores})};
  }
};

template <>
struct Members<Unexplained> {
  static constexpr auto list() {
    using U = Unexplained;
    return std::tuple{field("depends_on", &U::depends_on), field("p_value", &U::p_value),
                      field("share", &U::share)};
  }
};

template <>
struct Members<ResidualReport> {
  static constexpr auto list() {
    using R = ResidualReport;
    return std::tuple{field("held_out", &R::held_out), field("before", &R::before, {.form = Form::by_axis}),
                      field("after", &R::after, {.form = Form::by_axis}),
                      field("noise_floor", &R::noise_floor, {.form = Form::by_axis})};
  }
};

template <>
struct Members<DataUse> {
  static constexpr auto list() {
    using D = DataUse;
    return std::tuple{
        field("file", &D::name),
        field("sha256", &D::sha256, {.pattern = "^([0-9a-f]{64})?$"}),
        field("begin", &D::begin, {.meaning = "s"}),
        field("duration", &D::duration, {.meaning = "s", .form = Form::zero}),
        field("counts", &D::counts),
        field("discarded", &D::discarded),
        field("choices", &D::choices, {.presence = Presence::if_set}),
        field("middleware", &D::middleware,
              {.meaning = "whose messages were taken; absent: none", .presence = Presence::if_set})};
  }
};

template <>
struct Members<Discarded> {
  static constexpr auto list() {
    using D = Discarded;
    return std::tuple{field("what", &D::what),
                      field("count", &D::count, {.low = 1.0}),
                      field("of", &D::of),
                      field("begin", &D::begin, {.meaning = "s"}),
                      field("end", &D::end, {.meaning = "s"}),
                      field("reason", &D::reason)};
  }
};

template <>
struct Members<Repair> {
  static constexpr auto list() {
    return std::tuple{field("what", &Repair::what), field("chosen", &Repair::chosen),
                      field("reason", &Repair::reason)};
  }
};

// --- Members that came later -----------------------------------------------------------------------------

template <>
struct Members<Bounded> {
  static constexpr const char* kDefinition = "bounded";
  static constexpr auto list() {
    return std::tuple{field("value", &Bounded::value),
                      PairField<Bounded>{"interval", &Bounded::low, &Bounded::high, {.meaning = "95 %"}}};
  }
};

template <>
struct Members<DriveError> {
  static constexpr auto list() {
    using D = DriveError;
    return std::tuple{field("name", &D::name),
                      field("unit", &D::unit),
                      field("stretches", &D::stretches),
                      field("before", &D::before),
                      field("geometry", &D::geometry),
                      field("after", &D::after),
                      field("noise_floor", &D::noise_floor)};
  }
};

template <>
struct Row<ErrorGrowth> {
  static constexpr std::size_t kCount = 5;
  static std::array<double, kCount> numbers(const ErrorGrowth& growth);
  static ErrorGrowth from(const std::array<double, kCount>& numbers);
};

template <>
struct Row<ResidualTrace::Point> {
  static constexpr std::size_t kCount = 3;
  static std::array<double, kCount> numbers(const ResidualTrace::Point& p) {
    return {p.variable, p.before, p.after};
  }
  static ResidualTrace::Point from(const std::array<double, kCount>& n) { return {n[0], n[1], n[2]}; }
};

template <>
struct Row<ResidualTrace::Bin> {
  static constexpr std::size_t kCount = 5;
  static std::array<double, kCount> numbers(const ResidualTrace::Bin& b) {
    return {b.variable, b.before, b.before_error, b.after, b.after_error};
  }
  static ResidualTrace::Bin from(const std::array<double, kCount>& n) {
    return {n[0], n[1], n[2], n[3], n[4]};
  }
};

template <>
struct Row<ResidualSample> {
  static constexpr std::size_t kCount = 4;
  static std::array<double, kCount> numbers(const ResidualSample& s) {
    return {s.t, s.sigmas[0], s.sigmas[1], s.sigmas[2]};
  }
  static ResidualSample from(const std::array<double, kCount>& n) { return {n[0], {n[1], n[2], n[3]}}; }
};

template <>
struct Members<PathTrace> {
  static constexpr std::array<const char*, 3> kNames = {"odometry", "calibrated", "reference"};
  static constexpr auto list() {
    return std::tuple{
        field("name", &PathTrace::name, {.values = kNames}),
        field("points", &PathTrace::points,
              {.meaning = "x, y, yaw: m, m, rad; no yaw in files of earlier versions", .fewest = 2})};
  }
};

template <>
struct Members<ScanTrace> {
  static constexpr auto list() {
    return std::tuple{
        field("before", &ScanTrace::before,
              {.meaning = "x, y, yaw of the base since the begin of the stretch by odometry with the nominal "
                          "values: m, m, rad"}),
        field("after", &ScanTrace::after, {.meaning = "the same with the values of this file"}),
        field("points", &ScanTrace::points, {.meaning = "x, y in the frame of the base: m"})};
  }
};

template <>
struct Members<ResidualTrace> {
  static constexpr auto list() {
    using T = ResidualTrace;
    return std::tuple{field("effect", &T::effect),
                      field("variable", &T::variable),
                      field("variable_unit", &T::variable_unit),
                      field("residual", &T::residual),
                      field("residual_unit", &T::residual_unit),
                      field("explained", &T::explained),
                      field("points", &T::points),
                      field("bins", &T::bins)};
  }
};

template <>
struct Members<ResidualAxis> {
  static constexpr auto list() {
    using A = ResidualAxis;
    return std::tuple{
        field("name", &A::name),
        field("unit", &A::unit),
        field("mean", &A::mean),
        field("std", &A::std),
        field("normalised", &A::normalised),
        field("autocorrelation", &A::autocorrelation),
        field("runs", &A::runs),
        field("histogram", &A::histogram),
        field("reference_std", &A::reference_std,
              {.meaning = "of scans or poses, that a pair is weighed with", .presence = Presence::later}),
        field("wheels_std", &A::wheels_std,
              {.meaning = "of wheels and floor, the same", .presence = Presence::later})};
  }
};

template <>
struct Members<Picture> {
  static constexpr auto list() {
    using P = Picture;
    return std::tuple{
        field("growth", &P::growth,
              {.meaning = "m driven, number of stretches, then the RMS error of the position in m: before, "
                          "without effects, after",
               .presence = Presence::later}),
        field("paths", &P::paths),
        field("scans", &P::scans,
              {.meaning = "scans of one stretch that the values were not fitted to",
               .presence = Presence::later}),
        field("traces", &P::traces),
        field("axes", &P::axes),
        field("series", &P::series, {.meaning = "s, then x, y and yaw in standard deviations"}),
        field("left_out", &P::left_out)};
  }
};

template <>
struct Members<SmoothTermEntry> {
  static constexpr auto list() {
    using S = SmoothTermEntry;
    constexpr About kUsual{.presence = Presence::usual};
    constexpr About kUsualNumber{.form = Form::finite, .presence = Presence::usual};
    return std::tuple{field("variable", &S::variable),
                      field("carrier", &S::carrier),
                      field("low", &S::low, kUsualNumber),
                      field("high", &S::high, kUsualNumber),
                      field("period", &S::period, kUsualNumber),
                      field("mean", &S::mean, kUsualNumber),
                      field("harmonic", &S::harmonic, kUsual),
                      field("knots", &S::knots, kUsual),
                      field("degree", &S::degree, kUsual),
                      field("moment", &S::moment, kUsualNumber),
                      field("fading", &S::fading, kUsualNumber),
                      field("memory", &S::memory, kUsual),
                      field("wave", &S::wave, kUsualNumber),
                      field("constant", &S::constant, kUsual),
                      field("patches", &S::patches, kUsual),
                      field("with_motion", &S::with_motion, kUsual),
                      field("coefficients", &S::coefficients, kUsualNumber),
                      field("law_of", &S::law_of, kUsual)};
  }
};

template <>
struct Members<AxisNoise> {
  static constexpr auto list() {
    return std::tuple{field("value", &AxisNoise::value, {.form = Form::finite, .low = 0.0}),
                      field("unit", &AxisNoise::unit, {.presence = Presence::usual})};
  }
};

template <>
struct Members<ContactNoise> {
  static constexpr const char* kPattern = "^(forward|sideways|yaw)$";
  static constexpr auto list() {
    using C = ContactNoise;
    return std::tuple{field("forward", &C::forward), field("sideways", &C::sideways), field("yaw", &C::yaw)};
  }
};

template <>
struct Members<LidarCurve> {
  static constexpr auto list() {
    using L = LidarCurve;
    return std::tuple{field("variable", &L::variable),
                      field("law_of_a_name", &L::law_of_a_name),
                      field("corrected", &L::corrected),
                      field("held_out_before", &L::held_out_before),
                      field("held_out_after", &L::held_out_after),
                      field("coefficients", &L::coefficients, {.form = Form::finite})};
  }
};

template <>
struct Members<OutlierReport> {
  static constexpr auto list() {
    using O = OutlierReport;
    return std::tuple{field("outliers", &O::outliers),
                      field("pairs", &O::pairs),
                      field("depends_on", &O::depends_on),
                      field("p_value", &O::p_value),
                      field("placed", &O::placed),
                      field("confirmed", &O::confirmed),
                      field("farther", &O::farther, {.meaning = "m"}),
                      field("turned_farther", &O::turned_farther, {.meaning = "rad"})};
  }
};

template <>
struct Members<StampTimes> {
  static constexpr auto list() {
    using S = StampTimes;
    return std::tuple{field("ticks", &S::ticks, {.meaning = "s"}),
                      field("scans", &S::scans, {.meaning = "s"}),
                      field("time_increment", &S::time_increment, {.meaning = "s"}),
                      field("clocks", &S::clocks,
                            {.meaning = "s, standard deviation between recordings",
                             .form = Form::finite,
                             .presence = Presence::if_set})};
  }
};

template <>
struct Members<GyroResult> {
  static constexpr auto list() {
    using G = GyroResult;
    return std::tuple{
        field("file", &G::file),        field("used", &G::used, {.meaning = "intervals; 0: none"}),
        field("scale", &G::scale),      field("scale_std", &G::scale_std, {.form = Form::deviation}),
        field("bias", &G::bias),        field("offset", &G::offset),
        field("left_out", &G::left_out)};
  }
};

template <>
struct Members<Detectable> {
  static constexpr auto list() {
    using D = Detectable;
    return std::tuple{field("effect", &D::effect),   field("parameter", &D::parameter),
                      field("unit", &D::unit),       field("smallest", &D::smallest),
                      field("typical", &D::typical), field("motion", &D::motion)};
  }
};

template <>
struct Members<ConsideredTerm> {
  static constexpr auto list() {
    using C = ConsideredTerm;
    return std::tuple{field("candidate", &C::candidate), field("statistic", &C::statistic),
                      field("p_value", &C::p_value), field("outcome", &C::outcome)};
  }
};

template <>
struct Members<Scale> {
  static constexpr std::array<const char*, 3> kSources = {"lidar data sheet", "tape", "stated"};
  static constexpr auto list() {
    return std::tuple{field("value", &Scale::value, {.form = Form::finite}),
                      field("std", &Scale::std, {.form = Form::finite}),
                      field("source", &Scale::source, {.values = kSources})};
  }
};

template <>
struct Members<EstimateAlone> {
  static constexpr auto list() {
    return std::tuple{field("value", &EstimateAlone::value, {.form = Form::finite}),
                      field("std", &EstimateAlone::std, {.form = Form::finite})};
  }
};

template <>
struct Members<ClockAlone> {
  static constexpr auto list() {
    return std::tuple{field("offset", &ClockAlone::offset, {.form = Form::finite}),
                      field("std", &ClockAlone::std, {.form = Form::finite})};
  }
};

template <>
struct Members<RecordingAlone> {
  static constexpr auto list() {
    using R = RecordingAlone;
    return std::tuple{field("file", &R::file), field("robot_id", &R::robot_id),
                      field("parameters", &R::parameters), field("clock", &R::clock),
                      field("deviation", &R::deviation, {.form = Form::finite})};
  }
};

template <>
struct Members<FarthestParameter> {
  static constexpr auto list() {
    using F = FarthestParameter;
    return std::tuple{field("recording", &F::recording), field("parameter", &F::parameter),
                      field("sigmas", &F::sigmas)};
  }
};

template <>
struct Members<HomogeneityTest> {
  static constexpr auto list() {
    return std::tuple{field("p_value", &HomogeneityTest::p_value), field("worst", &HomogeneityTest::worst)};
  }
};

template <>
struct Members<SolveSettings> {
  static constexpr auto list() {
    using S = SolveSettings;
    constexpr About kIfSet{.presence = Presence::if_set};
    return std::tuple{field("version", &S::version),
                      field("effects", &S::effects, kIfSet),
                      field("scale", &S::scale, kIfSet),
                      field("sensor", &S::sensor, kIfSet),
                      field("rounds", &S::rounds,
                            {.meaning = "of the closed form, where they are not the usual ones",
                             .presence = Presence::if_set}),
                      field("cut", &S::cut,
                            {.meaning = "share that each cuts, the same",
                             .form = Form::finite,
                             .presence = Presence::if_set}),
                      field("same_robot", &S::same_robot, kIfSet),
                      field("same_lidar", &S::same_lidar, kIfSet),
                      field("place", &S::place, kIfSet),
                      field("note", &S::note, kIfSet)};
  }
};

template <>
struct Members<DriveErrors> {
  static constexpr const char* kDefinition = "driven_errors";
  static constexpr auto list() {
    using D = DriveErrors;
    return std::tuple{
        field("straight_metre_length", &D::straight_metre_length, {.meaning = "m", .form = Form::finite}),
        field("straight_metre_heading", &D::straight_metre_heading, {.meaning = "rad", .form = Form::finite}),
        field("full_turn_heading", &D::full_turn_heading, {.meaning = "rad", .form = Form::finite})};
  }
};

template <>
struct Members<ErrorEntry> {
  static constexpr auto list() {
    using E = ErrorEntry;
    return std::tuple{field("code", &E::code), field("what", &E::what), field("where", &E::where),
                      field("remedy", &E::remedy)};
  }
};

template <>
struct Members<ProofEntry> {
  static constexpr std::array<const char*, 4> kOutcomes = {"stored", "not_stored", "taken_back", "in_doubt"};
  static constexpr auto list() {
    using P = ProofEntry;
    return std::tuple{field("outcome", &P::outcome, {.values = kOutcomes}), field("before", &P::before),
                      field("after", &P::after), field("error", &P::error)};
  }
};

template <>
struct Members<ProposedValue> {
  static constexpr auto list() {
    using P = ProposedValue;
    return std::tuple{field("value", &P::value, {.form = Form::finite}),
                      field("std", &P::std, {.form = Form::deviation}), field("unit", &P::unit),
                      field("in_force", &P::in_force, {.form = Form::finite})};
  }
};

template <>
struct Members<MoveError> {
  static constexpr auto list() {
    using M = MoveError;
    return std::tuple{field("value", &M::value, {.form = Form::finite}),
                      field("std", &M::std, {.form = Form::deviation}),
                      field("spread", &M::spread, {.meaning = "of one repetition", .form = Form::deviation})};
  }
};

template <>
struct Members<ProposalEntry> {
  static constexpr std::array<const char*, 3> kMethods = {"straight", "spin", "square"};
  static constexpr std::array<const char*, 2> kMeasures = {"lidar", "tape"};
  static constexpr auto list() {
    using P = ProposalEntry;
    return std::tuple{
        field("method", &P::method, {.values = kMethods}),
        field("measured_by", &P::measured_by, {.values = kMeasures}),
        field("used", &P::used),
        field("left_out", &P::left_out),
        field("settled", &P::settled, {.meaning = "more repetitions would not make it better"}),
        field("parameters", &P::parameters),
        field("errors", &P::errors, {.meaning = "E_s, E_d, E_b as far as the motion shows them"}),
        field("remarks", &P::remarks)};
  }
};

// --- The file --------------------------------------------------------------------------------------------

/// Members that every file has: what is wrong in them makes it a damaged one.
constexpr auto contract() {
  using C = Calibration;
  return std::tuple{
      field("verdict", &C::verdict),
      field("reasons", &C::reasons),
      field("next_step", &C::next_step, {.form = Form::nullable, .presence = Presence::later}),
      field("robot", &C::robot, {.meaning = "nominal values used; m"}),
      field("driven", &C::driven,
            {.meaning = "first and last sample; null where the clock of no recording tells the date",
             .form = Form::null_by_type,
             .presence = Presence::later}),
      field("parameters", &C::parameters, {.form = Form::answer}),
      group("covariance", field("order", &C::covariance_order, {.meaning = "names"}),
            field("matrix", &C::covariance, {.meaning = "SI units"})),
      field("linear_correction", &C::linear_correction),
      field("methods", &C::methods),
      field("effects", &C::effects),
      field("unexplained", &C::unexplained),
      field("residual", &C::residual),
      field("data", &C::data),
      field("discarded", &C::discarded,
            {.meaning =
                 "what was left out before and in the fit; begin and end on the recording's clock, of 0: "
                 "not known",
             .presence = Presence::later}),
      field("repairs", &C::repairs,
            {.meaning = "what was put right, or chosen where there were several",
             .presence = Presence::later})};
}

/// Members that say something in some files only, or came later. One that is not understood is as good as
/// absent, and kept: a newer program's finding must not stop odometry.
constexpr auto additions() {
  using C = Calibration;
  constexpr About kIfSet{.presence = Presence::if_set};
  return std::tuple{
      field("drive_errors", &C::drive_errors, kIfSet),
      field("picture", &C::picture, kIfSet),
      field("curves", &C::curves, kIfSet),
      field(
          "contact_noise", &C::contact_noise,
          {.meaning = "standard deviation that a metre rolled adds by chance", .presence = Presence::if_set}),
      field("lidar_curves", &C::lidar_curves, kIfSet),
      field("outliers", &C::outliers, kIfSet),
      field("stamps", &C::stamps, kIfSet),
      field("gyros", &C::gyros, kIfSet),
      field("detectable", &C::detectable, kIfSet),
      field("considered", &C::considered, kIfSet),
      field("odometer", &C::odometer,
            {.meaning = "m, what the robot's own counter of distance said",
             .form = Form::finite,
             .presence = Presence::if_set}),
      field("scale", &C::scale, kIfSet),
      field("recordings", &C::recordings, {.presence = Presence::later}),
      field("homogeneity", &C::homogeneity, {.form = Form::null_or_object, .presence = Presence::later}),
      field("settings", &C::settings, kIfSet),
      field("proof", &C::proof,
            {.meaning =
                 "of calibrate --apply: errors of odometry on fresh motion, with the old and the new values",
             .presence = Presence::if_set}),
      field("proposal", &C::proposal, kIfSet)};
}

/// Numbers of a list that have a label and are set, in its order.
template <typename List, typename T>
std::vector<LabelledFigure> labelled(const List& list, const T& owner) {
  std::vector<LabelledFigure> figures;
  const auto add = [&](const auto& field) {
    const auto& value = owner.*field.member;
    if constexpr (std::is_same_v<decltype(value), const std::optional<double>&>)
      if (value && field.about.label != nullptr)
        figures.push_back({field.about.label, *value, field.about.unit});
  };
  std::apply([&](const auto&... field) { (add(field), ...); }, list);
  return figures;
}

}  // namespace odomcalib::fields
