// SPDX-License-Identifier: GPL-3.0-or-later
// A host simulator in small: it moves the lander and holds the scene; landfall's lidar asks it where rays
// hit.
//   host_simulator scan.json returns.csv [height of the cone, m]
#include <landfall/lidar.h>

#include <cmath>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <string>

namespace {

namespace lidar = landfall::lidar;

/// The plane z = 0 with a cone on it.
class Scene {
 public:
  explicit Scene(double height_m) : height_m_(height_m) {}

  /// Metres along the ray; NaN where it meets nothing.
  double operator()(const lidar::Ray& ray) const {
    const double cone = height_m_ > 0 ? to_cone(ray) : kMiss;
    return std::isnan(cone) ? to_plane(ray) : cone;
  }

 private:
  static constexpr double kMiss = std::numeric_limits<double>::quiet_NaN();
  static constexpr double kX = 1, kY = 0.5, kRadius = 1.5;

  static double to_plane(const lidar::Ray& ray) {
    const double range = -ray.origin_m[2] / ray.direction[2];
    return range >= 0 ? range : kMiss;
  }

  /// The nearer root of (x - kX)^2 + (y - kY)^2 = s^2 (z - height)^2, s = radius/height, between 0 and the
  /// tip.
  double to_cone(const lidar::Ray& ray) const {
    const double s = kRadius / height_m_;
    const auto& d = ray.direction;
    const double x = ray.origin_m[0] - kX, y = ray.origin_m[1] - kY, z = ray.origin_m[2] - height_m_;
    const double a = d[0] * d[0] + d[1] * d[1] - s * s * d[2] * d[2];
    const double half_b = x * d[0] + y * d[1] - s * s * z * d[2];
    const double c = x * x + y * y - s * s * z * z;
    const double root = std::sqrt(half_b * half_b - a * c);  // NaN: the ray passes beside it
    double nearest = kMiss;
    for (const double range : {(-half_b - root) / a, (-half_b + root) / a}) {
      const double at = ray.origin_m[2] + range * d[2];
      if (range >= 0 && at >= 0 && at <= height_m_) nearest = std::fmin(nearest, range);
    }
    return nearest;
  }

  double height_m_;
};

/// The host's own motion: it falls at 5 m/s, drifts, and rolls by 2 deg/s.
lidar::Pose pose_at(double t_s) {
  const double half_roll = 0.5 * 2 * t_s * std::acos(-1.0) / 180;
  return {.position_m = {0.5 + 0.4 * t_s, -0.3 + 0.2 * t_s, 50 - 5 * t_s},
          .attitude = {std::cos(half_roll), std::sin(half_roll), 0, 0}};
}

std::string text_of(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write(std::ostream& out, std::int64_t pulse, const lidar::PixelReturn& r) {
  out << pulse << ',' << r.pixel << ',' << static_cast<int>(r.status) << ',' << r.range_true_m << ','
      << r.range_measured_m;
  for (const double value : r.true_m) out << ',' << value;
  for (const double value : r.estimated_m) out << ',' << value;
  out << '\n';
}

int run(const char* config, const char* output, double cone_height_m) {
  const lidar::Instrument instrument(text_of(config), Scene(cone_height_m), config);
  std::ofstream out(output);
  out.precision(17);
  out << "pulse,pixel,status,range_true,range_measured,x_true,y_true,z_true,x_est,y_est,z_est\n";
  lidar::PulseReturns returns;
  for (std::int64_t pulse = 0; pulse < 400; ++pulse) {
    // The lander believes what the configuration's navigation error leaves it; a host with a filter of its
    // own gives .estimate too.
    instrument.step(
        {.number = pulse, .truth = pose_at(static_cast<double>(pulse) / instrument.pulse_rate_hz())},
        returns);
    for (const lidar::PixelReturn& pixel : returns.pixels) write(out, pulse, pixel);
  }
  return out.flush() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: host_simulator scan.json returns.csv [height of the cone, m]\n";
    return 2;
  }
  try {
    return run(argv[1], argv[2], argc > 3 ? std::stod(argv[3]) : 0);
  } catch (const std::exception& error) {
    std::cerr << "host_simulator: " << error.what() << '\n';
    return 1;
  }
}
