# `make` runs the experiment and writes reports/report.html; `make test` checks everything.
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := report
.PHONY: report test browser meshes bench readme lint format lock clean

PYTHON ?= python3
JOBS ?= all
SET ?= paper
VENV := .venv
READY := $(VENV)/.ready
export PATH := $(CURDIR)/$(VENV)/bin:$(PATH)
export PYTHONPATH := $(CURDIR)/src:$(CURDIR)/workflow/lib

report: $(READY)
	snakemake --cores $(JOBS)
	@echo "The report is at reports/report.html."

test: $(READY) lint browser
	pytest -n 2 --dist loadfile

# Pages are opened in the system's Chromium; without one their tests are skipped.
browser:
	@command -v chromium chromium-browser google-chrome >/dev/null || \
	  { [ "$$(id -u)" = 0 ] && { apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends chromium; } >/dev/null 2>&1; } || \
	  echo "There is no Chromium here, so no page will be opened in one (Debian, Ubuntu: apt install chromium)."

# Hard cases at their full counts; some 17 minutes on two cores.
test-hard: $(READY)
	pytest tests/numerics -n 2 --dist worksteal --stability reports/stability.json
	python -m benchmarks.precision reports/precision.json

meshes: $(READY)
	snakemake --cores $(JOBS) --config meshes="{set: $(SET)}" -- downloads_all

bench: $(READY)
	python -m benchmarks

readme: $(READY)
	python docs/make_readme.py
	python docs/make_tables.py
	python docs/make_overview_picture.py

lint: $(READY)
	ruff format --check .
	ruff check .
	mypy
	lint-imports
	snakefmt --check Snakefile workflow/rules
	snakemake --lint

format: $(READY)
	ruff format .
	ruff check --fix .
	snakefmt Snakefile workflow/rules

# Pins every package with its hashes; needs `uv` on PATH.
lock:
	uv pip compile pyproject.toml --extra dev --universal --python-version 3.11 --generate-hashes \
	  --no-annotate --custom-compile-command "make lock" \
	  --output-file requirements.lock

clean:
	rm -rf results reports/report.html reports/metrics.json reports/plots logs .snakemake

$(READY): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "Python 3.11 or newer is needed, $$($(PYTHON) --version 2>&1) was found: install it, or name it with make PYTHON=..."; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || \
	  { echo "Python's venv module is missing: install it (Debian, Ubuntu: apt install python3-venv)."; exit 1; }
	@echo "Setting up $(VENV) from requirements.lock; this takes some minutes the first time."
	$(PYTHON) -m venv --clear $(VENV)
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes --requirement requirements.lock || \
	  { echo "The packages can't be installed: is the package registry reachable from here?"; exit 1; }
	$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@$(VENV)/bin/python -c 'import visuohaptic.geometry.compiled_open3d' || \
	  { echo "Open3D can't be loaded: install the libraries that the line above names (Debian, Ubuntu: apt install libusb-1.0-0 libgomp1)."; exit 1; }
	@touch $@
