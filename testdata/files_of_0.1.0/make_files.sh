#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the files of this folder, whose texts have a variable length and which have no seal. Run it with the tools of
# version 0.1.0, or of revision c8c8e49:
#   LANDFALL_BIN=.../bin testdata/files_of_0.1.0/make_files.sh
set -euo pipefail
cd "$(dirname "$0")"
export PATH="$LANDFALL_BIN:$PATH"

printf 'v -9 -9 0\nv 9 -9 0\nv 0 9 1\nf 1 2 3\n' > mesh.obj
terrain-gen -q -O -o terrain.h5 --set 'grid={"half_width_m": 2, "resolution_m": 0.25}' \
  --set 'features=[{"type": "hemisphere", "x_m": 0.2, "y_m": 0.1, "radius_m": 0.5}]'
terrain-gen -q -O -o mesh.h5 --from mesh.obj
lidar=(--seed 6 --set 'detector={"rows": 4, "columns": 4, "ifov_rad": 0.005}' --set 'laser={"pulse_rate_hz": 1000, "scan_time_s": 0.04}'
       --set 'scanner.pattern={"type": "line_search", "rows": 5, "columns": 8, "half_width_m": 1.2}'
       --set 'trajectory={"type": "constant_velocity", "position_m": [0, 0, 50]}' --set noise.range_sigma_m=0.01)
scan-sim -q -O -o scan.h5 --terrain terrain.h5 "${lidar[@]}"
scan-sim -q -O -o plan.h5 --plan --plan-radius 1 "${lidar[@]}"
regrid -q -O -o dem.h5 scan.h5 --terrain terrain.h5 --set half_width_m=1 --set resolution_m=0.25
dem-eval -q -O -o eval.h5 dem.h5 --set region_radius_m=0.5
rm mesh.obj
