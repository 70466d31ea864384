// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/output/output_path.h"

#include <gtest/gtest.h>

#include "base/core/error.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

TEST(OutputPath, AppearsOnCommitOnly) {
  const TemporaryFolder folder;
  {
    OutputPath output(folder / "a.h5", false);
    std::ofstream(output.temporary()) << "new";
    EXPECT_FALSE(std::filesystem::exists(folder / "a.h5"));
    output.commit();
  }
  EXPECT_EQ(read_file(folder / "a.h5"), "new");
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(OutputPath, AFailureLeavesTheOldOutput) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.h5") << "old";
  {
    const OutputPath output(folder / "a.h5", true);
    std::ofstream(output.temporary()) << "new";
  }
  EXPECT_EQ(read_file(folder / "a.h5"), "old");
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(OutputPath, RefusesAnExistingOutput) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.h5") << "old";
  EXPECT_THROW(OutputPath(folder / "a.h5", false), UsageError);
  EXPECT_THROW(OutputPath(folder / "none/a.h5", false), UsageError);
  EXPECT_THROW(OutputPath(std::filesystem::temp_directory_path(), true), UsageError);
  EXPECT_THROW(OutputPath("", true), UsageError);
}

TEST(OutputPath, RefusesAnOutputThatAppearedMeanwhile) {
  const TemporaryFolder folder;
  OutputPath output(folder / "a.h5", false);
  std::ofstream(output.temporary()) << "new";
  std::ofstream(folder / "a.h5") << "other";
  EXPECT_THROW(output.commit(), UsageError);
  EXPECT_EQ(read_file(folder / "a.h5"), "other");
}

TEST(OutputPath, OverwritesWhenAsked) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.h5") << "old";
  OutputPath output(folder / "a.h5", true);
  std::ofstream(output.temporary()) << "new";
  output.commit();
  EXPECT_EQ(read_file(folder / "a.h5"), "new");
}

// Names of up to 255 bytes are outputs, though ".NAME.MACHINE-PID.part" would be longer than that.
TEST(OutputPath, TakesEveryNameThatAFileCanHave) {
  const TemporaryFolder folder;
  for (const std::size_t size : {200U, 231U, 232U, 254U, 255U}) {
    const std::string name(size, 'n');
    OutputPath output(folder / name, false);
    std::ofstream(output.temporary()) << "new";
    EXPECT_EQ(output.temporary().filename().string().front(), '.');
    output.commit();
    EXPECT_EQ(read_file(folder / name), "new") << size;
  }
  EXPECT_EQ(folder.entries(), 5U);
  EXPECT_THROW(OutputPath(folder / std::string(256, 'n'), false), UsageError);
}

TEST(OutputPath, HiddenFilesBesideAnOutput) {
  EXPECT_EQ(hidden_beside("folder/a.h5", "state"), "folder/.a.h5.state");
  EXPECT_EQ(hidden_beside("a.h5", "state"), ".a.h5.state");
  const std::string longest(255, 'n');
  EXPECT_LE(hidden_beside(longest, "state").string().size(), 255U);
  EXPECT_EQ(hidden_beside(longest, "state"), hidden_beside("./" + longest, "state").filename());
}

TEST(OutputPath, LongNamesDoNotShareATemporaryFile) {
  const TemporaryFolder folder;
  const OutputPath one(folder / std::string(255, 'n'), false);
  const OutputPath other(folder / (std::string(254, 'n') + "m"), false);
  EXPECT_NE(one.temporary(), other.temporary());
}

/// ".a.h5.PLACE-" of this machine.
std::string part_prefix(const TemporaryFolder& folder) {
  const std::string name = OutputPath(folder / "a.h5", false).temporary().filename().string();
  return name.substr(0, name.size() - (std::to_string(::getpid()) + ".part").size());
}

TEST(OutputPath, RemovesWhatAKilledRunLeft) {
  const TemporaryFolder folder;
  const std::string prefix = part_prefix(folder);
  std::ofstream(folder / (prefix + "2147483647.part")) << "abandoned";  // beyond any process number
  std::ofstream(folder / (prefix + std::to_string(::getpid()) + "1x.part")) << "not ours";
  const OutputPath output(folder / "a.h5", false);
  EXPECT_FALSE(std::filesystem::exists(folder / (prefix + "2147483647.part")));
  EXPECT_EQ(folder.entries(), 2U);  // with its own
}

// Another user of the folder may know the name of the temporary file.
TEST(OutputPath, FollowsNoLinkThatWasMadeBefore) {
  const TemporaryFolder folder;
  std::ofstream(folder / "precious") << "precious";
  std::filesystem::create_symlink(folder / "precious", temporary_of(folder / "a.h5"));
  OutputPath output(folder / "a.h5", false);
  EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(output.temporary())));
  std::ofstream(output.temporary()) << "new";
  output.commit();
  EXPECT_EQ(read_file(folder / "precious"), "precious");
  EXPECT_EQ(read_file(folder / "a.h5"), "new");
  EXPECT_FALSE(std::filesystem::is_symlink(folder / "a.h5"));
}

TEST(OutputPath, LeavesWhatAnotherMachineMayBeWriting) {
  const TemporaryFolder folder;
  std::ofstream(folder / ".a.h5.00000000-2147483647.part") << "another machine's";
  const OutputPath output(folder / "a.h5", false);
  EXPECT_EQ(folder.entries(), 2U);  // with its own
}

TEST(WriteText, WritesWhole) {
  const TemporaryFolder folder;
  OutputPath output(folder / "m.json", false);
  write_text(output, "{}\n");
  output.commit();
  EXPECT_EQ(read_file(folder / "m.json"), "{}\n");
  EXPECT_EQ(folder.entries(), 1U);
}

}  // namespace
}  // namespace landfall
