#!/bin/sh
# Fetches Embree 4 for slimkd-bench: the shared library inside the Python wheel `embreex`, through pip, into target/embree.
# The program finds it there by itself. Needs python3 with pip; no virtual environment, nothing is installed.
set -eu
cd "$(dirname "$0")/../.."
into=target/embree
mkdir -p "$into"
python3 -m pip download --quiet --no-deps --only-binary=:all: --dest "$into" "embreex==4.4.0.post1"
for wheel in "$into"/embreex-*.whl; do
    python3 -m zipfile -e "$wheel" "$into/wheel"
done
ls "$into"/wheel/embreex.libs/libembree4*
