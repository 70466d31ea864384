# SPDX-License-Identifier: GPL-3.0-or-later
# `cpack -G DEB` makes two Debian packages: landfall, and landfall-dev for host simulators. It needs dpkg-dev, which finds the
# libraries that the programs depend on. scripts/package does all of it.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME landfall)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "landfall maintainers <maintainers@landfall.example>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "simulated scanning lidar for planetary landing")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL tools lidar)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_SOURCE_DIR}/cmake/DebianFiles.cmake)
set(CPACK_LANDFALL_PACKAGING ${CMAKE_SOURCE_DIR}/packaging)
set(CPACK_LANDFALL_STRIP ${CMAKE_STRIP})

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME landfall)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
list(APPEND CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR}/lib/landfall)  # liblandfall.so
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS python3)  # and what DebianFiles.cmake finds
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS
    "make, python3-h5py, python3-matplotlib, python3-numpy, python3-pandas, python3-xarray")
set(CPACK_DEBIAN_TOOLS_PACKAGE_CONTROL_EXTRA ${CMAKE_SOURCE_DIR}/packaging/postinst ${CMAKE_SOURCE_DIR}/packaging/prerm)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS
    "gdal-bin, landfall-dev, pocl-opencl-icd | opencl-icd, python3-openturns, python3-optuna")
set(CPACK_DEBIAN_TOOLS_DESCRIPTION "landfall simulates a lander's scanning lidar, builds the digital elevation
model (DEM) that its hazard detector would see, and judges it against landing
requirements. terrain-gen makes or imports a terrain, scan-sim scans it, regrid
makes a DEM of the scan, dem-eval compares that DEM with the truth,
hazard-map finds safe places to land on it, and monte-carlo draws the errors of
a scan many times. The files between them are HDF5.")

set(CPACK_DEBIAN_LIDAR_PACKAGE_NAME landfall-dev)
set(CPACK_DEBIAN_LIDAR_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIDAR_PACKAGE_DEPENDS "libhwy-dev, pkg-config")
set(CPACK_DEBIAN_LIDAR_PACKAGE_SUGGESTS "cmake, landfall")
set(CPACK_DEBIAN_LIDAR_DESCRIPTION "landfall simulates a lander's scanning lidar, builds the digital elevation
model that its hazard detector would see, and judges it against landing
requirements. This package holds the lidar alone: one header, a static archive
and the files by which CMake finds them, so that another simulator can step it
pulse by pulse over its own scene.")
include(CPack)
