// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/gdal/raster_files.h"

#include <cpl_minixml.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

#include "base/text/file_path.h"
#include "formats/gdal/file_guard.h"
#include "formats/gdal/gdal_errors.h"

namespace landfall {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSeparators = ":\"'?";
constexpr std::size_t kMaxSeparators = 16;  // names with more separators are not file names
constexpr std::uintmax_t kMaxVrtBytes = std::uintmax_t{64} << 20U;

/// A file's name, which may contain separators itself, may lie between any two separators.
std::vector<std::string> parts_of(const std::string& name) {
  std::vector<std::size_t> ends;
  for (std::size_t at = name.find_first_of(kSeparators); at != std::string::npos;
       at = name.find_first_of(kSeparators, at + 1))
    ends.push_back(at);
  if (ends.size() > kMaxSeparators) return {};
  ends.push_back(name.size());
  std::vector<std::string> parts;
  for (std::size_t first = 0; first <= ends.size() - 1; ++first) {
    const std::size_t begin = first == 0 ? 0 : ends[first - 1] + 1;
    for (std::size_t last = first; last < ends.size(); ++last)
      if (ends[last] > begin) parts.push_back(name.substr(begin, ends[last] - begin));
  }
  return parts;
}

/// "f.zip" of "/vsizip/f.zip/a.tif", "/data/f.gz" of "/vsigzip//data/f.gz".
std::string archive_of(const std::string& name) {
  if (name.compare(0, 4, "/vsi") != 0) return "";
  fs::path file = name.substr(std::min(name.size(), name.find('/', 4) + 1));
  while (!file.empty() && file.has_relative_path() && !fs::is_regular_file(status_of(file)))
    file = file.parent_path();
  return file.string();
}

using Xml = std::unique_ptr<CPLXMLNode, decltype(&CPLDestroyXMLNode)>;

/// The first bytes of a file, padded with zeros.
std::string head_of(const std::string& path) {
  std::string head(1024, '\0');
  if (VSILFILE* const file = VSIFOpenL(path.c_str(), "rb"); file != nullptr) {
    VSIFReadL(head.data(), 1, head.size(), file);
    VSIFCloseL(file);
  }
  return head;
}

bool is_vrt(const std::string& path) {
  std::error_code unreachable;
  return fs::is_regular_file(path, unreachable) && fs::file_size(path, unreachable) <= kMaxVrtBytes &&
         head_of(path).find("<VRTDataset") != std::string::npos;
}

/// Null for a file that is not a VRT.
Xml vrt_of(const std::string& name) {
  CPLXMLNode* tree = nullptr;
  if (name.find("<VRTDataset") != std::string::npos)
    tree = CPLParseXMLString(name.c_str());
  else if (is_vrt(name))
    tree = CPLParseXMLFile(name.c_str());
  return {tree, CPLDestroyXMLNode};
}

void add_sources(const CPLXMLNode* node, const fs::path& folder, std::vector<std::string>& names) {
  for (; node != nullptr; node = node->psNext) {
    const bool is_source =
        node->eType == CXT_Element && (std::strcmp(node->pszValue, "SourceFilename") == 0 ||
                                       std::strcmp(node->pszValue, "SourceDataset") == 0);
    if (is_source) {
      const std::string name = CPLGetXMLValue(node, nullptr, "");
      const bool is_relative = std::strcmp(CPLGetXMLValue(node, "relativeToVRT", "0"), "1") == 0;
      names.push_back(is_relative ? (folder / name).string() : name);
    }
    add_sources(node->psChild, folder, names);
  }
}

void add_once(std::vector<std::string>& files, const std::string& file) {
  if (fs::exists(status_of(file)) && std::ranges::find(files, file) == files.end()) files.push_back(file);
}

/// Adds the files that a name refers to. Opens none of them.
void add_own(const std::string& name, std::vector<std::string>& files) {
  add_once(files, name);
  if (fs::exists(status_of(name))) return;
  for (const std::string& part : parts_of(name)) add_once(files, part);
  add_once(files, archive_of(name));
}

/// Adds the files of a name, and those that they name themselves.
void add_linked(const std::string& path, std::vector<std::string>& files) {
  std::vector<std::string> names = {path};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name = names[i];
    const std::size_t known = files.size();
    add_own(name, files);
    if (const Xml inline_vrt = vrt_of(fs::exists(status_of(name)) ? "" : name))
      add_sources(inline_vrt.get(), "", names);
    for (std::size_t k = known; k < files.size(); ++k)
      if (const Xml vrt = vrt_of(files[k])) add_sources(vrt.get(), fs::path(files[k]).parent_path(), names);
  }
}

void add_named(const std::string& path, RasterLinks links, std::vector<std::string>& files) {
  if (links == RasterLinks::followed)
    add_linked(path, files);
  else
    add_own(path, files);
}

}  // namespace

std::vector<std::string> own_files(const std::string& path) {
  return named_files(path, RasterLinks::refused);
}

std::vector<std::string> named_files(const std::string& path, RasterLinks links) {
  const GdalErrors quiet;
  std::vector<std::string> files;
  add_named(path, links, files);
  return files;
}

bool any_hdf5_or_netcdf(const std::vector<std::string>& files) {
  return std::ranges::any_of(files, [](const std::string& file) {
    if (!fs::is_regular_file(status_of(file))) return false;
    const std::string head = head_of(file);
    return head.starts_with("\x89HDF") || head.starts_with("CDF");
  });
}

std::vector<std::string> all_dem_files(const DemBase& dem, RasterLinks links) {
  std::vector<std::string> files = named_files(dem.path, links);
  const GdalErrors quiet;
  const FileGuard guard(dem.path, links);
  const GDALDatasetUniquePtr dataset = guard.open(GDAL_OF_RASTER | GDAL_OF_READONLY);
  if (!dataset) return files;
  char** const listed = dataset->GetFileList();
  for (char** file = listed; file != nullptr && *file != nullptr; ++file) add_named(*file, links, files);
  CSLDestroy(listed);
  return files;
}

}  // namespace landfall
