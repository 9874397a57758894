#!/bin/sh
# Installs the program with its completion, the library (static and shared), its modules, the C header, and files for pkg-config
# and CMake:
#   sh app/install.sh PREFIX
# Sets up and builds first where needed. What PREFIX holds already stays, but for files of these names.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
case ${1-} in
  '' | -*) echo "usage: sh app/install.sh PREFIX" >&2; exit 2 ;;
esac
mkdir -p "$1" && prefix=$(CDPATH= cd -- "$1" && pwd) || exit 3
. "$root/app/setup.sh"

version=$(sed -n 's/^version *= *"\(.*\)"/\1/p' "$root/fpm.toml")
# Before 1.0 each minor version may change the calls.
minor=${version%.*}
# OpenBLAS first, so that its symbols are looked up there.
needs='-lopenblas -ldmumps_seq -larpack -lgomp -lgfortran -lm -lpthread'

# The library of the program and of the Python package: the same bits.
install_library() {
  built=$root/build/release
  completions=$prefix/share/bash-completion/completions
  mkdir -p "$prefix/bin" "$prefix/lib/pkgconfig" "$prefix/lib/cmake/gearsweep" "$prefix/include/gearsweep" "$completions" || return
  replace "$run_dir/gearsweep" "$prefix/bin/gearsweep" && replace "$run_dir/libgearsweep.a" "$prefix/lib/libgearsweep.a" &&
    cp "$built"/src/*.mod "$root"/include/gearsweep.* "$prefix/include/gearsweep/" && make_shared &&
    cp "$root/app/completion.sh" "$completions/gearsweep" &&
    write_pc "\${libdir}/libgearsweep.a $needs" '' >"$prefix/lib/pkgconfig/gearsweep.pc" &&
    write_pc '-L${libdir} -Wl,-rpath,${libdir} -lgearsweep' "$needs" >"$prefix/lib/pkgconfig/gearsweep-shared.pc" &&
    write_config >"$prefix/lib/cmake/gearsweep/gearsweepConfig.cmake" &&
    write_config_version >"$prefix/lib/cmake/gearsweep/gearsweepConfigVersion.cmake"
}

# replace FILE BY: in one step, as the old one may be in use.
replace() { cp "$1" "$2.new" && mv -f "$2.new" "$2"; }

make_shared() {
  library=$prefix/lib/libgearsweep.so.$version
  gfortran -shared -fopenmp -Wl,-soname,"libgearsweep.so.$minor" -Wl,-z,defs -Wl,--whole-archive "$prefix/lib/libgearsweep.a" \
    -Wl,--no-whole-archive -lopenblas -ldmumps_seq -larpack -lm -lpthread -o "$library.new" && mv -f "$library.new" "$library" &&
    ln -sf "libgearsweep.so.$version" "$prefix/lib/libgearsweep.so.$minor" &&
    ln -sf "libgearsweep.so.$minor" "$prefix/lib/libgearsweep.so"
}

# write_pc LIBS PRIVATE: the folder is found from where the file lies, so that an installed tree can be moved.
write_pc() {
  cat <<END
prefix=\${pcfiledir}/../..
libdir=\${prefix}/lib
includedir=\${prefix}/include/gearsweep

Name: gearsweep
Description: $(sed -n 's/^description *= *"\(.*\)"/\1/p' "$root/fpm.toml")
Version: $version
Cflags: -I\${includedir}
Libs: $1
Libs.private: $2
END
}

# For find_package(gearsweep): the target gearsweep::gearsweep, static unless BUILD_SHARED_LIBS is on.
write_config() {
  cat <<END
get_filename_component(_gearsweep_prefix "\${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
if(NOT TARGET gearsweep::gearsweep)
  add_library(gearsweep::static STATIC IMPORTED)
  set_target_properties(gearsweep::static PROPERTIES
    IMPORTED_LOCATION "\${_gearsweep_prefix}/lib/libgearsweep.a"
    INTERFACE_INCLUDE_DIRECTORIES "\${_gearsweep_prefix}/include/gearsweep"
    INTERFACE_LINK_LIBRARIES "$needs")
  add_library(gearsweep::shared SHARED IMPORTED)
  set_target_properties(gearsweep::shared PROPERTIES
    IMPORTED_LOCATION "\${_gearsweep_prefix}/lib/libgearsweep.so.$version"
    IMPORTED_SONAME "libgearsweep.so.$minor"
    INTERFACE_INCLUDE_DIRECTORIES "\${_gearsweep_prefix}/include/gearsweep")
  add_library(gearsweep::gearsweep INTERFACE IMPORTED)
  if(BUILD_SHARED_LIBS)
    set_target_properties(gearsweep::gearsweep PROPERTIES INTERFACE_LINK_LIBRARIES gearsweep::shared)
  else()
    set_target_properties(gearsweep::gearsweep PROPERTIES INTERFACE_LINK_LIBRARIES gearsweep::static)
  endif()
endif()
unset(_gearsweep_prefix)
END
}

write_config_version() {
  cat <<END
set(PACKAGE_VERSION "$version")
if(PACKAGE_FIND_VERSION VERSION_LESS_EQUAL PACKAGE_VERSION AND "\${PACKAGE_FIND_VERSION_MAJOR}.\${PACKAGE_FIND_VERSION_MINOR}" STREQUAL "$minor")
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
  if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION)
    set(PACKAGE_VERSION_EXACT TRUE)
  endif()
endif()
END
}

build_library && build_program && install_library || exit 125
say "installed into $prefix; export PKG_CONFIG_PATH=$prefix/lib/pkgconfig"
