#!/bin/sh
# The library's motions against an independent solver at random points: 3000 of all kinds and 3000 lightly damped ones, many
# hours. See campaign.py.
#
#     sh tools/reference/motions/campaign.sh [COUNT]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../../.." && pwd)
. "$root/app/setup.sh"
build_package
for kind in all light; do
  echo "== $kind"
  "$venv/bin/python" "$here/campaign.py" "$kind" "${1:-3000}"
done
