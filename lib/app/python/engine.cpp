// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/python/engine.h"

#include <exception>
#include <new>

#include "base/core/error.h"
#include "store/hdf5/memory_file.h"

namespace landfall::python {
namespace {

/// A thread keeps the text that it was given last, and its last failure.
struct LastCall {
  std::string text;
  const char* kind = "";
  std::string message;
};
thread_local LastCall last_call;

/// Keeps the exception that is being handled.
void keep_failure() {
  const auto keep = [](const char* kind, const char* message) {
    last_call.kind = kind;
    last_call.message = message;
  };
  try {
    throw;
  } catch (const UsageError& error) {
    keep("UsageError", error.what());
  } catch (const Error& error) {
    keep("DataError", error.what());
  } catch (const std::bad_alloc&) {
    keep("MemoryError", "");
  } catch (const std::exception& error) {
    keep("RuntimeError", error.what());
  }
}

}  // namespace

bool succeeds(const std::function<void()>& work) {
  try {
    work();
    return true;
  } catch (...) {
    keep_failure();
    return false;
  }
}

const char* text_of(const std::function<std::string()>& make) {
  return succeeds([&] { last_call.text = make(); }) ? last_call.text.c_str() : nullptr;
}

Object* object_of(const std::function<Object*()>& make) {
  Object* object = nullptr;
  succeeds([&] { object = make(); });
  return object;
}

bool landfall_start() {
  return succeeds([] {
    // The tools end a process that has no memory left; Python raises MemoryError.
    std::set_new_handler(nullptr);
    if (!h5::is_built_for_threads())
      throw FormatError("runs of several threads need an HDF5 that was built with --enable-threadsafe");
  });
}

const char* landfall_failure(const char** kind) {
  *kind = last_call.kind;
  return last_call.message.c_str();
}

void landfall_delete(Object* object) { delete object; }

}  // namespace landfall::python
