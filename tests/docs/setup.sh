# SPDX-License-Identifier: GPL-3.0-or-later
# Functions for the setup comments of the pages (tests/docs/page.py), and for their Python blocks.

# Figures are coarse unless the page says how fine, because nobody looks at their pixels.
for plot in "$LANDFALL_ROOT"/python/commands/plot_*.py; do
  eval "${plot##*/}() { command ${plot##*/} --dpi 50 \"\$@\"; }"
done

# Makes a coarse terrain.h5 of flat terrain with three cones.
small_terrain() {
  command terrain-gen -o "${1:-terrain.h5}" --half-width 60 --resolution 0.5 --set 'patterns=[{"type":"ring","count":3,
    "radius_m":20,"feature":{"type":"cone","radius_m":3,"height_m":2}}]'
}

# Makes scan-sim simulate only 0.05 s, 1,000 pulses, by default.
short_scans() {
  scan-sim() { command scan-sim --set laser.scan_time_s=0.05 "$@"; }
}

# Makes regrid use 10 x 10 m in bins of 10 cm, and dem-eval a region of 4 m, by default.
small_maps() {
  regrid() { command regrid --set half_width_m=5 --set resolution_m=0.1 -t 0 "$@"; }
  dem-eval() { command dem-eval --set region_radius_m=4 -t 0 "$@"; }
}

# Copies the files of the repository that make and the scripts use, and links the tools to where a build puts them.
checkout() {
  cp -r "$LANDFALL_ROOT"/{Makefile.studies,bench,examples,python,schemas,scripts,studies} .
  mkdir -p build/release lib/app/report
  cp -r "$LANDFALL_ROOT/lib/app/report/web" lib/app/report/
  ln -s "$LANDFALL_BIN" build/release/bin
}

# Clones the repository and adds its uncommitted changes, for blocks that build it.
clone() {
  git clone -q "$LANDFALL_ROOT" .
  git -C "$LANDFALL_ROOT" ls-files -z --cached --others --exclude-standard | tar -C "$LANDFALL_ROOT" --null -T - -c | tar -x
}

# Makes apt-get ask no questions; root needs no sudo.
quiet_apt() {
  [[ $EUID == 0 ]] || { echo "this block installs packages: run the page as root"; return 1; }
  printf 'APT::Get::Assume-Yes "true";\n' > apt.conf
  export APT_CONFIG=$PWD/apt.conf DEBIAN_FRONTEND=noninteractive
  sudo() { "$@"; }
}

# Makes small files of the chain, terrain.h5 scan.h5 dem.h5 eval.h5 metrics.json: 10 x 10 m in bins of 10 cm.
small_chain() {
  command terrain-gen -o terrain.h5 --half-width 8 --resolution 0.1 \
    --set 'features=[{"type":"cone","x_m":2,"y_m":1,"radius_m":1,"height_m":0.4},{"type":"rock","x_m":-2,"diameter_m":1}]'
  command scan-sim --terrain terrain.h5 -o scan.h5 --set laser.scan_time_s=0.05 \
    --set scanner.pattern='{"type":"line_search","rows":20,"columns":50,"half_width_m":6}' --set noise.range_sigma_m=0.01
  command regrid scan.h5 --terrain terrain.h5 -o dem.h5 --set half_width_m=5 --set resolution_m=0.1
  command dem-eval dem.h5 -o eval.h5 --metrics metrics.json --set region_radius_m=4
}

# Makes make print its commands to plan.txt instead of running them, because studies take minutes.
plan_only() {
  make() { command make -n "$@" > plan.txt; }
}

# Runs the file of a Python block in the interpreter of the page, which the first block starts; what it prints is appended to a file.
python_block() {
  [ -n "${PYTHON_PID-}" ] || coproc PYTHON { exec python3 "$LANDFALL_ROOT/tests/docs/python_blocks.py"; }
  printf '%s\t%s\t%s\n' "$PWD" "$1" "$2" >&"${PYTHON[1]}"
  local code
  read -r code <&"${PYTHON[0]}" && [ "$code" = 0 ]
}
