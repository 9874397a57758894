# Sourced by app/run.sh and test/run.sh, with $root set: installs what is missing, builds what changed (app/build.py).
# Messages go to stderr, details to the log. Nothing is fetched where all is there.

: "${root:?}"
fpm_version=0.12.0
run_dir=$root/build/run
log=$run_dir/log
venv=$root/.venv
# What pyproject.toml asks for before it can build, as no environment apart is made for it.
build_tools='meson-python>=0.16 meson>=1.1 ninja numpy>=2.0'
# By meson, from what the program is made of, so that nothing is compiled again.
package_options='--no-build-isolation --config-settings=build-dir=build/python --config-settings=setup-args=-Dlibrary=build/release/libgearsweep.a'
# What checks the sources without running them.
lint_tools='ruff==0.17.6 mypy==2.4.1 fortitude-lint==0.10.0'
# What drives a browser, for test/cases/panel.sh.
browser_driver=playwright==1.65.2
# What makes pages for a browser of doc and of the comments of src.
site_tools='mkdocs==1.6.1 mkdocs-material==9.7.7 ford==7.0.13 nbformat>=5.10 nbclient>=0.10 ipykernel>=6.29'
debug_flags='-g -Og -std=f2018 -fPIC -Wall -Wextra -Wno-uninitialized -Wno-maybe-uninitialized -fbacktrace -fcheck=all -ffpe-trap=invalid,zero,overflow'
# For test/cases/sanitize.sh; C callers are compiled and linked with the C flags. Where an array is assigned to that is not
# allocated yet, gfortran 12 subtracts bounds that were never set and does not use what comes out: integers go unchecked.
sanitize_flags='-g -O1 -std=f2018 -fPIC -fno-omit-frame-pointer -fcheck=all,no-array-temps -fsanitize=address,undefined -fno-sanitize=signed-integer-overflow -fno-sanitize-recover=undefined'
sanitize_c_flags='-g -O1 -fPIC -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=undefined'

# Where another process builds in this folder: after it. The lock is open as 9. With $lanes, that is the other lane of this run.
await_lock() {
  command -v flock >/dev/null || return 0
  flock -n 9 && return
  [ -n "${lanes-}" ] || say "waiting for another build"
  flock 9
}

say() { printf 'gearsweep: %s\n' "$*" >&2; }

# quietly WHAT COMMAND...: where the command fails, shows the end of what it said. WHAT says about how long it takes.
quietly() {
  say "$1"
  step=$1
  shift
  "$@" >"$log" 2>&1 </dev/null || show_log
}
# telling WHAT COMMAND...: the same for a command that reports its progress on stdout.
telling() {
  say "$1"
  step=$1
  shift
  "$@" >&2 2>"$log" </dev/null || show_log
}
show_log() {
  say "failed: $step. The end of $log:"
  tail -n 25 "$log" >&2
  return 1
}

links() { printf 'end\n' | gfortran -x f95 - -o "$run_dir/probe" "$@" 2>/dev/null; }

# Can this Python make environments and build extensions?
is_fit() {
  "$1" -c 'import ensurepip, os, sysconfig, venv
assert os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h"))' 2>/dev/null
}

# The system's own Python where it is fit, else the caller's.
find_python() {
  for python in /usr/bin/python3 "$(command -v python3)"; do
    is_fit "$python" && return
  done
  python=/usr/bin/python3
  return 1
}

install_packages() {
  missing=
  links || missing="gfortran libc6-dev"
  links -lopenblas || missing="$missing libopenblas-dev"
  links -ldmumps_seq && echo '#include <dmumps_c.h>' | gcc -E - >/dev/null 2>&1 || missing="$missing libmumps-seq-dev"
  links -lscotch || missing="$missing libscotch-dev"
  links -larpack || missing="$missing libarpack2-dev"
  command -v pkg-config >/dev/null || missing="$missing pkg-config"
  command -v python3 >/dev/null || missing="$missing python3"
  install_missing
}

# install_tools COMMAND...: what the tests call besides, each by the package that has it.
install_tools() {
  missing=
  for tool in "$@"; do
    command -v "$tool" >/dev/null && continue
    case $tool in
      cc) missing="$missing gcc" ;;
      ldd) missing="$missing libc-bin" ;;
      setpriv | flock) missing="$missing util-linux" ;;
      nm | ar | readelf) missing="$missing binutils" ;;
      timeout | truncate | mkfifo) missing="$missing coreutils" ;;
      *) missing="$missing $tool" ;;
    esac
  done
  install_missing
}

# Installs the Debian packages $missing.
install_missing() {
  [ -n "$missing" ] || return 0
  mkdir -p "$run_dir" || return
  as_root=
  [ "$(id -u)" = 0 ] || as_root=sudo
  if ! command -v apt-get >/dev/null || { [ -n "$as_root" ] && ! command -v sudo >/dev/null; }; then
    say "please install these Debian packages, or what they are called here: $missing"
    return 1
  fi
  # One at a time: the package manager refuses a second caller. Its log is its own, as a build may be at work beside it.
  (
    if command -v flock >/dev/null; then flock 8; fi
    log=$run_dir/packages.log
    quietly "looking for packages, about 5 s" $as_root apt-get update -q || say "going on with the old package lists"
    quietly "installing $missing, about 30 s" $as_root env DEBIAN_FRONTEND=noninteractive \
      apt-get install -q -y --no-install-recommends $missing
  ) 8>"$run_dir/packages.lock"
}

# For test/cases/matrix.sh only: flang, with OpenMP.
flang=flang-new-19
install_flang() {
  mkdir -p "$run_dir" || return
  missing=
  printf '!$ use omp_lib\n!$ print *, omp_get_max_threads()\nend\n' >"$run_dir/probe.f90"
  "$flang" -fopenmp "$run_dir/probe.f90" -o "$run_dir/probe" 2>/dev/null || missing='flang-19 libomp-19-dev'
  install_missing
}

# A .venv that does not work is made anew.
make_venv() {
  "$venv/bin/python" -m pip --version >/dev/null 2>&1 && return
  missing=
  find_python || missing='python3 python3-venv python3-dev'
  install_missing && find_python || return
  rm -rf "$venv"
  quietly "making .venv, about 10 s" "$python" -m venv "$venv"
}

# A checksum of all that decides what is built: files, command and environment.
fingerprint() {
  {
    (cd "$root" && find fpm.toml $1 -type f ! -path "*/__pycache__/*" -exec cksum {} + | LC_ALL=C sort)
    echo "$2 ${FFLAGS-}"
  } | cksum
}

is_current() { [ -e "$1" ] && [ "$(cat "$1.stamp" 2>/dev/null)" = "$2" ]; }

# build NAME WHAT FOLDER OPTIONS...: makes build/run/NAME unless it is current; WHAT and OPTIONS as app/build.py has them.
build() (
  target=$run_dir/$1
  name=$1
  what=$2
  folder=$root/build/$3
  shift 3
  case $what in library) tops=src ;; program) tops='src app' ;; check) tops='src test' ;; esac
  now=$(fingerprint "app/build.py $tops" "$*")
  is_current "$target" "$now" && exit
  mkdir -p "$run_dir" || exit
  exec 9>"$run_dir/lock"
  await_lock
  is_current "$target" "$now" && exit
  install_packages || exit
  telling "building $name" python3 "$root/app/build.py" "$folder" "$what" "$@" || exit
  case $what in library) built=libgearsweep.a ;; *) built=$what ;; esac
  # A copy, as the next build may put another version in its place.
  cp "$folder/$built" "$target.new" && mv -f "$target.new" "$target" && echo "$now" >"$target.stamp"
)

# The Python package with all that its tests load, in .venv: the program's library behind f2py.
build_package() {
  build_library || return
  target=$run_dir/python-gearsweep
  now=$(fingerprint "pyproject.toml meson.build meson.options app/build.py src python/gearsweep data" "$build_tools")
  is_current "$target" "$now" && return
  (
    await_lock
    is_current "$target" "$now" && exit
    cd "$root" && make_venv || exit
    PATH=$venv/bin:$PATH
    quietly "fetching what builds the Python package, about 15 s" pip install --disable-pip-version-check $build_tools || exit
    # A build that broke off is begun anew.
    quietly "building the Python package, about 30 s" pip install --disable-pip-version-check $package_options '.[test]' ||
      { rm -rf build/python; exit 1; }
    printf '#!/bin/sh\nexec "%s" -m gearsweep "$@"\n' "$venv/bin/python" >"$target" && chmod +x "$target" &&
      echo "$now" >"$target.stamp"
  ) 9>"$run_dir/lock"
}

# install_python WHAT PACKAGES...: into .venv.
install_python() {
  what=$1
  shift
  [ "$(cat "$run_dir/$what.stamp" 2>/dev/null)" = "$*" ] && return
  mkdir -p "$run_dir" || return
  (
    await_lock
    make_venv || exit
    quietly "fetching $what, about 15 s" "$venv/bin/python" -m pip install --disable-pip-version-check "$@" || exit
    echo "$*" >"$run_dir/$what.stamp"
  ) 9>"$run_dir/lock"
}
# For test/cases/panel.sh only: a browser, and what drives it.
install_browser() {
  missing=
  command -v chromium >/dev/null || missing=chromium
  install_missing && install_python browser-driver "$browser_driver"
}
install_lint() { install_python linters $lint_tools; }
install_site() { install_python page-tools $site_tools; }

# For test/cases/test_fpm.sh and others that call fpm.
install_fpm() { install_python fpm "fpm==$fpm_version"; }

build_library() { build libgearsweep.a library release; }
build_program() { build gearsweep program release; }
# Needs nothing of the system that it runs on.
build_static() { build gearsweep-static program release --link-flags='-static -s'; }
build_check_release() { build check-release check release; }
# In place of the released flags.
build_check_debug() { build check-debug check debug --flags="$debug_flags"; }
# The library with the address and undefined-behaviour sanitizers: with the program, or with the suites, which take twice as long.
build_sanitized() { with_sanitizers sanitized program; }
build_check_sanitized() { with_sanitizers check-sanitized check; }
with_sanitizers() {
  build "$@" sanitized --flags="$sanitize_flags" --c-flags="$sanitize_c_flags -fopenmp" --link-flags=-fsanitize=address,undefined
}
