# `make` runs the experiment and writes reports/report.html; `make test` checks everything.
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := report
.PHONY: report check test test-hard meshes bench readme lint format lock clean

PYTHON ?= python3
JOBS ?= 2
SET ?= paper
VENV := .venv
READY := $(VENV)/.ready
export PATH := $(CURDIR)/$(VENV)/bin:$(PATH)
export PYTHONPATH := $(CURDIR)/src:$(CURDIR)/workflow/lib

report: $(READY)
	snakemake -j$(JOBS)
	@echo "The report is at reports/report.html."

# The quick loop: under a minute on two cores.
check: lint
	pytest -n 2 --dist worksteal -m "not slow and not workflow"

test: lint
	pytest -n 2 --dist loadfile

# Hard cases at their full counts; some 17 minutes on two cores.
test-hard: $(READY)
	pytest tests/numerics -n 2 --dist worksteal --stability reports/stability.json
	python -m benchmarks.precision reports/precision.json

meshes: $(READY)
	snakemake -j$(JOBS) --config meshes="{set: $(SET)}" -- downloads_all

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
