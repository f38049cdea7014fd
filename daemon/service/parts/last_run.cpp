#include "daemon/service/parts/last_run.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "proto/file_bytes.hpp"

namespace odomcalib {
namespace {

using nlohmann::json;

// Not synced: it serves after the end of a process, not of the power. A part of it is never read.
void replace(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path fresh = file.string() + ".new";
  std::ofstream(fresh, std::ios::trunc) << text;
  std::error_code ignored;  // on a disk that is read-only, nothing is kept
  std::filesystem::rename(fresh, file, ignored);
}

}  // namespace

LastRun::LastRun(std::filesystem::path file, Background& disk) : file_(std::move(file)), disk_(disk) {
  const auto bytes = read_file_bytes(file_);
  const json left = bytes ? json::parse(bytes.value(), nullptr, false) : json();
  const auto text = [&left](const char* name) {
    return left.contains(name) && left[name].is_string() ? left[name].get<std::string>() : "";
  };
  if (left.is_object()) {
    moved_ = left.contains("moved") && left["moved"] == true;
    const std::string doing = text("doing");
    after_crash_ = left.contains("ended") && left["ended"] == false;
    last_stop_ = !after_crash_ ? text("last_stop")
                               : "the daemon before this one ended without being stopped" +
                                     (doing.empty() ? "" : ", during \"" + doing + "\"");
  }
  write();
}

void LastRun::begins(const std::string& what) {
  doing_ = what;
  moved_ = true;
  write();
}

void LastRun::ends() {
  doing_.clear();
  write();
}

void LastRun::stopped(const std::string& why) {
  last_stop_ = why;
  ends();
}

void LastRun::daemon_ends() {
  ended_ = true;
  write();
}

void LastRun::write() {
  const json body = {{"ended", ended_}, {"doing", doing_}, {"last_stop", last_stop_}, {"moved", moved_}};
  disk_.post([file = file_,
              text = body.dump(2, ' ', false, json::error_handler_t::replace)] { replace(file, text); },
             [] {});
}

}  // namespace odomcalib
