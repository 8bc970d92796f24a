# `make` runs the experiment and writes reports/report.html; `make test` checks it.
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := report
.PHONY: report why verify check test test-all test-hard golden test-slurm test-installed meshes gaze draws cues first_touch first_touch_turned learned learned_all learned_turned turned keep baselines packaged_model bench wheels release paper readme params format lock clean
.PHONY: site lint lint-types lint-code lint-workflow installed-alone installed-dvc

export PYTHON ?= python3
JOBS ?= all
SET ?= paper
# Of `make gaze`: recordings of people's gaze, and predictions of others.
FOLDER ?=
PEER ?=
# Of `make keep`: a study, and a measured file where the study does not name its result.
STUDY ?=
FILE ?=
# Of `make paper`.
PANDOC ?= pandoc
export VENV := .venv
PACKAGES := $(VENV)/.packages
PROJECTS := pyproject.toml packages/contourlets/pyproject.toml packages/meshreaders/pyproject.toml
READY := $(VENV)/.ready
DEVELOP := $(VENV)/.ready-to-develop
RUN := snakemake
# Nothing runs, so that no profile is needed, nor Snakemake's line about it.
ASK := snakemake --list-rules --quiet --workflow-profile none
# Without the extra `dev`: what `make` sets up, and pytest.
INSTALLED := .venv-run
OUTER_PATH := $(PATH)
export PATH := $(CURDIR)/$(VENV)/bin:$(PATH)
export PYTHONPATH := $(CURDIR)/src:$(CURDIR)/packages/contourlets/src:$(CURDIR)/packages/meshreaders/src:$(CURDIR)/workflow/lib:$(CURDIR)/studies

report: $(READY)
	@$(RUN) --cores $(JOBS)
	@[ dvc.lock -nt reports/report.html ] || VISUOHAPTIC_ASKED=lock $(ASK)

# What would run now and why, and whether what is here is what today's parameters, code and sources give.
why: $(READY)
	@VISUOHAPTIC_ASKED=why $(ASK)
verify: $(READY)
	@VISUOHAPTIC_ASKED=verify $(ASK)

# The quick loop: under a minute on two cores.
check: lint
	pytest -n 2 --dist worksteal -m "not slow and not long and not workflow" \
	  --ignore tests/browser --ignore tests/numerics

# Without the checks of `make lint`, which `make check` and continuous integration run.
test: $(DEVELOP)
	@echo "All tests but the long ones: some 13 minutes on two idle cores, longer beside other work."
	pytest -n 2 --dist loadfile --no-loadscope-reorder -m "not long"

# Also what takes long: kills, pulls and reruns of whole workflows; continuous integration runs it.
test-all: lint
	pytest -n 2 --dist loadfile --no-loadscope-reorder

# With the packages that users have: every module is imported, and the README's commands run on a small experiment,
# those of DVC beside the others. The environment is one of its own, for .venv may have more
# (continuous integration names .venv while it is new).
test-installed:
	@PATH="$(OUTER_PATH)" $(MAKE) --no-print-directory --jobs 2 --output-sync=target VENV=$(INSTALLED) installed-alone installed-dvc

installed-alone installed-dvc: $(VENV)/.ready-to-try
installed-alone installed-dvc: export PYTHONPATH :=
# Only pytest is there: what tests/conftest.py needs is not.
installed-alone installed-dvc: export PYTEST_ADDOPTS := --confcutdir=tests/installed --durations=0
installed-alone:
	python -m pytest tests/installed/every_module.py tests/installed/readme_commands.py -k "not under_dvc"
installed-dvc:
	python -m pytest tests/installed/readme_commands.py -k under_dvc

# Hard cases at their full counts, some three minutes on two cores; what they find is a page of docs. Then the golden
# runs, with the default one, the reference on the twelve objects, and thousands of steps of the state machine of
# working folders, half an hour.
test-hard: $(DEVELOP)
	pytest tests/numerics -n 2 --dist worksteal --stability docs/hard_cases.md
	pytest tests/golden tests/reference tests/workflow/test_golden_runs.py -n 2 --dist worksteal
	pytest tests/workflow/test_folder_machine.py -k after_each_run --examples 300

# Makes the golden runs and keeps their tables in tests/golden/kept, after a change that is meant to move results.
golden: export PYTHONPATH := $(PYTHONPATH):$(CURDIR)/tests
golden: $(DEVELOP)
	@python -m golden.keeping

# A real Slurm of one node, set up and taken down; installs Debian's packages where it may. Some ten minutes; with SET=benchmark two hours.
test-slurm: $(DEVELOP)
	pip install --quiet --no-build-isolation --editable '.[slurm]'
	timeout 14400 python tests/slurm/check.py --set $(SET)

meshes: $(READY)
	@$(RUN) --cores $(JOBS) --config meshes="{set: $(SET)}" -- downloads_all

# How well attention predicts where people looked (studies/human_gaze/README.md): make gaze FOLDER=gaze_data
gaze: $(READY)
	@python -m human_gaze "$(FOLDER)" $(if $(PEER),--peer "$(PEER)")

# Twenty draws of random places in both pipelines, kept with the study (studies/draws/README.md): make draws SET=benchmark
draws: export PYTHONPATH := $(PYTHONPATH):$(CURDIR)/docs
draws: $(READY)
	@$(RUN) --cores $(JOBS) --config meshes="{set: $(SET)}" -- results/draws.parquet
	@python -m visuohaptic.studies.keeping draws $(SET)
	@python -m draws.make_page
	@python -m variants.make_page
	@python docs/make_two_questions.py

# Accuracy by positions, normals and imprints only, kept with the study (studies/cues/README.md): make cues SET=benchmark
cues: export PYTHONPATH := $(PYTHONPATH):$(CURDIR)/docs
cues: $(READY)
	@$(RUN) --cores $(JOBS) --config meshes="{set: $(SET)}" -- results/cues.parquet
	@python -m visuohaptic.studies.keeping cues $(SET)
	@python -m cues.make_page

# The network of touches beside the fixed descriptors (studies/learned/README.md): make learned SET=benchmark
learned: export PYTHONPATH := $(PYTHONPATH):$(CURDIR)/docs
learned: $(READY)
	@$(RUN) --cores $(JOBS) --config meshes="{set: $(SET)}" -- results/learned.parquet
	@python -m visuohaptic.studies.keeping learned $(SET)
	@python -m learned.make_page

# The same with turned objects: make learned_turned SET=benchmark
learned_turned: export PYTHONPATH := $(PYTHONPATH):$(CURDIR)/docs
learned_turned: $(READY)
	@$(RUN) --cores $(JOBS) --config meshes="{set: $(SET)}" -- results/learned_turned.parquet
	@python -m visuohaptic.studies.keeping learned_turned $(SET)
	@python -m learned.make_page

# Both pipelines on objects of set `all`, by fixation and by random places in reach and in sight (studies/learned/README.md). Then `make readme`.
learned_all: export PYTHONPATH := $(PYTHONPATH):$(CURDIR)/docs
learned_all: $(READY)
	@$(RUN) --cores $(JOBS) --config meshes="{set: all}" \
	  probing="{strategies: [fixation, random, random_visible]}" -- features_all
	@python -m learned.all_classes results/features
	@python -m visuohaptic.studies.keeping learned all results/learned_all.parquet
	@python -m learned.make_page
	@python docs/make_two_questions.py

# The first touch by ways to choose its place (studies/first_touch/README.md): make first_touch SET=benchmark
first_touch: export PYTHONPATH := $(PYTHONPATH):$(CURDIR)/docs
first_touch: $(READY)
	@$(RUN) --cores $(JOBS) --config meshes="{set: $(SET)}" plugins="[studies/first_touch/plug_in/looking.py]" \
	  -- results/first_touch.parquet
	@python -m visuohaptic.studies.keeping first_touch $(SET)
	@python -m first_touch.make_page

# The same with turned objects: make first_touch_turned SET=benchmark
first_touch_turned: export PYTHONPATH := $(PYTHONPATH):$(CURDIR)/docs
first_touch_turned: $(READY)
	@$(RUN) --cores $(JOBS) --config meshes="{set: $(SET)}" plugins="[studies/first_touch/plug_in/looking.py]" \
	  -- results/first_touch_turned.parquet
	@python -m visuohaptic.studies.keeping first_touch_turned $(SET)
	@python -m first_touch.make_page

# Objects turned about the vertical and in any way, kept with the study (studies/turned/README.md): make turned SET=benchmark
turned: export PYTHONPATH := $(PYTHONPATH):$(CURDIR)/docs
turned: $(READY)
	@$(RUN) --cores $(JOBS) --config meshes="{set: $(SET)}" -- results/turned.parquet
	@python -m visuohaptic.studies.keeping turned $(SET)
	@python -m turned.make_page
	@python docs/make_two_questions.py

# Copies the measured result of a study into its folder, with set, commit and day: make keep STUDY=draws SET=benchmark
keep: $(READY)
	@python -m visuohaptic.studies.keeping $(STUDY) $(SET) $(FILE)

# Simple classifiers of the same touches beside our pipeline (studies/baselines/README.md): make baselines SET=benchmark
baselines: export PYTHONPATH := $(PYTHONPATH):$(CURDIR)/docs
baselines: $(READY)
	@$(RUN) --cores $(JOBS) --config meshes="{set: $(SET)}" \
	  probing="{strategies: [fixation, random, random_visible]}" -- features_all
	@python -m baselines.measure results $(SET)
	@python -m visuohaptic.studies.keeping baselines $(SET) results/baselines.parquet
	@python -m baselines.make_page

# The model of the package, from a default run of set `all` (studies/packaged_model/README.md).
packaged_model: export PYTHONPATH := $(PYTHONPATH):$(CURDIR)/docs
packaged_model: $(READY)
	@$(RUN) --cores $(JOBS) --config meshes="{set: all}" -- features_all
	@python -m packaged_model.measure results/features
	@python -m visuohaptic.studies.keeping packaged_model all results/packaged_model.parquet
	@python -m packaged_model.make_page

bench: $(DEVELOP)
	python -m benchmarks

# Its figures are of a default run, which is made first where it is not current.
readme: export PYTHONPATH := $(PYTHONPATH):$(CURDIR)/docs
readme: $(DEVELOP) report
	python docs/make_readme.py
	python -m variants.make_page
	python -m draws.make_page
	python -m first_touch.make_page
	python -m learned.make_page
	python -m cues.make_page
	python -m turned.make_page
	python -m known_objects.make_page
	python -m baselines.make_page
	python -m touch_agents.make_page
	python -m touch_agents.make_learning_page
	python -m packaged_model.make_page
	python docs/make_claims.py
	python docs/make_study_pictures.py
	python docs/make_two_questions.py
	python docs/make_probing.py
	python -m eye_and_touch.make_page
	python -m touch_curves.make_page
	python docs/make_scaling.py
	python docs/make_short_pages.py
	python docs/make_objects_picture.py
	python docs/make_pads.py
	python docs/make_drawings.py
	python docs/make_overview_picture.py

# The documentation as a site, in build/site; a warning is an error, such as a link that leads nowhere.
site: $(DEVELOP)
	@python docs/make_site.py

# params.yaml, and its schema for editors, from the descriptions in the code; values that you changed are reset.
params: $(READY)
	python docs/make_params.py

# The type checker takes as long as all others, so two run at a time.
lint: $(DEVELOP)
	@$(MAKE) --no-print-directory --jobs 2 lint-types lint-code lint-workflow

lint-types:
	mypy
lint-code:
	ruff format --check .
	ruff check .
	lint-imports
lint-workflow:
	snakefmt --check Snakefile workflow/Snakefile workflow/rules
	snakemake --lint

format: $(DEVELOP)
	ruff format .
	ruff check --fix .
	snakefmt Snakefile workflow/Snakefile workflow/rules

# What a release consists of: sources of all distributions and the wheels that are built from them, tried without the
# clone's own sources.
wheels: $(DEVELOP)
	rm -rf dist
	for project in packages/contourlets packages/meshreaders .; do (cd $$project && hatchling build -t sdist -d "$(CURDIR)/dist"); done
	mkdir dist/unpacked && for source in dist/*.tar.gz; do tar -xzf $$source -C dist/unpacked; done
	for project in dist/unpacked/*; do (cd $$project && hatchling build -t wheel -d "$(CURDIR)/dist"); done
	pip install --quiet --no-deps --no-index --target dist/installed dist/*.whl
	PYTHONPATH="$(CURDIR)/dist/installed" python -m pytest -o "pythonpath=tests packages/contourlets/tests packages/meshreaders/tests" \
	  -m "not slow and not long" tests/exploration tests/evaluation/test_evaluating.py packages/contourlets/tests packages/meshreaders/tests
	PYTHONPATH="$(CURDIR)/dist/installed" python -m pytest -o pythonpath=tests --confcutdir tests/installed tests/installed/tour_from_wheels.py

# Copies version, date, address and authors of release/facts.yaml to every file that has them.
release: $(READY)
	python release/write_files.py

# A draft of the paper as a page; the journal's own PDF is made by its container (release/README.md). Pandoc 3 is needed.
paper:
	cp docs/pictures/overview.png paper/overview.png
	sed 's/\\autoref{[^}]*}/Figure 1/; s/\\label{[^}]*}//' paper/paper.md | $(PANDOC) --from markdown --citeproc --standalone \
	  --embed-resources --resource-path paper --output paper/paper.html

# Pins every package with its hashes; needs `uv` on PATH. requirements.lock is what runs, requirements-dev.lock
# adds what tests: it is made first, as what runs must have versions that fit the tests' packages, too.
PIN := uv pip compile --quiet pyproject.toml --group build --universal --python-version 3.11 --generate-hashes \
  --no-annotate --no-emit-package contourlets --no-emit-package meshreaders \
  --custom-compile-command "make lock"
lock:
	$(PIN) --extra dev --output-file requirements-dev.lock
	$(PIN) --extra workflow --constraint requirements-dev.lock --output-file requirements.lock

clean:
	rm -rf results reports/report.html reports/metrics.json reports/headline.json reports/plots logs .snakemake

$(PACKAGES): requirements.lock
	@./set_up.sh packages
	@touch $@

$(READY): $(PACKAGES) $(PROJECTS)
	@./set_up.sh package
	@touch $@

$(VENV)/.ready-to-try: $(READY) requirements-dev.lock
	@./set_up.sh pytest
	@touch $@

$(DEVELOP): $(READY) requirements-dev.lock
	@./set_up.sh develop
	@touch $@
