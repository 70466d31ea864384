// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/python/module.h"

#include <pybind11/stl.h>

#include <new>
#include <utility>

#include "base/core/error.h"

namespace landfall::python {
namespace {

namespace py = pybind11;

/// Ctrl-C, once per run; and what the caller does with the progress. True ends the run.
bool ask_python(const py::object& progress, const std::string& phase, double fraction, bool& interrupted) {
  const py::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() != 0) {
    interrupted = true;
    return true;
  }
  if (!progress.is_none() && !phase.empty()) progress(phase, fraction);
  return false;
}

/// Python delivers Ctrl-C to its main thread only.
bool is_asked(const py::object& progress) {
  const py::module_ threading = py::module_::import("threading");
  return !progress.is_none() || threading.attr("current_thread")().is(threading.attr("main_thread")());
}

void translate(std::exception_ptr thrown) {
  const auto raise = [](const char* kind, const std::exception& error) {
    const py::object type = py::module_::import("landfall.errors").attr(kind);
    PyErr_SetString(type.ptr(), error.what());
  };
  try {
    if (thrown) std::rethrow_exception(std::move(thrown));
  } catch (const UsageError& error) {
    raise("UsageError", error);
  } catch (const Error& error) {
    raise("DataError", error);
  }
}

}  // namespace

void bind_tools(py::module_& module, std::map<std::string, ToolProgram> tools) {
  // The tools end a process that has no memory left; Python raises MemoryError.
  std::set_new_handler(nullptr);
  py::register_local_exception_translator(translate);
  module.def(
      "run",
      [tools = std::move(tools)](const std::vector<std::string>& words, const std::string& standard_input,
                                 const py::object& progress) {
        bool interrupted = false;
        ToolResult result;
        WaitingFunction waiting;
        if (is_asked(progress))
          waiting = [&](const std::string& phase, double fraction) {
            return interrupted || ask_python(progress, phase, fraction, interrupted);
          };
        {
          const py::gil_scoped_release unlock;
          result = run_tool(tools.at(words.at(0)), {words, standard_input}, waiting);
        }
        if (interrupted) throw py::error_already_set();
        return std::tuple(result.code, result.message, result.warnings, result.printed);
      },
      py::arg("words"), py::arg("standard_input"), py::arg("progress"));
}

}  // namespace landfall::python
