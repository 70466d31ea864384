# SPDX-License-Identifier: GPL-3.0-or-later
# Functions for the pages: what the setup comments (tests/docs/page.py) make smaller, the clone that a page names, and Python blocks.

# Figures are coarse unless the page says how fine, because nobody looks at their pixels.
coarse_landfall() {
  if [[ -z "$AS_SHOWN" && ${1-} == plot && $# -gt 2 ]]; then set -- plot "$2" --dpi 50 "${@:3}"; fi
  command landfall "$@"
}
landfall() { coarse_landfall "$@"; }

# As root, Chromium starts without its sandbox only.
chromium() { command chromium $([[ $EUID != 0 ]] || echo --no-sandbox) "$@"; }

# Makes terrain-gen's grid coarse, 0.5 m, and scan-sim simulate only 0.05 s, 1,000 pulses, by default.
short_scans() {
  terrain-gen() { command terrain-gen --set grid.resolution_m=0.5 "$@"; }
  scan-sim() { command scan-sim --set laser.scan_time_s=0.05 "$@"; }
}

# Makes the chain coarse: bins of 0.2 m, and a tenth of the pulses.
small_chain() {
  landfall() {
    if [[ $1 == run ]]; then set -- "$@" --set scan.laser.scan_time_s=0.2 --set area.resolution_m=0.2; fi
    coarse_landfall "$@"
  }
}

# Makes make print its commands to plan.txt instead of running them, because studies take minutes.
plan_only() {
  make() { command make -n "$@" > plan.txt; }
  landfall() {
    case "$1 ${2-}" in
      "plot study" | "study report") : ;;  # of what a study would have made
      "study list" | "study show" | "study prune") command landfall "$@" ;;
      "study "*) command landfall "$@" -n > plan.txt ;;
      *) command landfall "$@" ;;
    esac
  }
}

# Makes apt-get ask no questions; root needs no sudo.
quiet_apt() {
  [[ $EUID == 0 ]] || { echo "this block installs packages: run the page as root"; return 1; }
  printf 'APT::Get::Assume-Yes "true";\n' > /tmp/landfall-docs-apt.conf
  export APT_CONFIG=/tmp/landfall-docs-apt.conf DEBIAN_FRONTEND=noninteractive
  sudo() { "$@"; }
}

# Copies the files of the repository that make and the scripts use, and links this build to where a build puts it.
checkout() {
  cp -r "$LANDFALL_ROOT"/{CMakeLists.txt,Makefile.studies,bench,examples,python,schemas,scripts,studies,testdata} .
  mkdir -p build lib/app/report
  cp -r "$LANDFALL_ROOT/lib/app/report/web" lib/app/report/
  ln -s "$(dirname "$LANDFALL_BIN")" build/release
}

# Clones the repository and adds its uncommitted changes and the tools of this build, for blocks that build it.
clone() {
  git clone -q "$LANDFALL_ROOT" .
  git -C "$LANDFALL_ROOT" ls-files -z --cached --others --exclude-standard | tar -C "$LANDFALL_ROOT" --null -T - -c | tar -x
  mkdir -p build/release/lib
  cp -r "$LANDFALL_BIN" "$LANDFALL_BIN/../cmake_install.cmake" build/release
  cp -r "$LANDFALL_BIN/../lib/landfall" build/release/lib
}

# Runs the file of a Python block in the interpreter of the page, which the first block starts; what it prints is appended to a file.
python_block() {
  [ -n "${PYTHON_PID-}" ] || coproc PYTHON { exec python3 "$LANDFALL_ROOT/tests/docs/python_blocks.py"; }
  printf '%s\t%s\t%s\n' "$PWD" "$1" "$2" >&"${PYTHON[1]}"
  local code
  read -r code <&"${PYTHON[0]}" && [ "$code" = 0 ]
}

# Ends that interpreter before bash does, so that its temporary files are gone.
end_python() {
  [ -n "${PYTHON_PID-}" ] || return 0
  local input=${PYTHON[1]} pid=$PYTHON_PID
  exec {input}>&-
  wait "$pid" || true
}
trap end_python EXIT
