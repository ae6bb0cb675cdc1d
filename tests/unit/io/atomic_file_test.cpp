#include "saltus/io/atomic_file.hpp"

#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

#include <gtest/gtest.h>

namespace saltus::io {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public testing::Test {
 protected:
  AtomicFile() : folder_((fs::temp_directory_path() / "saltus-atomic-XXXXXX").string()) {
    if (::mkdtemp(folder_.data()) == nullptr) ADD_FAILURE() << "no temporary folder";
  }
  ~AtomicFile() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path at(const std::string& name) const { return fs::path(folder_) / name; }
  [[nodiscard]] std::size_t number_of_files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  std::string folder_;
};

TEST_F(AtomicFile, WritesWhatReadingGivesBackAndLeavesNothingElse) {
  const std::string bytes("a\0b\r\n\xff", 6);
  ASSERT_TRUE(write_file(at("x.json"), bytes));
  const auto read = read_file(at("x.json"));
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, bytes);
  ASSERT_TRUE(write_file(at("x.json"), "new"));
  EXPECT_EQ(*read_file(at("x.json")), "new");
  EXPECT_EQ(number_of_files(), 1U);
}

TEST_F(AtomicFile, ALinkToAFileThatIsNotThereYetStaysALink) {
  fs::create_symlink("new.json", at("link.json"));
  fs::create_symlink(at("link.json"), at("second.json"));
  EXPECT_EQ(target_of(at("second.json")), at("new.json"));
  ASSERT_TRUE(write_file(at("second.json"), "content"));
  EXPECT_TRUE(fs::is_symlink(at("second.json")));
  EXPECT_FALSE(fs::is_symlink(at("new.json")));
  EXPECT_EQ(*read_file(at("new.json")), "content");
}

TEST_F(AtomicFile, CirclesOfLinksAreRefused) {
  fs::create_symlink("b.json", at("a.json"));
  fs::create_symlink("a.json", at("b.json"));
  EXPECT_FALSE(check_writable(at("a.json")));
}

TEST_F(AtomicFile, NamesThatNoFileCanHaveAreRefusedBeforeComputing) {
  const auto writable = check_writable(at(std::string(300, 'r') + ".json"));
  ASSERT_FALSE(writable);
  EXPECT_NE(writable.error().message.find("File name too long"), std::string::npos) << writable.error().message;
}

TEST_F(AtomicFile, KeepsThePermissionsOfTheFileItReplacesAndTheLinkItIsNamedBy) {
  ASSERT_TRUE(write_file(at("real.csv"), "old"));
  ASSERT_EQ(::chmod(at("real.csv").c_str(), 0640), 0);
  fs::create_symlink("real.csv", at("link.csv"));
  ASSERT_TRUE(write_file(at("link.csv"), "new"));
  EXPECT_TRUE(fs::is_symlink(at("link.csv")));
  EXPECT_EQ(*read_file(at("real.csv")), "new");
  struct stat status {};
  ASSERT_EQ(::stat(at("real.csv").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640U);
}

TEST_F(AtomicFile, CheckLeavesAnExistingFileAsItIs) {
  ASSERT_TRUE(write_file(at("x.json"), "old"));
  ASSERT_TRUE(check_writable(at("x.json")));
  ASSERT_TRUE(check_writable(at("new.json")));
  EXPECT_EQ(*read_file(at("x.json")), "old");
  EXPECT_EQ(number_of_files(), 1U);
}

TEST_F(AtomicFile, RefusesWhatCannotBeWrittenAndSaysWhy) {
  fs::create_directory(at("folder"));
  std::ofstream(at("plain")) << "x";
  EXPECT_NE(check_writable(at("folder")).error().message.find("this is a folder"), std::string::npos);
  EXPECT_NE(check_writable(at("none/x.json")).error().message.find("there is no folder"), std::string::npos);
  EXPECT_NE(check_writable(at("plain/x.json")).error().message.find("is not a folder"), std::string::npos);
  EXPECT_NE(check_writable("/dev/null").error().message.find("not a regular file"), std::string::npos);
  EXPECT_EQ(check_writable(at("folder")).error().code, ErrorCode::io_failure);
  EXPECT_FALSE(write_file(at("none/x.json"), "x"));
}

TEST_F(AtomicFile, RefusesWhatCannotBeReadAndSaysWhy) {
  EXPECT_NE(read_file(folder_).error().message.find("this is a folder"), std::string::npos);
  EXPECT_NE(read_file(at("none")).error().message.find("no such file"), std::string::npos);
  EXPECT_EQ(read_file(at("none")).error().location.file, at("none").string());
}

}  // namespace
}  // namespace saltus::io
