// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <map>
#include <string>

#include "app/python/tool_run.h"

/// The parts of python/landfall/memory.py: conversion and lifetime. Arrays are checked and converted there
/// (float64, C order), so that each function here takes only what it can use. Errors of landfall become
/// UsageError and DataError of landfall.errors. The GIL is released while the library computes.
namespace landfall::python {

/// Adds run(words, standard_input, progress) -> (exit code, message, warnings, printed text).
void bind_tools(pybind11::module_& module, std::map<std::string, ToolProgram> tools);
/// Adds File, a file in memory.
void bind_files(pybind11::module_& module);
/// Adds write_terrain(name, z, resolution_m, crs, center) and write_points(name, x, y, z), which make files
/// in memory.
void bind_arrays(pybind11::module_& module);
/// Adds Surface, a terrain that answers questions, and Lidar, the lidar within a simulation.
void bind_lidar(pybind11::module_& module);

}  // namespace landfall::python
