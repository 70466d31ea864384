// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/core/plugin_file.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "base/core/error.h"
#include "base/memory/available_memory.h"

namespace landfall {
namespace {

namespace fs = std::filesystem;

/// The shared library that has this code; empty in a program that has it itself.
fs::path own_library() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&own_library), &info) == 0 || info.dli_fname == nullptr) return {};
  const fs::path file = info.dli_fname;
  return file.extension() == ".so" ? file : fs::path();
}

std::vector<fs::path> plugin_folders() {
  std::vector<fs::path> folders;
  // getenv is safe here because the program never changes the environment.
  if (const char* chosen = std::getenv("LANDFALL_PLUGIN_DIR");  // NOLINT(concurrency-mt-unsafe)
      chosen != nullptr && *chosen != '\0')
    folders.emplace_back(chosen);
  if (const fs::path library = own_library(); !library.empty()) folders.push_back(library.parent_path());
  std::error_code unreadable;
  const fs::path program = fs::read_symlink("/proc/self/exe", unreadable);
  if (!unreadable) {
    const fs::path prefix = program.parent_path().parent_path();
    folders.push_back(prefix / "lib" / "landfall");
    folders.push_back(prefix / LANDFALL_LIBDIR / "landfall");
  }
  folders.emplace_back(LANDFALL_PLUGIN_INSTALL_DIR);
  for (auto folder = folders.begin(); folder != folders.end();)
    folder = std::find(folders.begin(), folder, *folder) == folder ? folder + 1 : folders.erase(folder);
  return folders;
}

std::string last_dl_error() {
  const char* reason = dlerror();  // NOLINT(concurrency-mt-unsafe): glibc has one for each thread
  return reason != nullptr ? reason : "unknown reason";
}

const void* plugin_at(const fs::path& file, const PluginFile& wanted) {
  const std::string plugin = std::string(wanted.name) + " plugin: ";
  require_headroom(wanted.headroom);
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const std::string reason = last_dl_error();
    const bool is_damaged = reason.starts_with(file.string());
    throw IoError("cannot load the " + plugin + reason + (is_damaged ? "" : wanted.remedy));
  }
  const void* object = dlsym(library, wanted.symbol);
  if (object == nullptr) throw IoError("cannot use the " + plugin + last_dl_error());
  const std::string version = *static_cast<const char* const*>(object);
  if (version != LANDFALL_VERSION)
    throw IoError(file.string() + ": is of version " + version + ", this program of " LANDFALL_VERSION);
  return object;
}

}  // namespace

const void* load_plugin(const PluginFile& wanted) {
  std::string tried;
  for (const fs::path& folder : plugin_folders()) {
    const fs::path file = folder / wanted.file;
    std::error_code missing;
    if (fs::exists(file, missing)) return plugin_at(file, wanted);
    tried += (tried.empty() ? "" : ", ") + file.string();
  }
  throw IoError(std::string(wanted.needed_by) + " the plugin " + wanted.file +
                ", which a complete installation has; it is not at " + tried +
                "; install it, or set LANDFALL_PLUGIN_DIR to its directory");
}

}  // namespace landfall
