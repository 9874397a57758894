#!/bin/sh
# Makes what a release consists of, from a checkout without changes:
#   sh app/release.sh FOLDER
# the sources, a wheel with its libraries, a program that needs nothing of the system, the pages, and SHA256SUMS of these.
# The version stands in fpm.toml; CHANGELOG.md and CITATION.cff must name it too, with one date, or the changelog `unreleased`.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
case ${1-} in
  '' | -*) echo "usage: sh app/release.sh FOLDER" >&2; exit 2 ;;
esac
mkdir -p "$1" && folder=$(CDPATH= cd -- "$1" && pwd) || exit 3
. "$root/app/setup.sh"
version=$(sed -n 's/^version *= *"\(.*\)"/\1/p' "$root/fpm.toml")
name=gearsweep-$version

refuse() { say "$*"; exit 1; }
[ -z "$(ls -A "$folder")" ] || refuse "$folder has files already"
cd "$root" && changed=$(git status --porcelain) || exit
[ -z "$changed" ] || refuse "the checkout has changes that are not committed"
heading=$(sed -n 's/^## //p' CHANGELOG.md | head -n 1)
cited=$(sed -n 's/^version: //p' CITATION.cff)
day=$(sed -n 's/^date-released: //p' CITATION.cff)
[ "$cited" = "$version" ] || refuse "fpm.toml has version $version, CITATION.cff $cited"
case $heading in
  "$version - unreleased") say "a trial: CHANGELOG.md calls $version unreleased" ;;
  "$version - $day") ;;
  *) refuse "CHANGELOG.md begins with $heading, not with $version - $day as fpm.toml and CITATION.cff say" ;;
esac

make_program() {
  build_static || return
  plain=$(mktemp -d "${TMPDIR:-/tmp}/gearsweep.XXXXXX") && mkdir "$plain/$name" &&
    cp "$run_dir/gearsweep-static" "$plain/$name/gearsweep" && cp LICENSE NOTICE app/completion.sh examples/first.nml "$plain/$name" &&
    tar -C "$plain" -czf "$folder/$name-linux-$(uname -m).tar.gz" --owner=0 --group=0 "$name"
  code=$?
  rm -rf "$plain"
  return $code
}

git archive --prefix="$name/" -o "$folder/$name.tar.gz" HEAD && make_program && sh app/wheel.sh "$folder" && sh doc/site.sh &&
  tar -C build -czf "$folder/$name-pages.tar.gz" --owner=0 --group=0 --transform="s/^site/$name-pages/" site || exit 125
(cd "$folder" && sha256sum gearsweep-* >SHA256SUMS) || exit 3
say "left in $folder: $(cd "$folder" && ls | tr '\n' ' ')"
