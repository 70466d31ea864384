// SPDX-License-Identifier: GPL-3.0-or-later
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "temporary_folder.h"

namespace landfall {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class GdalPluginFile : public ::testing::Test {
 protected:
  /// The message of load_dem() on any raster in a process of `program`, gdal_refusal or a copy of it: a
  /// process loads the plugin once.
  [[nodiscard]] std::string refusal(const fs::path& program, const fs::path& plugin_folder) const {
    const fs::path said = folder_ / "refusal";
    const std::string command =
        "LANDFALL_PLUGIN_DIR=" + plugin_folder.string() + " " + program.string() + " >" + said.string();
    EXPECT_EQ(std::system(command.c_str()), 0);
    return read_file(said);
  }

  /// The message of load_dem() if the plugin is the folder's.
  [[nodiscard]] std::string refusal_of_own() const { return refusal(program_, plugin_.parent_path()); }

  fs::path program_ = fs::read_symlink("/proc/self/exe").parent_path() / "gdal_refusal";
  TemporaryFolder folder_;
  fs::path plugin_ = folder_ / "landfall-gdal.so";
};

TEST_F(GdalPluginFile, ThatIsMissing) {
  // The copy of this program finds none beside it.
  const fs::path copy = folder_ / "tests/gdal_refusal";
  fs::create_directory(copy.parent_path());
  fs::copy_file(program_, copy);
  EXPECT_THAT(refusal(copy, "/nowhere"),
              AllOf(StartsWith("any.tif: rasters need the plugin landfall-gdal.so, which a complete "
                               "installation has; it is not at "),
                    HasSubstr("/nowhere/landfall-gdal.so"),
                    HasSubstr((folder_ / "lib/landfall/landfall-gdal.so").lexically_normal().string()),
                    HasSubstr("LANDFALL_PLUGIN_DIR")));
}

TEST_F(GdalPluginFile, ThatIsNoLibrary) {
  std::ofstream(plugin_) << "no library";
  EXPECT_THAT(refusal_of_own(),
              AllOf(StartsWith("any.tif: cannot load the GDAL plugin: "), HasSubstr(plugin_.string())));
}

TEST_F(GdalPluginFile, ThatIsAnotherLibrary) {
  Dl_info c_library{};
  ASSERT_NE(dladdr(dlsym(RTLD_DEFAULT, "gnu_get_libc_version"), &c_library), 0);
  fs::create_symlink(c_library.dli_fname, plugin_);
  EXPECT_THAT(refusal_of_own(),
              AllOf(StartsWith("any.tif: cannot use the GDAL plugin: "), HasSubstr("landfall_gdal_plugin")));
}

TEST_F(GdalPluginFile, ThatIsOfAnotherVersion) {
  const fs::path stale = program_.parent_path() / "stale_plugin";
  EXPECT_THAT(refusal(program_, stale), StartsWith("any.tif: " + (stale / "landfall-gdal.so").string() +
                                                   ": is of version 0.0.0, this program of "));
}

}  // namespace
}  // namespace landfall
