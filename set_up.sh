#!/usr/bin/env bash
# Makes .venv, or the folder that VENV names, for the Makefile: `set_up.sh packages` from requirements.lock,
# `set_up.sh package` adds this project and its own packages, `set_up.sh develop` what tests need, `set_up.sh pytest` pytest alone.
#
# uv installs where it is on PATH, otherwise pip. All packages are pinned with their hashes, dependencies among them,
# so nothing has to be resolved. What a run imports gets its bytecode here, for later it may not be writable, as in a
# container; the other half of the modules get theirs when they are first imported.
set -euo pipefail
cd "$(dirname "$0")"
PYTHON=${PYTHON:-python3}
VENV=${VENV:-.venv}
IN_VENV=$VENV/bin/python

stop() {
  echo "$1" >&2
  exit 1
}

# Before anything is downloaded.
check_path() {
  case $PWD in
    *[{}]*) stop "$PWD has a brace in its path, which Snakemake reads as a wildcard; rename or move it." ;;
    *:*) stop "$PWD has a colon in its path, which separates folders in PATH; rename or move it." ;;
  esac
}

check_python() {
  "$PYTHON" -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
    stop "Python 3.11 or newer is needed, $("$PYTHON" --version 2>&1) was found: install it, or name it with make PYTHON=..."
  "$PYTHON" -c 'import ensurepip, venv' 2>/dev/null ||
    stop "Python's venv module is missing: install it (Debian, Ubuntu: apt install python3-venv)."
}

run_pip() {
  PYTHONUNBUFFERED=1 "$IN_VENV" -m pip --disable-pip-version-check install --no-deps --no-compile "$@"
}

# Shows which package pip is at: one line that changes on a terminal, two lines in a log.
show_progress() {
  local word name count=0
  while read -r word name _; do
    case $word in
      Collecting) [ ! -t 1 ] || printf '\r\033[K  package %d: %s' $((count += 1)) "${name%%[=; ]*}" ;;
      Installing)
        [ ! -t 1 ] || printf '\r\033[K'
        echo "  all packages are downloaded; unpacking, half a minute"
        cat >/dev/null
        ;;
    esac
  done
}

# The lines of a lock file that pin a package.
pin() {
  sed -n "/^$1==/,/[^\\]\$/p" "$2"
}

install() {
  if command -v uv >/dev/null; then
    uv pip install --python "$IN_VENV" --no-deps --require-hashes --requirement "$1" && return
    echo "uv can't install the packages; pip tries."
  fi
  # The pip that comes with Python 3.11 takes twice as long as the pinned one.
  run_pip --quiet --require-hashes --requirement <(pin pip requirements.lock) &&
    run_pip --require-hashes --requirement "$1" | show_progress ||
    stop "The packages can't be installed: is the package registry reachable from here?"
}

compile() {
  env -u PYTHONDONTWRITEBYTECODE "$IN_VENV" -P -c "import $1"
}

case $1 in
  packages)
    check_path
    check_python
    echo "Setting up $VENV from requirements.lock: about a minute, and 400 MB to download, the first time."
    "$PYTHON" -m venv --clear "$VENV"
    install requirements.lock
    ;;
  package)
    echo "Adding visuohaptic, and loading each package once: half a minute."
    run_pip --quiet --no-build-isolation --editable ./packages/contourlets --editable ./packages/meshreaders --editable .
    compile "snakemake.cli, snakemake.report, snakemake.script, snakemake.workflow, nbformat, yaml" &
    compile "cv2, jinja2, matplotlib.pyplot, pandas, pyarrow.parquet, pywt, scipy.stats, sklearn.tree, skops.io, trimesh"
    wait
    compile visuohaptic.geometry.compiled_open3d ||
      stop "Open3D can't be loaded: install the libraries that the line above names (Debian, Ubuntu: apt install libegl1 libgl1 libgomp1)."
    ;;
  develop)
    echo "Adding what tests need to $VENV from requirements-dev.lock."
    install requirements-dev.lock
    ;;
  pytest)
    # What else pytest asks for is in requirements.lock.
    run_pip --quiet --require-hashes --requirement <(
      pin pytest requirements-dev.lock
      pin iniconfig requirements-dev.lock
    )
    ;;
esac
