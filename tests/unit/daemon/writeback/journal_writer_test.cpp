// A disk that takes its time: the transaction keeps turning, and no action begins before its record is there.
#include "daemon/writeback/journal_writer.hpp"

#include <deque>

#include "tests/unit/daemon/writeback/fake_controller.hpp"

namespace odomcalib::journal_writer_test {
namespace {

/// Nothing is done before the test says so.
class SlowDisk final : public Background {
 public:
  void post(std::function<void()> work, std::function<void()> done) override {
    waiting_.emplace_back(std::move(work), std::move(done));
  }
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
  void finish_one() {
    const auto [work, done] = std::move(waiting_.front());
    waiting_.pop_front();
    work();
    done();
  }

 private:
  std::deque<std::pair<std::function<void()>, std::function<void()>>> waiting_;
};

class SlowJournal : public testing::Test {
 protected:
  /// So many turns of the loop.
  void turn(int count) {
    for (int i = 0; i < count; ++i) transaction_.step(controller_, now_ += 0.01, 1);
  }
  /// Jobs of the controller that were begun while the disk took two seconds for one record.
  int jobs_while_the_disk_is_busy() {
    turn(3);
    const int before = controller_.jobs;
    turn(200);
    return controller_.jobs - before;
  }

  TemporaryFolder folder_;
  Memory memory_;
  FakeController controller_{memory_};
  SlowDisk disk_;
  Journal journal_ = Journal::open(folder_ / "journal").value();
  Transaction transaction_{journal_, disk_};
  double now_ = 0.0;
};

TEST_F(SlowJournal, holds_back_every_action_until_its_record_is_on_the_disk) {
  ASSERT_TRUE(transaction_.write("apply", kNew).ok());
  int records = 0;
  for (std::optional<WriteReport> report; !report; report = transaction_.take_report()) {
    EXPECT_EQ(jobs_while_the_disk_is_busy(), 0) << "after " << records << " records";
    ASSERT_EQ(disk_.waiting(), 1U) << "after " << records << " records";
    EXPECT_TRUE(transaction_.busy());
    disk_.finish_one();
    ++records;
    turn(1);
  }
  EXPECT_EQ(records, 6);  // begin, write, readback_ok, store_begin, store_ok, commit
  EXPECT_EQ(controller_.stores, 1);
  EXPECT_TRUE(is_new(memory_.stored));
  EXPECT_FALSE(transaction_.journal().unfinished());
}

TEST_F(SlowJournal, knows_only_records_that_are_on_the_disk) {
  ASSERT_TRUE(transaction_.write("apply", kNew).ok());
  turn(10);
  EXPECT_FALSE(transaction_.journal().last());
  EXPECT_TRUE(transaction_.journal().pending());
  disk_.finish_one();
  ASSERT_TRUE(transaction_.journal().last());
  EXPECT_EQ(transaction_.journal().last()->state, JournalState::begin);
  EXPECT_TRUE(is_old(memory_.ram));
}

}  // namespace
}  // namespace odomcalib::journal_writer_test
