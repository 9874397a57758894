#!/bin/sh
# Makes a release of what is committed, from a clone in a path with a blank, and tries its program and its wheel as users do who have no
# compiler, no rights and no network: sh test/cases/release.sh
# The last line is `N passed, N failed`.
# Before a release, by itself: it needs rights that not every machine gives (chroot, another user). Takes about 5 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
. "$root/test/checks.sh"
need git tar sha256sum setpriv
make_venv || exit
clone="$work/a clone"
release="$work/a release"
chmod 755 "$work"
git clone -q "$root" "$clone" && cd "$clone" || exit
version=$(sed -n 's/^version *= *"\(.*\)"/\1/p' fpm.toml)

# refuses TEXT FILE SED: a release with this change, once it is committed.
refuses() {
  sed -i "$3" "$2" && git -c user.name=a -c user.email=a@b commit -qam changed
  (sh app/release.sh "$release") 2>"$work/why"
  code=$?
  git reset -q --hard HEAD~
  [ $code = 1 ] && grep -qF -- "$1" "$work/why" || { cat "$work/why"; return 1; }
}
is_usage() { sh app/release.sh "$@"; [ $? = 2 ]; }
check 'it wants a folder' is_usage
check 'it refuses options' is_usage --folder
echo >>README.md
is_changed() { (sh app/release.sh "$release") 2>"$work/why"; [ $? = 1 ] && grep -q 'not committed' "$work/why"; }
check 'it refuses a checkout with changes' is_changed
git checkout -q README.md
check 'it refuses another version in CITATION.cff' refuses 'CITATION.cff has 9.9.9' CITATION.cff 's/^version: .*/version: 9.9.9/'
check 'it refuses another version in CHANGELOG.md' refuses 'CHANGELOG.md has 9.9.9' CHANGELOG.md "s/^## $version/## 9.9.9/"
check 'it refuses another date in CHANGELOG.md' refuses 'CHANGELOG.md has the date 1999-12-31' CHANGELOG.md "s/^## $version.*/## $version - 1999-12-31/"

check 'it is made' sh app/release.sh "$release"
cd "$release" || exit
check 'its sums are right, and of all files' sh -c 'sha256sum -c SHA256SUMS && [ $(wc -l <SHA256SUMS) = 4 ] && [ $(ls | wc -l) = 5 ]'
mkdir "$work/sources" && check 'the sources unpack' tar -C "$work/sources" -xzf "gearsweep-$version.tar.gz"
check 'they are what is committed' sh -c "cd '$clone' && git ls-files | while IFS= read -r file; do cmp \"\$file\" '$work/sources/gearsweep-$version/'\"\$file\" || exit; done"
mkdir "$work/pages" && check 'the pages unpack' tar -C "$work/pages" -xzf "gearsweep-$version-pages.tar.gz"
check 'they begin with a page, and load nothing from elsewhere' sh -c \
  "cd '$work/pages/gearsweep-$version-pages' && [ -s index.html ] && ! grep -rlE '(src|href)=\"https?://[^\"]*\\.(js|css|woff2?)\"' --include='*.html' ."

# Where that is possible: without a network.
offline='unshare -n'
unshare -n true 2>/dev/null || { echo 'the network cannot be taken away here'; offline=; }
as_nobody="setpriv --reuid=65534 --regid=65534 --clear-groups"
[ "$(id -u)" = 0 ] || as_nobody=
answer() { sed '/^Time /,$d' "$1"; }
sh "$clone/app/run.sh" "$clone/examples/first.nml" --out "$work/theirs" >"$work/screen" 2>"$work/said"
answer "$work/screen" >"$work/answer"

# --- the program: in a root that holds nothing else ----------------------------------------

bare="$work/a bare root"
mkdir -p "$bare/my results" && tar -C "$bare" -xzf "gearsweep-$version-linux-$(uname -m).tar.gz" && mv "$bare/gearsweep-$version" "$bare/my gears" && chmod 777 "$bare/my results"
in_bare() {
  $offline chroot --userspec=65534:65534 "$bare" '/my gears/gearsweep' '/my gears/first.nml' --out '/my results' >"$work/bare" && answer "$work/bare" >"$work/ours" &&
    [ -s "$work/ours" ] && cmp "$work/ours" "$work/answer" && diff -r "$bare/my results" "$work/theirs"
}
if [ "$(id -u)" = 0 ]; then check 'the program runs in a root without any library, and gives the same bits' in_bare; fi
check 'it has its licences' test -s "$bare/my gears/NOTICE"

# --- the wheel: with NumPy of today and the oldest that pyproject.toml allows ---------------------------

case_in_python() {
  cd / && PATH=/usr/bin:/bin $offline $as_nobody "$1/bin/gearsweep" "$clone/examples/first.nml" --out "$1/results" >"$1/said" && answer "$1/said" >"$work/ours" &&
    [ -s "$work/ours" ] && cmp "$work/ours" "$work/answer"
}
for numpy in numpy numpy==1.26.4; do
  home="$work/an environment with $numpy"
  fetch() { "$venv/bin/python" -m pip download --disable-pip-version-check -q --only-binary :all: -d "$work/wheels-$numpy" "$numpy"; }
  check "$numpy is fetched" fetch
  make_home() {
    "$venv/bin/python" -m venv "$home" && $offline "$home/bin/python" -m pip install --disable-pip-version-check --no-index --find-links "$work/wheels-$numpy" "$release"/gearsweep-*.whl "$numpy" &&
      mkdir "$home/results" && chmod 777 "$home" "$home/results"
  }
  check "the wheel is installed beside $numpy, without a network" make_home
  check "with $numpy it gives the same answer" case_in_python "$home"
done

# --- the recipes --------------------------------------------------------------------

# Neither conda nor a registry of images is at hand: what the recipes name is compared with what is there.
recipe() {
  "$clone/.venv/bin/python" - "$clone" <<'PY'
import pathlib, re, sys, tomllib
import jinja2, yaml
root = pathlib.Path(sys.argv[1])
project = tomllib.loads((root / 'pyproject.toml').read_text())
text = jinja2.Template((root / 'app/conda/meta.yaml').read_text()).render(
    PYTHON='python', compiler=lambda language: language, load_file_regex=lambda load_file, regex_pattern: re.search(regex_pattern, (root / load_file).read_text()))
recipe = yaml.safe_load(text)
assert recipe['package']['version'] == tomllib.loads((root / 'fpm.toml').read_text())['version']
needs = {'host': project['build-system']['requires'], 'run': [*project['project']['dependencies'], 'python' + project['project']['requires-python']]}
for part, wanted in needs.items():
    assert {line.replace(' ', '') for line in wanted} <= {line.replace(' ', '') for line in recipe['requirements'][part]}, part
for library in ('openblas', 'mumps', 'arpack'):
    assert any(line.startswith(library) for line in recipe['requirements']['host']), library
assert recipe['about']['license_file'] == project['project']['license-files'] and recipe['about']['license'] == project['project']['license']
PY
}
check 'the recipe for conda agrees with pyproject.toml' recipe
copied() { sed -n 's/^COPY \([^-].*\) [^ ]*$/\1/p' "$clone/app/Containerfile" | tr ' ' '\n' | while IFS= read -r file; do [ -e "$clone/$file" ] || exit 1; done; }
check 'what the container copies is there' copied
finish
