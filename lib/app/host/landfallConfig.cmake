# SPDX-License-Identifier: GPL-3.0-or-later
# find_package(landfall) gives landfall::lidar.
include(CMakeFindDependencyMacro)
find_dependency(PkgConfig)
pkg_check_modules(landfall_hwy REQUIRED IMPORTED_TARGET GLOBAL libhwy)
include(${CMAKE_CURRENT_LIST_DIR}/landfallTargets.cmake)
