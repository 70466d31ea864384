// SPDX-License-Identifier: GPL-3.0-or-later
// A descent in Simbody with landfall's lidar: writes the returns as scan.h5 and the motion as flight.csv.
// With a site of the map the same flight lands on it.
//   simbody_lander terrain.h5 scan.json scan.h5 flight.csv [--seed N] [--perfect] [--frozen] [--site X,Y,Z]
#include <cmath>
#include <cstdint>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "flight.h"
#include "lidar_host.h"
#include "scan_file.h"

namespace lander {
namespace {

constexpr double kScanAltitude_m = 500;

struct Options {
  std::vector<std::string> files;  ///< terrain, configuration, scan, motion
  Knowledge knowledge = Knowledge::filter;
  FlightPlan plan;
  std::optional<Vector3d> site_m;
};

constexpr const char* kUsage =
    "usage: simbody_lander terrain.h5 scan.json scan.h5 flight.csv [--seed N] [--perfect] [--frozen] "
    "[--site X,Y,Z]";

Vector3d site_of(const std::string& text) {
  std::istringstream in(text);
  Vector3d site;
  char comma_1 = 0, comma_2 = 0;
  in >> site.x() >> comma_1 >> site.y() >> comma_2 >> site.z();
  if (!in || !(in >> std::ws).eof() || comma_1 != ',' || comma_2 != ',')
    throw std::invalid_argument("--site: " + text + " is not X,Y,Z in metres");
  return site;
}

/// The propellant is part of the bus.
void freeze(FlightPlan& plan) {
  plan.design.tanks.swing = false;
  plan.start.slosh_rad.assign(2, {0, 0});
}

Options options_of(const std::vector<std::string>& arguments) {
  Options options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--perfect")
      options.knowledge = Knowledge::truth;
    else if (arguments[i] == "--frozen")
      freeze(options.plan);
    else if (arguments[i] == "--seed" && i + 1 < arguments.size())
      options.plan.seed = std::stoull(arguments[++i]);
    else if (arguments[i] == "--site" && i + 1 < arguments.size())
      options.site_m = site_of(arguments[++i]);
    else
      options.files.push_back(arguments[i]);
  }
  if (options.files.size() != 4) throw std::invalid_argument(kUsage);
  return options;
}

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be opened");
  return {std::istreambuf_iterator<char>(file), {}};
}

/// One row per period: the true motion, the error of the estimate (true - estimated), its sigmas.
class MotionLog {
 public:
  explicit MotionLog(const std::string& path) : out_(path) {
    out_.precision(12);
    out_ << "t,x,y,z,vx,vy,vz,tilt_x,tilt_y,yaw,slosh_1x,slosh_1y,slosh_2x,slosh_2y,leg_1,thrust,torque_x,"
            "torque_y,torque_z";
    for (const char* kind : {"error", "sigma"})
      for (const char* state : {"x", "y", "z", "vx", "vy", "vz", "rx", "ry", "rz"})
        out_ << ',' << kind << '_' << state;
    out_ << '\n';
  }

  void write(const Flight& flight) {
    const BusState truth = flight.body().bus(), &estimate = flight.filter().estimate();
    out_ << flight.t_s();
    put(truth.position_m);
    put(truth.velocity_mps);
    put(rotation_vector(truth.attitude));
    for (const Vector2d& tank : flight.body().slosh_rad()) out_ << ',' << tank.x() << ',' << tank.y();
    out_ << ',' << flight.body().legs_rad().front() << ',' << flight.controls().thrust_n;
    put(flight.controls().torque_nm);
    put(truth.position_m - estimate.position_m);
    put(truth.velocity_mps - estimate.velocity_mps);
    put(rotation_vector(estimate.attitude.conjugate() * truth.attitude));
    for (int i = 0; i < 9; ++i) out_ << ',' << std::sqrt(flight.filter().covariance()(i, i));
    out_ << '\n';
  }

  [[nodiscard]] bool complete() { return static_cast<bool>(out_.flush()); }

 private:
  void put(const Vector3d& v) { out_ << ',' << v.x() << ',' << v.y() << ',' << v.z(); }

  std::ofstream out_;
};

class Scan {
 public:
  Scan(const landfall::lidar::Instrument& instrument, Knowledge knowledge)
      : instrument_(instrument), knowledge_(knowledge), pulse_limit_(instrument.pulse_limit().value()) {}

  [[nodiscard]] bool done() const { return next_ >= pulse_limit_; }

  void advance(Flight& flight, double start_s, double period_s) {
    std::vector<double> times;
    const double end = flight.t_s() + period_s;
    for (std::int64_t pulse = next_; pulse < pulse_limit_ && time_of(start_s, pulse) < end - 1e-9; ++pulse)
      times.push_back(time_of(start_s, pulse));
    const std::vector<PoseSample> poses = flight.advance(times);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const landfall::lidar::Pulse pulse = pulse_of(next_++, poses[i], knowledge_);
      instrument_.step(pulse, returns_);
      file_.add(times[i], pulse, returns_);
    }
  }

  [[nodiscard]] const ScanFile& file() const { return file_; }

 private:
  [[nodiscard]] double time_of(double start_s, std::int64_t pulse) const {
    return start_s + static_cast<double>(pulse) / instrument_.pulse_rate_hz();
  }

  const landfall::lidar::Instrument& instrument_;
  Knowledge knowledge_;
  std::int64_t pulse_limit_;
  std::int64_t next_ = 0;
  landfall::lidar::PulseReturns returns_;
  ScanFile file_;
};

/// Flies on until the feet of the upright lander reach the ground below it.
void land(Flight& flight, const Vector3d& site_m, const Heightfield& ground, double standing_m,
          MotionLog& log) {
  flight.land_at(site_m);
  double height_m = 0;
  do {
    flight.advance();
    log.write(flight);
    const Vector3d p = flight.body().bus().position_m;
    height_m = ground.range_m({p.x(), p.y(), p.z()}, {0, 0, -1});
    if (!std::isfinite(height_m)) throw std::runtime_error("the lander left the terrain");
  } while (height_m > standing_m);
  const BusState touchdown = flight.body().bus();
  std::cout << "landed at " << touchdown.position_m.x() << ", " << touchdown.position_m.y() << " m after "
            << flight.t_s() << " s, " << -touchdown.velocity_mps.z() << " m/s down\n";
}

void run(const Options& options) {
  const Heightfield ground = read_terrain(options.files[0]);
  const landfall::lidar::Instrument instrument(text_of(options.files[1]), scene_of(ground), options.files[1]);
  if (!instrument.pulse_limit())
    throw std::runtime_error(options.files[1] + ": the pattern must end: at_end stop");
  Flight flight(options.plan, [&ground](const Vector3d& p, const Vector3d& d) {
    return ground.range_m({p.x(), p.y(), p.z()}, {d.x(), d.y(), d.z()});
  });
  MotionLog log(options.files[3]);
  log.write(flight);
  while (flight.filter().estimate().position_m.z() > kScanAltitude_m) {
    flight.advance();
    log.write(flight);
  }
  Scan scan(instrument, options.knowledge);
  for (const double start_s = flight.t_s(); !scan.done(); log.write(flight))
    scan.advance(flight, start_s, options.plan.period_s);
  scan.file().write(options.files[2]);
  std::cout << scan.file().return_count() << " returns, " << flight.t_s() << " s\n";
  if (options.site_m) land(flight, *options.site_m, ground, options.plan.design.standing_m(), log);
  if (!log.complete()) throw std::runtime_error(options.files[3] + ": cannot be written");
}

}  // namespace
}  // namespace lander

int main(int argc, char** argv) {
  try {
    lander::run(lander::options_of({argv + 1, argv + argc}));
    return 0;
  } catch (const std::invalid_argument& error) {
    std::cerr << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "simbody_lander: " << error.what() << '\n';
    return 1;
  }
}
