#include "proto/recording/ros/metadata.hpp"

#include <yaml.h>

#include <filesystem>

namespace odomcalib::ros {
namespace {

/// Levels of `rosbag2_bagfile_information: {relative_file_paths: [...]}` below the stream: inside the outer
/// mapping, inside the inner one, inside the list.
constexpr int kOuter = 1, kInner = 2, kList = 3;

/// Follows the events of a document as deep as the list of files.
class ListReader {
 public:
  void take(const yaml_event_t& event) {
    switch (event.type) {
      case YAML_SCALAR_EVENT:
        take_scalar({reinterpret_cast<const char*>(event.data.scalar.value), event.data.scalar.length});
        break;
      case YAML_ALIAS_EVENT:
        take_scalar("");
        break;
      case YAML_MAPPING_START_EVENT:
        begin(true);
        break;
      case YAML_SEQUENCE_START_EVENT:
        begin(false);
        break;
      case YAML_MAPPING_END_EVENT:
      case YAML_SEQUENCE_END_EVENT:
        end();
        break;
      default:
        break;
    }
  }

  [[nodiscard]] std::vector<std::string> files() && { return std::move(files_); }

 private:
  void take_scalar(std::string_view text) {
    if (depth_ == kList && in_list_) files_.push_back(std::filesystem::path(text).filename().string());
    if (depth_ != kOuter && depth_ != kInner) return;
    if (is_key_) (depth_ == kOuter ? outer_key_ : inner_key_) = text;
    is_key_ = !is_key_;
  }

  void begin(bool mapping) {
    ++depth_;
    in_list_ = !mapping && depth_ == kList && outer_key_ == "rosbag2_bagfile_information" &&
               inner_key_ == "relative_file_paths";
    is_key_ = mapping;
  }

  void end() {
    --depth_;
    in_list_ = false;
    is_key_ = true;  // it was a value
  }

  int depth_ = 0;
  bool is_key_ = false, in_list_ = false;
  std::string outer_key_, inner_key_;
  std::vector<std::string> files_;
};

/// An event of libyaml, or the end of what can be read.
class Events {
 public:
  explicit Events(std::string_view yaml) : works_(yaml_parser_initialize(&parser_) != 0) {
    if (works_)
      yaml_parser_set_input_string(&parser_, reinterpret_cast<const unsigned char*>(yaml.data()),
                                   yaml.size());
  }
  ~Events() {
    if (works_) yaml_parser_delete(&parser_);
  }
  Events(const Events&) = delete;
  Events& operator=(const Events&) = delete;

  /// @param visit gets each event. @return whether the text was sound to its end
  template <typename Visit>
  bool visit_all(Visit visit) {
    for (bool ended = false; works_ && !ended;) {
      yaml_event_t event{};
      if (yaml_parser_parse(&parser_, &event) == 0) return false;
      visit(event);
      ended = event.type == YAML_STREAM_END_EVENT;
      yaml_event_delete(&event);
    }
    return works_;
  }

 private:
  yaml_parser_t parser_{};
  bool works_;
};

}  // namespace

std::vector<std::string> files_listed(std::string_view yaml) {
  ListReader reader;
  if (!Events(yaml).visit_all([&](const yaml_event_t& event) { reader.take(event); })) return {};
  return std::move(reader).files();
}

}  // namespace odomcalib::ros
