#include "output_file.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "temporary_folder.h"

namespace adaptive_grid_stereo {
namespace {

TEST(OutputFile, AppearsOnlyWhenCommitted) {
  const TemporaryFolder folder;
  {
    OutputFile file(folder.file("a.txt"), false);
    std::ofstream(file.writePath()) << "half";
    EXPECT_FALSE(std::filesystem::exists(folder.file("a.txt")));
  }
  EXPECT_EQ(folder.count(), 0);
  OutputFile file(folder.file("a.txt"), false);
  std::ofstream(file.writePath()) << "whole";
  file.commit();
  EXPECT_EQ(folder.read("a.txt"), "whole");
  EXPECT_EQ(folder.count(), 1);
}

TEST(OutputFile, OverwritesOnlyByForce) {
  const TemporaryFolder folder;
  folder.write("a.txt", "old");
  EXPECT_NE(messageOf([&] { writeFile(folder.file("a.txt"), "new", false); }).find("--force"),
            std::string::npos);
  EXPECT_EQ(folder.read("a.txt"), "old");
  writeFile(folder.file("a.txt"), std::string("new"), true);
  EXPECT_EQ(folder.read("a.txt"), "new");
}

TEST(OutputFile, RefusesFoldersAndMissingFolders) {
  const TemporaryFolder folder;
  EXPECT_NE(messageOf([&] { checkWritable(folder.path(), true); }).find("directory"),
            std::string::npos);
  EXPECT_NE(messageOf([&] { checkWritable(folder.path() + "/none/a", true); }).find("not exist"),
            std::string::npos);
}

TEST(OutputFile, ADeviceIsWrittenToAndNotReplaced) {
  writeFile("/dev/null", std::string("x"), true);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(OutputFile, ASignalLeavesNothingBehind) {
  const TemporaryFolder folder;
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    OutputFile file(folder.file("a.txt"), false);
    std::ofstream(file.writePath()) << "half" << std::flush;
    raise(SIGTERM);
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGTERM);
  EXPECT_EQ(folder.count(), 0);
}

}  // namespace
}  // namespace adaptive_grid_stereo
