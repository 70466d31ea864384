// SPDX-License-Identifier: GPL-3.0-or-later
// A raster is a product: the file, and the files in its folder with the same name up to the last dot.
// Detached labels, headers and world files therefore need no permission, and the sources of a VRT do. The
// permission is a command-line option and not a key, because a configuration may come from the same source
// as the raster. It is checked where GDAL opens files, not by searching formats for names, because there
// are too many formats; the list of GDAL's drivers is an allow-list.
#include "formats/gdal/file_guard.h"

#include <cpl_conv.h>
#include <cpl_vsi_virtual.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <map>
#include <mutex>
#include <system_error>
#include <utility>
#include <vector>

#include "base/text/characters.h"
#include "base/text/file_path.h"
#include "formats/gdal/raster_files.h"
#include "formats/gdal/registry.h"

namespace landfall {
namespace {

namespace fs = std::filesystem;

/// Empty if the file does not exist.
fs::path real_path(const fs::path& file) {
  std::error_code unreachable;
  return fs::canonical(file, unreachable);
}

/// The folder of GDAL's own schemas and tables; empty if GDAL does not find it.
fs::path resource_folder() {
  const char* const file = CPLFindFile("gdal", "gdalvrt.xsd");
  return file != nullptr ? real_path(fs::path(file).parent_path()) : fs::path();
}

/// A folder, or a file of a raster together with the files that belong to it.
struct Product {
  fs::path file;
  fs::path folder;
  std::string stem;  ///< empty: all files of the folder

  explicit Product(const std::string& name) : file(real_path(name)), folder(file.parent_path()) {
    if (fs::is_directory(status_of(file))) folder = file;
    const bool whole_folder =
        folder == file || lower_case(file.extension().string()) == ".adf";  // the grids of ArcInfo
    if (!whole_folder) stem = lower_case(fs::path(name).stem().string());
  }
  [[nodiscard]] bool holds(const std::string& name, const fs::path& real) const {
    if (real == file) return true;
    if (real.parent_path() != folder) return false;
    const std::string part = lower_case(fs::path(name).filename().string());
    return stem.empty() || part == stem || part.starts_with(stem + ".");
  }
};

struct Permit {
  bool all = false;
  std::vector<Product> products;
  std::optional<std::string> refused{};
};

/// The permits of all existing guards.
class Permits {
 public:
  static Permits& of_process() {
    static Permits permits;
    return permits;
  }
  int add(Permit permit) {
    const std::lock_guard guard(lock_);
    permits_.emplace(++last_, std::move(permit));
    return last_;
  }
  void remove(int number) {
    const std::lock_guard guard(lock_);
    permits_.erase(number);
  }
  std::optional<std::string> refused(int number) {
    const std::lock_guard guard(lock_);
    return permits_.at(number).refused;
  }
  /// Records a refusal.
  bool allow(const std::string& name) {
    const std::lock_guard guard(lock_);
    if (permits_.empty()) return true;
    const fs::path real = real_path(name);
    if (real.empty() || real.parent_path() == resources_) return true;
    const auto allows = [&](const auto& entry) {
      const auto holds = [&](const Product& product) { return product.holds(name, real); };
      return entry.second.all || std::ranges::any_of(entry.second.products, holds);
    };
    if (std::ranges::any_of(permits_, allows)) return true;
    for (auto& [number, permit] : permits_)
      if (!permit.refused) permit.refused = name;
    return false;
  }

 private:
  std::mutex lock_;
  std::map<int, Permit> permits_;
  int last_ = 0;
  fs::path resources_ = resource_folder();
};

/// GDAL's handler of local files, restricted by the permits.
class GuardedFiles final : public VSIFilesystemHandler {
 public:
  explicit GuardedFiles(VSIFilesystemHandler& files) : files_(files) {}

  VSIVirtualHandle* Open(const char* name, const char* access, bool set_error,
                         CSLConstList options) override {
    if (access[0] == 'r' && !Permits::of_process().allow(name)) {
      errno = EACCES;
      return nullptr;
    }
    return files_.Open(name, access, set_error, options);
  }
  int Stat(const char* name, VSIStatBufL* status, int flags) override {
    return files_.Stat(name, status, flags);
  }
  int Unlink(const char* name) override { return files_.Unlink(name); }
  int Mkdir(const char* name, long mode) override { return files_.Mkdir(name, mode); }
  int Rmdir(const char* name) override { return files_.Rmdir(name); }
  char** ReadDirEx(const char* name, int maximum) override { return files_.ReadDirEx(name, maximum); }
  char** SiblingFiles(const char* name) override { return files_.SiblingFiles(name); }
  int Rename(const char* from, const char* to) override { return files_.Rename(from, to); }
  int IsCaseSensitive(const char* name) override { return files_.IsCaseSensitive(name); }
  GIntBig GetDiskFreeSpace(const char* name) override { return files_.GetDiskFreeSpace(name); }
  int SupportsSparseFiles(const char* name) override { return files_.SupportsSparseFiles(name); }
  VSIDIR* OpenDir(const char* name, int depth, const char* const* options) override {
    return files_.OpenDir(name, depth, options);
  }
  bool IsLocal(const char* name) override { return files_.IsLocal(name); }

 private:
  VSIFilesystemHandler& files_;
};

/// A file system without files.
class NoFiles final : public VSIFilesystemHandler {
 public:
  VSIVirtualHandle* Open(const char*, const char*, bool, CSLConstList) override {
    return nothing(static_cast<VSIVirtualHandle*>(nullptr));
  }
  int Stat(const char*, VSIStatBufL*, int) override { return nothing(-1); }

 private:
  template <class T>
  static T nothing(T result) {
    errno = ENOENT;
    return result;
  }
};

/// GDAL takes ownership of the handlers.
void install_handlers() {
  VSIFileManager::InstallHandler("", new GuardedFiles(*VSIFileManager::GetHandler("")));
  VSIFileManager::InstallHandler("/vsistdin/", new NoFiles);
  VSIFileManager::InstallHandler("/vsistdin?", new NoFiles);
  CPLSetConfigOption("GDAL_VRT_ENABLE_PYTHON", "NO");
}

}  // namespace

FileGuard::FileGuard(std::string raster, RasterLinks links) : raster_(std::move(raster)) {
  static std::once_flag first;
  std::call_once(first, install_handlers);
  const bool follows = links == RasterLinks::followed;
  const std::vector<std::string> files = own_files(raster_);
  const bool unguarded = any_hdf5_or_netcdf(files);
  prepare_gdal_to_read(raster_, follows || unguarded ? Unguarded::offered : Unguarded::withheld);
  // An .aux.xml could name a layer of another file, which HDF5 would open without the guard.
  if (unguarded && !follows) no_sidecars_.emplace("GDAL_PAM_ENABLED", "NO", false);
  Permit permit{follows, {}};
  for (const std::string& file : files) permit.products.emplace_back(file);
  number_ = Permits::of_process().add(std::move(permit));
}

GDALDatasetUniquePtr FileGuard::open(unsigned flags) const {
  // GDAL compares valid ranges with packed numbers whatever they refer to; "@": only where a driver knows it.
  const char* const options[] = {"@HONOUR_VALID_RANGE=NO", nullptr};
  return GDALDatasetUniquePtr(GDALDataset::Open(raster_.c_str(), flags, raster_drivers(), options));
}

GDALDatasetUniquePtr FileGuard::open_arrays(const std::string& file, const std::string& driver) const {
  const char* const drivers[] = {driver.c_str(), nullptr};
  return GDALDatasetUniquePtr(
      GDALDataset::Open(file.c_str(), GDAL_OF_MULTIDIM_RASTER | GDAL_OF_READONLY, drivers));
}

FileGuard::~FileGuard() { Permits::of_process().remove(number_); }

std::optional<std::string> FileGuard::refused() const { return Permits::of_process().refused(number_); }

}  // namespace landfall
