// SPDX-License-Identifier: GPL-3.0-or-later
// The extension module of Python, which runs the tools as functions of its process: python/landfall/engine.py
// loads it.
#include "app/python/module.h"
#include "tools.h"

PYBIND11_MODULE(landfall_engine, module) {
  namespace bindings = landfall::python;
  bindings::bind_tools(module, {{"terrain-gen", landfall::terrain_gen::start},
                                {"scan-sim", landfall::scan_sim::start},
                                {"regrid", landfall::regrid::start},
                                {"dem-eval", landfall::dem_eval::start},
                                {"hazard-map", landfall::hazard_map::start},
                                {"monte-carlo", landfall::monte_carlo::start},
                                {"landfall-import", landfall::landfall_import::start},
                                {"landfall run", landfall::landfall_run::start}});
  bindings::bind_files(module);
  bindings::bind_arrays(module);
  bindings::bind_lidar(module);
}
