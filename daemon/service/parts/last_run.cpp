#include "daemon/service/parts/last_run.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>

#include "proto/file_bytes.hpp"

namespace odomcalib {
namespace {

using nlohmann::json;

// Not synced: it serves after the end of a process, not of the power. A part of it is never read: where the
// disk is full or read-only, the old record stays.
void replace(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path fresh = file.string() + ".new";
  std::ofstream out(fresh, std::ios::trunc);
  out << text;
  out.close();
  std::error_code ignored;  // nothing is kept, and nobody waits for it
  if (out)
    std::filesystem::rename(fresh, file, ignored);
  else
    std::filesystem::remove(fresh, ignored);
}

/// The content of a file; a member that it lacks is as if nothing had happened.
struct RunRecord {
  bool ended = true, moved = false;
  std::string doing, last_stop;
  std::optional<Error> damage;
};

Error damaged_record(const std::filesystem::path& file, const std::string& what) {
  return {ErrorCode::format, what, file.string(),
          "why the robot was stopped last, and whether the daemon before this one crashed, may be missing; "
          "check the disk"};
}

/// @param wrong set where a member is there and is of another type
template <typename T>
void take_member(const json& body, const char* name, T& value, bool& wrong) {
  const auto member = body.find(name);
  if (member == body.end()) return;  // an earlier version did not write it
  constexpr bool kFlag = std::is_same_v<T, bool>;
  if (kFlag ? member->is_boolean() : member->is_string())
    value = member->get<T>();
  else
    wrong = true;
}

RunRecord run_record_of(const std::filesystem::path& file) {
  RunRecord left;
  if (is_absent(file)) return left;
  const auto bytes = read_file_bytes(file);
  if (!bytes) {
    left.damage = damaged_record(file, "cannot be read: " + bytes.error().what);
    return left;
  }
  const json body = json::parse(bytes.value(), nullptr, false);
  bool wrong = !body.is_object();
  if (!wrong) {
    take_member(body, "ended", left.ended, wrong);
    take_member(body, "moved", left.moved, wrong);
    take_member(body, "doing", left.doing, wrong);
    take_member(body, "last_stop", left.last_stop, wrong);
  }
  if (wrong) left.damage = damaged_record(file, "is damaged");
  return left;
}

}  // namespace

LastRun::LastRun(std::filesystem::path file, Background& disk) : file_(std::move(file)), disk_(disk) {
  RunRecord left = run_record_of(file_);
  moved_ = left.moved;
  after_crash_ = !left.ended;
  damage_ = std::move(left.damage);
  last_stop_ = after_crash_ ? "the daemon before this one ended without being stopped" +
                                  (left.doing.empty() ? "" : ", during \"" + left.doing + "\"")
                            : std::move(left.last_stop);
  if (damage_ && last_stop_.empty()) last_stop_ = "not known: " + file_.string() + " " + damage_->what;
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
