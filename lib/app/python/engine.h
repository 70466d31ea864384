// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

/// The functions of liblandfall.so that python/landfall/engine.py calls: conversion and lifetime. Arrays are
/// checked and converted in Python (float64, C order), so that each function takes only what it can use; an
/// array is given by its first value, null if there is none.
///
/// A function returns null, or false, if it fails; landfall_failure() says why. A text that one returns lives
/// until the next call of its thread, an object until landfall_delete(). Calls may come from any thread.
namespace landfall::python {

/// An object that landfall_new_...() made.
class Object {
 public:
  Object() = default;
  virtual ~Object() = default;
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;
};

/// The object as the type that it has. Throws std::bad_cast.
template <class Type>
Type& as(Object* object) {
  return dynamic_cast<Type&>(*object);
}

/// Runs work, and keeps the failure of what it throws; false if it throws.
bool succeeds(const std::function<void()>& work);
/// The text of this thread that `make` returns; null if it throws.
const char* text_of(const std::function<std::string()>& make);
/// The object that `make` returns; null if it throws.
Object* object_of(const std::function<Object*()>& make);

extern "C" {

/// Gets the library ready for a process of Python. Fails if its HDF5 was not built for threads.
bool landfall_start();
/// Why the last call of this thread failed; `kind` becomes "DataError" or "UsageError" of landfall.errors,
/// "MemoryError" or "RuntimeError" of Python.
const char* landfall_failure(const char** kind);
void landfall_delete(Object* object);

/// A run of a tool: `words` are the command line from the name of the tool on.
Object* landfall_new_run(const char* const* words, std::size_t count, const char* standard_input,
                         std::size_t size);
/// Runs it, on this thread. Runs of several threads go side by side; each file has one writer, and no reader
/// before that has ended.
bool landfall_run_start(Object* run);
/// From another thread meanwhile: the phase that is running, "" before the first, and its fraction done.
const char* landfall_run_phase(Object* run, double* fraction);
/// Ends the run at its next step, within about 0.1 s.
bool landfall_run_cancel(Object* run);
/// JSON: [exit code, message of an error without the tool's name, [warning, ...], text of standard output].
const char* landfall_run_result(Object* run);

/// A file in memory (store/hdf5/memory_file.h).
Object* landfall_new_file(const char* name);
bool landfall_file_load(Object* file, const char* path);
bool landfall_file_save(Object* file, const char* path, bool overwrite);
/// JSON: [[name, whether it is a group], ...] of a group, as they were created.
const char* landfall_file_members(Object* file, const char* group);
/// JSON: {name: text, or {"type", "shape", "bytes"}} of an object.
const char* landfall_file_attributes(Object* file, const char* path);
/// The content of a dataset, which may outlive the file.
Object* landfall_new_values(Object* file, const char* path);
/// JSON: text, or {"type", "shape", "address"}.
const char* landfall_values(Object* values);

/// Writes a terrain of rows * cols elevations, south to north, into memory; its node at half of its rows and
/// columns is the origin, at `center` (x and y, or longitude and latitude) of `crs` unless that is empty.
bool landfall_write_terrain(const char* name, const double* z, std::int64_t rows, std::int64_t cols,
                            double resolution_m, const char* crs, const double* center);
/// Writes points without a lidar, as landfall-import does, into memory.
bool landfall_write_points(const char* name, std::size_t count, const double* x, const double* y,
                           const double* z);

/// A terrain.h5, or the name of a file in memory, that answers questions.
Object* landfall_new_surface(const char* file);
/// z_m gets the highest elevations, NaN off the terrain; frame D.
bool landfall_surface_elevation(Object* surface, std::size_t count, const double* x_m, const double* y_m,
                                double* z_m, std::size_t threads);
/// Origins and unit directions of shape (count, 3), frame D; a range is NaN where the ray misses.
bool landfall_surface_first_hit(Object* surface, std::size_t count, const double* origins,
                                const double* directions, double* ranges_m, std::size_t threads);

/// Pulses of a lidar. Poses are rows of x, y, z, then w, x, y, z; estimates, nominals and t_s may be null.
struct PulseArrays {
  std::size_t count;
  const std::int64_t* numbers;
  const double *truth, *estimates, *nominals;
  const double* t_s;
};

/// The lidar within a simulation (app/host/lidar.h), of scan-sim's configuration. Without a surface Python
/// traces its rays.
Object* landfall_new_lidar(const char* config, Object* surface);
/// JSON: {"pulse_rate_hz", "pixel_count", "pulse_limit", "record"}; the record is numpy's type of a pixel.
const char* landfall_lidar(Object* lidar);
/// The rays of the first pulse of a lidar without a surface.
Object* landfall_new_rays(Object* lidar, const PulseArrays* pulse);
/// JSON as of landfall_values(): origins, metres, and directions, frame D, of shape (count, 2, 3).
const char* landfall_rays(Object* rays);
/// `records` gets count * pixels records. A lidar without a surface takes one pulse, and the ranges of its
/// rays.
bool landfall_lidar_pulses(Object* lidar, const PulseArrays* pulses, const double* ranges_m, void* records,
                           std::size_t threads);
}

}  // namespace landfall::python
