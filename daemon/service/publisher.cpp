#include "daemon/service/publisher.hpp"

#include <lcm/lcm.h>

#include <atomic>
#include <boost/lockfree/queue.hpp>
#include <semaphore>
#include <thread>
#include <utility>

#include "daemon/service/settings.hpp"

namespace odomcalib {
namespace {

class LcmOutlet final : public Outlet {
 public:
  explicit LcmOutlet(lcm_t* lcm) : lcm_(lcm) {}
  ~LcmOutlet() override { lcm_destroy(lcm_); }
  LcmOutlet(const LcmOutlet&) = delete;
  LcmOutlet& operator=(const LcmOutlet&) = delete;
  bool publish(const std::string& channel, const std::string& message) override {
    return lcm_publish(lcm_, channel.c_str(), message.data(), static_cast<unsigned>(message.size())) == 0;
  }

 private:
  lcm_t* lcm_;
};

struct Message {
  std::string channel, bytes;
};

}  // namespace

std::unique_ptr<Outlet> open_lcm(const std::string& url) {
  lcm_t* lcm = lcm_create(url.c_str());
  return lcm != nullptr ? std::make_unique<LcmOutlet>(lcm) : nullptr;
}

// Shared with the thread. Both ends take from the queue: the thread to send, the loop to make room.
struct Publisher::Sender {
  Sender(std::string where, Open with) : url(std::move(where)), open(std::move(with)) {}
  ~Sender() {
    while (take()) {
    }
  }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  std::unique_ptr<Message> take() {
    Message* taken = nullptr;
    if (!queue.pop(taken)) return nullptr;
    waiting.fetch_sub(taken->bytes.size(), std::memory_order_relaxed);
    return std::unique_ptr<Message>(taken);
  }
  bool put(std::unique_ptr<Message>& message) {
    if (!queue.push(message.get())) return false;
    waiting.fetch_add(message.release()->bytes.size(), std::memory_order_relaxed);
    return true;
  }
  void wake() {
    calls.fetch_add(1, std::memory_order_release);
    calls.notify_one();
  }
  void open_when_asked() {
    if (!to_open.exchange(false, std::memory_order_acq_rel)) return;
    outlet = open(url);
    opened.store(outlet != nullptr, std::memory_order_release);
    refused.store(outlet == nullptr, std::memory_order_release);
  }
  void drain() {
    while (!abandoned.load(std::memory_order_acquire)) {
      const auto message = take();
      if (!message) return;
      const bool gone = outlet && outlet->publish(message->channel, message->bytes);
      (gone ? sent : failed).fetch_add(1, std::memory_order_relaxed);
    }
  }
  void run() {
    for (;;) {
      // Both are read before the queue: what comes later changes `calls`, and after the end nothing comes.
      const std::uint32_t seen = calls.load(std::memory_order_acquire);
      const bool last = ended.load(std::memory_order_acquire);
      open_when_asked();
      drain();
      if (last) break;
      calls.wait(seen, std::memory_order_acquire);
    }
    outlet.reset();
    done.release();
  }

  const std::string url;
  const Open open;
  std::unique_ptr<Outlet> outlet;  // of the thread
  boost::lockfree::queue<Message*, boost::lockfree::capacity<service::settings::kMostUnsent>> queue;  // owns
  std::atomic<std::size_t> waiting = 0;                                                               // bytes
  std::atomic<std::uint32_t> calls = 0;  // changes when there is something to look at
  std::atomic<bool> to_open = true, opened = false, refused = false, ended = false, abandoned = false;
  std::atomic<std::uint64_t> sent = 0, failed = 0;
  std::binary_semaphore done{0};
};

Publisher::Publisher(std::string url, std::string prefix, Open open) : prefix_(std::move(prefix)) {
  if (url.empty()) return;
  sender_ = std::make_shared<Sender>(std::move(url), std::move(open));
  std::thread([sender = sender_] { sender->run(); }).detach();
}

Publisher::~Publisher() {
  if (!sender_) return;
  sender_->ended.store(true, std::memory_order_release);
  sender_->wake();
  if (!sender_->done.try_acquire_for(service::settings::kPublisherEnd))
    sender_->abandoned.store(true, std::memory_order_release);
}

void Publisher::serve(double now) {
  if (!sender_ || sender_->opened.load(std::memory_order_acquire)) return;
  if (!next_try_) next_try_ = now + service::settings::kPublisherRetry_s;
  if (now < *next_try_) return;
  next_try_ = now + service::settings::kPublisherRetry_s;
  sender_->to_open.store(true, std::memory_order_release);
  sender_->wake();
}

bool Publisher::drop_oldest() {
  if (!sender_->take()) return false;
  ++dropped_;
  return true;
}

void Publisher::make_room(std::size_t bytes) {
  while (sender_->waiting.load(std::memory_order_relaxed) + bytes > service::settings::kMostUnsent_bytes)
    if (!drop_oldest()) return;  // all of it goes: a message may be larger than what may wait
}

void Publisher::send(const std::string& channel, const std::string& message) {
  if (!sender_) return;
  auto kept = std::make_unique<Message>(Message{prefix_ + channel, message});
  make_room(message.size());
  // A place that the thread is just giving back may not be free yet: then it is this message that goes.
  if (!sender_->put(kept) && (!drop_oldest() || !sender_->put(kept))) ++dropped_;
  sender_->wake();
}

std::string Publisher::refused() const {
  return sender_ && sender_->refused.load(std::memory_order_acquire) ? sender_->url : "";
}

Publisher::Counters Publisher::counters() const {
  if (!sender_) return {};
  return {sender_->sent.load(std::memory_order_relaxed), sender_->failed.load(std::memory_order_relaxed),
          dropped_};
}

}  // namespace odomcalib
