#!/bin/sh
# Makes what a release consists of, from a checkout without changes:
#   sh app/release.sh FOLDER
# the sources, a wheel with its libraries, a program that needs nothing of the system, the pages, and SHA256SUMS of these.
# app/version.py sets the version and its date; a trial may be `unreleased` in CHANGELOG.md.
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
python3 app/version.py >&2 || exit 1
if grep -q "^## $version - unreleased" CHANGELOG.md; then say "a trial: CHANGELOG.md calls $version unreleased"; fi

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
