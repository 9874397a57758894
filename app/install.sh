#!/bin/sh
# Installs the program, the static library, its modules, the C header and a pkg-config file:
#   sh app/install.sh PREFIX
# Sets up and builds first where needed. What PREFIX holds already stays, but for files of these names.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
case ${1-} in
  '' | -*) echo "usage: sh app/install.sh PREFIX" >&2; exit 2 ;;
esac
mkdir -p "$1" && prefix=$(CDPATH= cd -- "$1" && pwd) || exit 3
. "$root/app/setup.sh"

# The same flags as the program: the same bits. All modules, as the program needs not all of them.
install_library() (
  mkdir -p "$run_dir" && cd "$root" || exit
  await_lock
  install_packages && make_venv || exit
  run_fpm "installing into $prefix, about 1 min" install --profile release --no-prune --prefix "$prefix" \
    --libdir lib --includedir include/gearsweep || exit
  cp include/gearsweep.h "$prefix/include/gearsweep/" || exit
  mkdir -p "$prefix/lib/pkgconfig" && write_pc >"$prefix/lib/pkgconfig/gearsweep.pc"
) 9>"$run_dir/lock"

# The folder is found from where the file lies, so that an installed tree can be moved.
write_pc() {
  cat <<END
prefix=\${pcfiledir}/../..
libdir=\${prefix}/lib
includedir=\${prefix}/include/gearsweep

Name: gearsweep
Description: $(sed -n 's/^description *= *"\(.*\)"/\1/p' "$root/fpm.toml")
Version: $(sed -n 's/^version *= *"\(.*\)"/\1/p' "$root/fpm.toml")
Cflags: -I\${includedir}
Libs: -L\${libdir} -lgearsweep -lopenblas -lgomp -lgfortran -lm -lpthread
END
}

mkdir -p "$run_dir" && install_library || exit 125
say "installed into $prefix; export PKG_CONFIG_PATH=$prefix/lib/pkgconfig"
