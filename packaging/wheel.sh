#!/usr/bin/env bash
# Makes a wheel of a source tree or source distribution, and tries it in a new environment without a compiler:
#   packaging/wheel.sh SOURCE FOLDER PYTHON
# auditwheel checks the wheel and gives it its tag; FOLDER keeps what was made.
set -euo pipefail
source=$(realpath "$1") folder=$(realpath "$2") python=$3
root=$(realpath "$(dirname "$0")/..")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

pip() { "$work/venv/bin/python" -m pip --disable-pip-version-check -q "$@"; }

"$python" -m venv "$work/venv"
pip wheel --no-deps -w "$work/raw" "$source"
pip install -c "$root/constraints.txt" "$(echo "$work"/raw/*.whl)[wheel]"
PATH=$work/venv/bin:$PATH auditwheel repair -w "$work/repaired" "$work"/raw/*.whl
pip install --force-reinstall --no-deps "$work"/repaired/*.whl
PATH=$work/venv/bin "$work/venv/bin/python" "$root/tests/support/installed.py"
mv "$work"/repaired/*.whl "$folder"
