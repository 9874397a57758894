#!/bin/sh
# Measures against peers: sh bench/run.sh dynamics|harmonics|elastic|body_modes|face|honesty|scenes|as_built|hunting|part_load|rows|many|valley|all|doc
# Sets up first where needed. Prints Markdown; results/bench/ gets it too, with CSV and pictures.
# `doc` puts the latest tables into bench/measured and doc/accuracy.md. `all` takes a quarter of an hour.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/app/setup.sh"
programs=$root/bench/build/programs
mkdir -p "$run_dir" "$programs" || exit

# need PROGRAM PACKAGE: installs a Debian package unless its program, or a file of it, is there.
need() {
  if command -v "$1" >/dev/null || [ -e "$1" ]; then return; fi
  as_root=
  [ "$(id -u)" = 0 ] || as_root=sudo
  quietly "looking for packages" $as_root apt-get update -q || say "going on with the old package lists"
  quietly "installing $2" $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "$2"
}

fetch_python() {
  "$venv/bin/python" - "$@" <<'END' 2>/dev/null && return
import importlib.metadata, sys
for wanted in sys.argv[1:]:
    name, version = wanted.split('==')
    assert importlib.metadata.version(name) == version
END
  quietly "fetching Python's peers" "$venv/bin/python" -m pip install --disable-pip-version-check "$@"
}

# program NAME FLAGS: makes build/programs/NAME; NAME-native with the processor's own instructions. A build
# that fails on what an earlier one left is begun anew, as fpm takes stale modules for current ones.
program() {
  fpm_build "$@" || { rm -rf "$root"/bench/build/gfortran_*; fpm_build "$@"; } || return
  cp "$root/bench/$(sed -n 's|^\(build/[^ ]*\) *$|\1|p' "$log" | tail -n 1)" "$programs/$1"
}

fpm_build() {
  quietly "building $1" "$venv/bin/fpm" run "${1%-native}" --directory "$root/bench" --profile release ${2:+--flag "$2"} \
    --runner echo
}

peer() {
  quietly "building $1" g++ -std=c++17 -O3 -march=native -o "$programs/$1" "$root/bench/peers/$1.cpp"
}

set_up() {
  install_packages && install_fpm && fetch_python numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2 scikit-fem==12.0.2 mpmath==1.4.1
}

measure() {
  case $1 in
    dynamics) need g++ g++ && need /usr/include/boost/numeric/odeint.hpp libboost-dev && need octave-cli octave &&
      program dynamics && program dynamics-native -march=native && build_program && peer odeint && peer reference ;;
    honesty) need g++ g++ && need /usr/include/boost/numeric/odeint.hpp libboost-dev && program honesty &&
      program honesty_bodies && peer reference ;;
    harmonics) program harmonics ;;
    elastic) need ccx calculix-ccx && program elastic ;;
    body_modes) need ccx calculix-ccx && program body_modes ;;
    scenes) program scenes && build_package ;;
    as_built | hunting | part_load) build_program ;;
    rows) build_package ;;
    face) build_package ;;
    many | valley) build_package ;;
    doc) ;;
    *) say "what to measure: dynamics, harmonics, elastic, body_modes, face, honesty, scenes, as_built, hunting, part_load, rows, many, valley or all; doc: put the tables into bench/measured and doc/accuracy.md"; return 2 ;;
  esac && OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 "$venv/bin/python" "$root/bench/$1.py" "$programs"
}

set_up || exit
if [ "$1" = all ]; then
  for what in dynamics harmonics elastic body_modes honesty scenes rows as_built hunting part_load; do measure "$what" || exit; done
else
  measure "$1"
fi
