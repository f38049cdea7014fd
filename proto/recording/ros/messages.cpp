#include "proto/recording/ros/messages.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "proto/wire/byte_reader.hpp"

namespace odomcalib::ros {
namespace {

constexpr std::size_t kMostJoints = 4096;
constexpr std::size_t kMostTransforms = 4096;
constexpr std::int64_t kSecond = 1'000'000'000;
// Error of a quaternion's norm of 1: some publishers write single precision, or a few decimals; zero is none.
constexpr double kQuaternionTolerance = 0.1;

struct Row {
  Kind kind;
  const char* type;
  std::string_view md5;  // rosmsg md5
};

constexpr std::array<Row, 7> kKinds{{
    {Kind::scan, "sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369"},
    {Kind::joints, "sensor_msgs/JointState", "3066dcd76a6cfaef579bd0f34173e9fd"},
    {Kind::imu, "sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2"},
    {Kind::odometry, "nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7"},
    {Kind::pose, "geometry_msgs/PoseStamped", "d3812c3cbc69362b77dc0b19b345f8f5"},
    {Kind::transforms, "tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec"},
    {Kind::description, "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1"},
}};

/// Numbers of one message, whatever its encoding.
class MessageReader {
 public:
  MessageReader(std::string_view bytes, Encoding encoding) : reader_(bytes), encoding_(encoding) {
    if (encoding == Encoding::cdr) read_representation();
    size_ = reader_.left();
  }

  [[nodiscard]] bool ok() const { return reader_.ok(); }

  template <typename Number>
  Number number() {
    align(sizeof(Number));
    return reader_.number<Number>(order_);
  }
  template <typename Number, std::size_t Count>
  std::array<Number, Count> numbers() {
    std::array<Number, Count> out{};
    for (Number& value : out) value = number<Number>();
    return out;
  }
  template <typename Number>
  std::vector<Number> sequence() {
    const std::size_t count = number<std::uint32_t>();
    if (count > reader_.left() / sizeof(Number)) reader_.fail();
    std::vector<Number> out(ok() ? count : 0);
    for (Number& value : out) value = number<Number>();
    return out;
  }
  std::string text() {
    std::string_view out = reader_.take(number<std::uint32_t>());
    if (encoding_ == Encoding::cdr) out = out.substr(0, out.find('\0'));
    return std::string(out);
  }
  /// Length of a sequence whose elements are read one by one.
  std::size_t count(std::size_t most) {
    const std::size_t count = number<std::uint32_t>();
    if (count > most) reader_.fail();
    return ok() ? count : 0;
  }
  std::vector<std::string> texts() {
    const std::size_t names = count(kMostJoints);
    std::vector<std::string> out;
    for (std::size_t i = 0; i < names && ok(); ++i) out.push_back(text());
    return out;
  }
  Header header() {
    Header out;
    if (encoding_ == Encoding::ros1) number<std::uint32_t>();  // sequence number
    // ROS 1 has the seconds unsigned, ROS 2 signed: the same until 2038.
    const std::int64_t seconds =
        encoding_ == Encoding::ros1 ? std::int64_t{number<std::uint32_t>()} : number<std::int32_t>();
    const std::int64_t nanoseconds = number<std::uint32_t>();
    if (nanoseconds >= kSecond) reader_.fail();
    out.stamp_ns = seconds * kSecond + nanoseconds;
    out.frame = text();
    return out;
  }

 private:
  void read_representation() {
    const auto representation = reader_.big_endian<std::uint16_t>();
    reader_.take(2);  // options
    const bool xcdr2 = representation == 6 || representation == 7;
    if (representation > 1 && !xcdr2)
      reader_.fail();  // parameter lists and delimited data: no message has them
    order_ = representation % 2 == 0 ? std::endian::big : std::endian::little;
    if (xcdr2) largest_alignment_ = 4;
  }
  void align(std::size_t size) {
    if (encoding_ == Encoding::ros1) return;
    const std::size_t step = std::min(size, largest_alignment_);
    const std::size_t at = size_ - reader_.left();
    reader_.take((step - at % step) % step);
  }

  ByteReader reader_;
  Encoding encoding_;
  std::endian order_ = std::endian::little;
  std::size_t largest_alignment_ = 8;
  std::size_t size_ = 0;  // of what alignment counts from
};

/// Whether it is a rotation; some publishers write single precision.
bool is_rotation(const std::array<double, 4>& q) {
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return std::abs(norm - 1.0) <= kQuaternionTolerance;
}

bool is_finite(const std::array<double, 3>& position) {
  return std::all_of(position.begin(), position.end(), [](double one) { return std::isfinite(one); });
}

/// Position and quaternion. What is no rotation has no yaw.
void read_pose(MessageReader& reader, PoseMessage& out) {
  const auto position = reader.numbers<double, 3>();
  const auto q = reader.numbers<double, 4>();
  out.x = position[0];
  out.y = position[1];
  out.yaw = is_rotation(q) ? std::atan2(2.0 * (q[3] * q[2] + q[0] * q[1]),
                                        q[3] * q[3] + q[0] * q[0] - q[1] * q[1] - q[2] * q[2])
                           : std::nan("");
}

/// No reading, where REP 117 or a driver puts no finite distance.
void blank_non_finite(std::vector<float>& ranges) {
  for (float& range : ranges)
    if (!std::isfinite(range)) range = 0.0F;
}

template <typename Message>
std::optional<Message> if_whole(const MessageReader& reader, Message message) {
  if (!reader.ok()) return std::nullopt;
  return message;
}

}  // namespace

Kind kind_of(std::string_view type) {
  std::string name(type);
  if (const auto at = name.find("/msg/"); at != std::string::npos) name.erase(at, 4);
  for (const Row& row : kKinds)
    if (name == row.type) return row.kind;
  return Kind::none;
}

const char* type_of(Kind kind) {
  for (const Row& row : kKinds)
    if (row.kind == kind) return row.type;
  return "";
}

std::string_view md5_of(Kind kind) {
  for (const Row& row : kKinds)
    if (row.kind == kind) return row.md5;
  return {};
}

std::optional<LaserScan> decode_scan(std::string_view bytes, Encoding encoding) {
  MessageReader reader(bytes, encoding);
  LaserScan out;
  out.header = reader.header();
  const auto numbers = reader.numbers<float, 7>();
  out.scan.angle_min = static_cast<double>(numbers[0]);
  out.scan.angle_increment = static_cast<double>(numbers[2]);
  out.scan.time_increment = static_cast<double>(numbers[3]);  // 0: unknown, as everywhere
  out.scan.range_min = static_cast<double>(numbers[5]);
  out.scan.range_max = static_cast<double>(numbers[6]);
  out.scan.ranges = reader.sequence<float>();
  out.scan.intensities = reader.sequence<float>();
  if (out.scan.intensities.size() != out.scan.ranges.size()) out.scan.intensities.clear();
  blank_non_finite(out.scan.ranges);
  return if_whole(reader, std::move(out));
}

std::optional<JointState> decode_joints(std::string_view bytes, Encoding encoding) {
  MessageReader reader(bytes, encoding);
  JointState out;
  out.header = reader.header();
  out.names = reader.texts();
  out.positions = reader.sequence<double>();
  out.velocities = reader.sequence<double>();
  for (std::vector<double>* values : {&out.positions, &out.velocities})
    if (values->size() != out.names.size()) values->clear();
  return if_whole(reader, std::move(out));
}

std::optional<Imu> decode_imu(std::string_view bytes, Encoding encoding) {
  MessageReader reader(bytes, encoding);
  Imu out;
  out.header = reader.header();
  reader.numbers<double, 4 + 9>();  // orientation and its covariance
  const auto rate = reader.numbers<double, 3>();
  const auto covariance = reader.numbers<double, 9>();
  if (covariance[0] != -1.0) out.yaw_rate = rate[2];
  return if_whole(reader, std::move(out));
}

std::optional<PoseMessage> decode_odometry(std::string_view bytes, Encoding encoding) {
  MessageReader reader(bytes, encoding);
  PoseMessage out;
  out.header = reader.header();
  out.child_frame = reader.text();
  read_pose(reader, out);
  if (!reader.ok()) return std::nullopt;
  reader.numbers<double, 36>();  // covariance
  const auto twist = reader.numbers<double, 6>();
  // A message that ends before its twist is a pose none the less.
  out.moves = reader.ok() && (std::abs(twist[0]) > 0.0 || std::abs(twist[5]) > 0.0);
  return out;
}

std::optional<PoseMessage> decode_pose(std::string_view bytes, Encoding encoding) {
  MessageReader reader(bytes, encoding);
  PoseMessage out;
  out.header = reader.header();
  read_pose(reader, out);
  return if_whole(reader, std::move(out));
}

std::optional<Transforms> decode_transforms(std::string_view bytes, Encoding encoding) {
  MessageReader reader(bytes, encoding);
  Transforms out;
  const std::size_t count = reader.count(kMostTransforms);
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    Transform one;
    one.frame = reader.header().frame;
    one.child = reader.text();
    one.position = reader.numbers<double, 3>();
    one.quaternion = reader.numbers<double, 4>();
    if (is_finite(one.position) && is_rotation(one.quaternion))
      out.usable.push_back(std::move(one));
    else
      ++out.unusable;
  }
  return if_whole(reader, std::move(out));
}

std::optional<std::string> decode_text(std::string_view bytes, Encoding encoding) {
  MessageReader reader(bytes, encoding);
  std::string text = reader.text();
  return if_whole(reader, std::move(text));
}

}  // namespace odomcalib::ros
