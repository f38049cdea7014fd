// The table of faults as the documents print it, and that it is whole.
#include "calib/ingest/checks.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

namespace odomcalib::calib::ingest::checks_test {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(Checks, have_no_empty_cell) {
  std::set<std::string> names;
  for (const Fault& fault : faults()) {
    EXPECT_TRUE(names.insert(fault.name).second) << fault.name << " stands twice";
    for (const Cell& cell : fault.cells) {
      EXPECT_EQ(cell.answer == Answer::told, cell.check != nullptr) << fault.name;
      if (cell.answer == Answer::cannot || cell.answer == Answer::mended) {
        EXPECT_STRNE(cell.words, "") << fault.name << ": why, or how";
      }
    }
  }
}

TEST(Checks, are_printed_in_the_documents_as_they_are) {
  const std::string page = text_of(ODOMCALIB_SOURCE_FOLDER "/docs/user/formats.md");
  EXPECT_NE(page.find(faults_table()), std::string::npos) << "docs/user/formats.md should hold\n"
                                                          << faults_table();
}

TEST(Checks, say_nothing_of_an_empty_recording) { EXPECT_FALSE(told_fault(Recording{})); }

}  // namespace
}  // namespace odomcalib::calib::ingest::checks_test
