// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <memory>
#include <utility>

#include "app/host/lidar.h"
#include "app/python/module.h"
#include "app/runs/scene.h"
#include "base/core/error.h"
#include "base/core/parallel.h"

namespace landfall::python {
namespace {

namespace py = pybind11;
using Numbers = py::array_t<double, py::array::c_style>;

constexpr std::size_t kRaysAtOnce = 324;  // engines are tuned for the rays of one pulse

/// Calls work(begin, end) on all threads, or on as many as are asked for.
void on_threads(std::size_t count, std::size_t grain, std::size_t threads,
                const std::function<void(std::size_t, std::size_t)>& work) {
  const ThreadLimit limit(threads);
  parallel_for(count, grain, work);
}

/// A terrain that answers questions; from any thread.
class Surface {
 public:
  /// A terrain.h5, or the name of a file in memory.
  explicit Surface(const std::string& file) {
    const py::gil_scoped_release unlock;
    scene_ = open_scene({.terrain = file});
  }

  [[nodiscard]] Numbers elevation(const Numbers& x_m, const Numbers& y_m, std::size_t threads) const {
    Numbers z_m(x_m.size());
    const double *const x = x_m.data(), *const y = y_m.data();
    double* const z = z_m.mutable_data();
    const py::gil_scoped_release unlock;
    on_threads(static_cast<std::size_t>(x_m.size()), 4096, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) z[i] = scene_.surface->elevation(x[i], y[i]);
    });
    return z_m;
  }

  /// The arrays have the shape (N, 3), metres and unit vectors, frame D; a range is NaN where the ray misses.
  [[nodiscard]] Numbers first_hit(const Numbers& origins, const Numbers& directions,
                                  std::size_t threads) const {
    const auto count = static_cast<std::size_t>(origins.shape(0));
    Numbers ranges_m(origins.shape(0));
    const double *const from = origins.data(), *const along = directions.data();
    const std::span ranges(ranges_m.mutable_data(), count);
    const py::gil_scoped_release unlock;
    on_threads(count, kRaysAtOnce, threads, [&](std::size_t begin, std::size_t end) {
      std::vector<Ray> rays(end - begin);
      for (std::size_t i = begin; i < end; ++i)
        rays[i - begin] = {{{from[3 * i], from[3 * i + 1], from[3 * i + 2]}},
                           {{along[3 * i], along[3 * i + 1], along[3 * i + 2]}}};
      scene_.engine->first_hits(rays, ranges.subspan(begin, end - begin));
    });
    return ranges_m;
  }

  [[nodiscard]] std::shared_ptr<const RayEngine> engine() const { return scene_.engine; }

 private:
  Scene scene_;
};

landfall::Ray ray_of(const lidar::Ray& ray) {
  const auto& [x, y, z] = ray.origin_m;
  const auto& [a, b, c] = ray.direction;
  return {{{x, y, z}}, {{a, b, c}}};
}

lidar::IntersectAll traced_by(std::shared_ptr<const RayEngine> engine) {
  return [engine = std::move(engine)](std::span<const lidar::Ray> rays, std::span<double> ranges_m) {
    thread_local std::vector<landfall::Ray> own;
    own.clear();
    for (const lidar::Ray& ray : rays) own.push_back(ray_of(ray));
    engine->first_hits(own, ranges_m);
  };
}

/// Calls Python's function with arrays of shape (N, 3).
lidar::IntersectAll traced_by(py::function trace) {
  const auto held = std::make_shared<py::function>(std::move(trace));
  return [held](std::span<const lidar::Ray> rays, std::span<double> ranges_m) {
    const py::gil_scoped_acquire lock;
    const auto count = static_cast<py::ssize_t>(rays.size());
    Numbers origins({count, py::ssize_t{3}}), directions({count, py::ssize_t{3}});
    for (std::size_t i = 0; i < rays.size(); ++i) {
      std::ranges::copy(rays[i].origin_m, origins.mutable_data() + 3 * i);
      std::ranges::copy(rays[i].direction, directions.mutable_data() + 3 * i);
    }
    const auto found = Numbers::ensure((*held)(origins, directions));
    if (!found) {
      PyErr_Clear();
      throw UsageError("terrain: the function returned no numbers");
    }
    if (found.ndim() != 1 || found.size() != count)
      throw UsageError("terrain: the function returned " + std::to_string(found.size()) + " ranges of " +
                       std::to_string(count) + " rays");
    std::copy_n(found.data(), count, ranges_m.begin());
  };
}

/// One pixel at one pulse: lidar::PixelReturn as a record of numpy.
py::dtype pixel_dtype() {
  using Pixel = lidar::PixelReturn;
  py::list names, formats, offsets;
  const auto add = [&](const char* name, const py::object& format, std::size_t offset) {
    names.append(name);
    formats.append(format);
    offsets.append(offset);
  };
  const auto real = py::dtype::of<double>();
  const py::object vector = py::make_tuple(real, py::make_tuple(3));
  add("pixel", py::dtype::of<std::int32_t>(), offsetof(Pixel, pixel));
  add("status", py::dtype::of<std::int8_t>(), offsetof(Pixel, status));
  add("range_true_m", real, offsetof(Pixel, range_true_m));
  add("range_measured_m", real, offsetof(Pixel, range_measured_m));
  add("true_m", vector, offsetof(Pixel, true_m));
  add("estimated_m", vector, offsetof(Pixel, estimated_m));
  return {names, formats, offsets, sizeof(Pixel)};
}

/// Rows of x, y, z, then w, x, y, z of poses; without rows for none.
using Poses = Numbers;

std::optional<lidar::Pose> pose_in(const double* row) {
  if (row == nullptr) return std::nullopt;
  return lidar::Pose{{row[0], row[1], row[2]}, {row[3], row[4], row[5], row[6]}};
}

/// Pulses as arrays of one length; of those that are not given, the arrays are empty.
struct PulseArrays {
  py::array_t<std::int64_t, py::array::c_style> numbers;
  Poses truth, estimate, nominal;
  Numbers t_s;
};

class Lidar {
 public:
  Lidar(const std::string& config, std::shared_ptr<const RayEngine> engine)
      : instrument_(config, traced_by(std::move(engine)), kName) {}
  Lidar(const std::string& config, py::function trace)
      : instrument_(config, traced_by(std::move(trace)), kName), traces_in_python_(true) {}

  [[nodiscard]] double pulse_rate_hz() const { return instrument_.pulse_rate_hz(); }
  [[nodiscard]] std::size_t pixel_count() const { return instrument_.pixel_count(); }
  [[nodiscard]] std::optional<std::int64_t> pulse_limit() const { return instrument_.pulse_limit(); }

  /// Records of shape (pulses, pixels).
  [[nodiscard]] py::array pulses(const PulseArrays& given, std::size_t threads) const {
    const auto count = static_cast<std::size_t>(given.numbers.size());
    const std::size_t pixels = pixel_count();
    py::array records(pixel_dtype(), std::vector<py::ssize_t>{static_cast<py::ssize_t>(count),
                                                              static_cast<py::ssize_t>(pixels)});
    auto* const out = static_cast<lidar::PixelReturn*>(records.mutable_data());
    const auto row = [](const Poses& poses, std::size_t i) {
      return poses.size() == 0 ? nullptr : poses.data() + 7 * i;
    };
    const auto step = [&](std::size_t i, lidar::PulseReturns& returns) {
      lidar::Pulse pulse{.number = given.numbers.data()[i],
                         .truth = *pose_in(row(given.truth, i)),
                         .estimate = pose_in(row(given.estimate, i)),
                         .nominal = pose_in(row(given.nominal, i))};
      if (given.t_s.size() > 0) pulse.since_start_s = given.t_s.data()[i];
      instrument_.step(pulse, returns);
      std::ranges::copy(returns.pixels, out + i * pixels);
    };
    const py::gil_scoped_release unlock;
    lidar::PulseReturns returns;
    if (traces_in_python_ || count == 1)
      for (std::size_t i = 0; i < count; ++i) step(i, returns);
    else
      on_threads(count, 16, threads, [&](std::size_t begin, std::size_t end) {
        lidar::PulseReturns own;
        for (std::size_t i = begin; i < end; ++i) step(i, own);
      });
    return records;
  }

 private:
  static constexpr const char* kName = "the configuration";
  lidar::Instrument instrument_;
  bool traces_in_python_ = false;
};

}  // namespace

void bind_lidar(py::module_& module) {
  py::class_<Surface, std::shared_ptr<Surface>>(module, "Surface")
      .def(py::init<const std::string&>())
      .def("elevation", &Surface::elevation)
      .def("first_hit", &Surface::first_hit);
  py::class_<Lidar, std::shared_ptr<Lidar>>(module, "Lidar")
      .def(py::init([](const std::string& config, const Surface& surface) {
        return std::make_shared<Lidar>(config, surface.engine());
      }))
      .def(py::init<const std::string&, py::function>())
      .def_property_readonly("pulse_rate_hz", &Lidar::pulse_rate_hz)
      .def_property_readonly("pixel_count", &Lidar::pixel_count)
      .def_property_readonly("pulse_limit", &Lidar::pulse_limit)
      .def("pulses", [](const Lidar& lidar, py::array_t<std::int64_t, py::array::c_style> numbers,
                        Poses truth, Poses estimate, Poses nominal, Numbers t_s, std::size_t threads) {
        return lidar.pulses(
            {std::move(numbers), std::move(truth), std::move(estimate), std::move(nominal), std::move(t_s)},
            threads);
      });
}

}  // namespace landfall::python
