// One request at a time to a device: sends it, repeats it when no answer comes, gives up after a few times.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace odomcalib::drivers {

class Dialogue {
 public:
  /// @param patience s to wait for an answer before asking again
  /// @param tries how often to ask in all; afterwards `gave_up()` is true
  void ask(std::vector<std::uint8_t> request, double now, double patience, int tries) {
    request_ = std::move(request);
    patience_ = patience;
    tries_ = tries;
    gave_up_ = false;
    send(now);
  }
  /// To be called as time passes.
  void step(double now) {
    if (gave_up_ || now < deadline_) return;
    if (tries_ <= 0)
      gave_up_ = true;
    else
      send(now);
  }
  [[nodiscard]] bool gave_up() const { return gave_up_; }
  void say(const std::vector<std::uint8_t>& bytes) {
    output_.insert(output_.end(), bytes.begin(), bytes.end());
  }
  std::vector<std::uint8_t> take_output() { return std::exchange(output_, {}); }
  void reset() { *this = {}; }

 private:
  void send(double now) {
    say(request_);
    --tries_;
    deadline_ = now + patience_;
  }

  std::vector<std::uint8_t> request_, output_;
  double patience_ = 0.0, deadline_ = 0.0;
  int tries_ = 0;
  bool gave_up_ = false;
};

}  // namespace odomcalib::drivers
