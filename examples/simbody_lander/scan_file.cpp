// SPDX-License-Identifier: GPL-3.0-or-later
#include "scan_file.h"

#include <hdf5.h>
#include <hdf5_hl.h>

#include <array>
#include <stdexcept>
#include <utility>

namespace lander {
namespace {

/// Closes what an HDF5 call has opened; throws if it failed.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
    if (id < 0) throw std::runtime_error(what);
  }
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void require(herr_t result, const std::string& what) {
  if (result < 0) throw std::runtime_error(what);
}

std::vector<double> read(hid_t file, const char* name, const std::string& path) {
  std::array<hsize_t, 2> size{0, 1};
  require(H5LTget_dataset_info(file, name, size.data(), nullptr, nullptr),
          path + ": no grid: no dataset " + name);
  std::vector<double> values(size[0] * size[1]);
  require(H5LTread_dataset_double(file, name, values.data()), path + ": cannot read " + name);
  return values;
}

template <class T>
void write_column(hid_t group, const std::string& name, const std::vector<T>& values) {
  const hid_t type = std::is_same_v<T, double> ? H5T_NATIVE_DOUBLE
                     : std::is_same_v<T, int>  ? H5T_NATIVE_INT
                                               : H5T_NATIVE_SCHAR;
  const hsize_t size = values.size();
  require(H5LTmake_dataset(group, name.c_str(), 1, &size, type, values.data()), "cannot write " + name);
}

void write_columns(hid_t group, const std::map<std::string, std::vector<double>>& columns) {
  for (const auto& [name, values] : columns) write_column(group, name, values);
}

Handle new_group(hid_t file, const char* name) {
  return {H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "cannot make a group"};
}

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
constexpr std::array<const char*, 4> kQuaternion = {"qw", "qx", "qy", "qz"};

}  // namespace

Heightfield read_terrain(const std::string& path) {
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose,
                    path + ": cannot be opened");
  const std::vector<double> x = read(file, "x", path), y = read(file, "y", path);
  const double step = (x.back() - x.front()) / static_cast<double>(x.size() - 1);
  return {{x.front(), y.front()}, step, static_cast<int>(x.size()), read(file, "z", path)};
}

void ScanFile::add(double t_s, const landfall::lidar::Pulse& pulse,
                   const landfall::lidar::PulseReturns& returns) {
  const int row = static_cast<int>(pulses_["t"].size());
  pulses_["t"].push_back(t_s);
  for (const auto& [suffix, pose] : {std::pair{"_true", pulse.truth}, std::pair{"_est", *pulse.estimate}}) {
    for (std::size_t i = 0; i < 3; ++i)
      pulses_[std::string("p") + kAxes[i] + suffix].push_back(pose.position_m[i]);
    for (std::size_t i = 0; i < 4; ++i)
      pulses_[std::string(kQuaternion[i]) + suffix].push_back(pose.attitude[i]);
  }
  std::array<std::vector<double>*, 6> columns{};
  for (std::size_t i = 0; i < 3; ++i) {
    columns[i] = &points_[std::string(kAxes[i]) + "_true"];
    columns[i + 3] = &points_[std::string(kAxes[i]) + "_est"];
  }
  for (const landfall::lidar::PixelReturn& pixel : returns.pixels) {
    if (pixel.status != landfall::lidar::Status::returned) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      columns[i]->push_back(pixel.true_m[i]);
      columns[i + 3]->push_back(pixel.estimated_m[i]);
    }
    pulse_.push_back(row);
    pixel_.push_back(pixel.pixel);
    status_.push_back(static_cast<signed char>(pixel.status));
  }
}

void ScanFile::write(const std::string& path) const {
  const Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose,
                    path + ": cannot be written");
  const Handle pulses = new_group(file, "pulses"), points = new_group(file, "points");
  write_columns(pulses, pulses_);
  write_columns(points, points_);
  write_column(points, "pulse", pulse_);
  write_column(points, "pixel", pixel_);
  write_column(points, "status", status_);
  const int complete = 1;
  require(H5LTset_attribute_string(file, "/", "format_name", "landfall.scan"), path);
  require(H5LTset_attribute_string(file, "/", "format_version", "1.0"), path);
  require(H5LTset_attribute_int(file, "/", "complete", &complete, 1), path);
}

}  // namespace lander
