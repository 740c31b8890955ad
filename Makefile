# Everything a person runs. `make demo` and `make test` set up what they need; nothing else is required
# than Python 3.11, make and git.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
export HF_HUB_OFFLINE := 1
SIDE_BY_SIDE = -n $(or $(WORKERS),logical) --maxprocesses 8 --dist worksteal

.DEFAULT_GOAL := help
.PHONY: help setup demo test test-slow test-fast test-thorough test-hosts up down check-deploy lint bench bench-decode bench-faults bench-attack train-mini qc clean pages
.PHONY: docs docs-serve lock licenses sbom

help: ## list the targets
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 16

setup: $(READY) ## create .venv with everything installed

$(READY): pyproject.toml deploy/constraints.txt
	@$(PYTHON) -c 'import sys; v = sys.version_info[:2]; sys.exit(0 if (3, 11) <= v < (3, 14) else f"Python 3.11 to 3.13 is needed, found {v[0]}.{v[1]}: make PYTHON=python3.11 ...")'
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@echo 'Installing everything into $(VENV): about 3 GB and three minutes, once.'
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade pip
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint deploy/constraints.txt -e '.[dev]'
	@touch $@

demo: setup ## three bundled reports become scenarios; prints where to look and what to do next
	@$(BIN)/python -m flows.demo

test: setup ## the tests but the slow ones, as many at once as there are cores (WORKERS=2)
	$(BIN)/python -m pytest -m "not slow" $(SIDE_BY_SIDE)

test-slow: setup ## the rest: programs killed for real, wheels and plugins in fresh environments, browsers, trainings
	$(BIN)/python -m pytest -m slow $(SIDE_BY_SIDE)

test-thorough: setup ## the property tests with many more examples: before a release, or after a change to the planner
	SGCAD_THOROUGH=1 $(BIN)/python -m pytest tests/sgcad_core/planner tests/sgcad_core/formats $(SIDE_BY_SIDE)

test-fast: test ## what `make test` was called before

up: setup ## server, worker, MLflow and deployments on this machine (UP="--server-port 4300 ...")
	$(BIN)/python -m deploy.local up $(UP)

down: ## end what `make up` started; results and logs stay
	$(BIN)/python -m deploy.local down $(UP)

check-deploy: setup ## every service started for real, and the containers' services without containers
	SGCAD_SERVICES=1 $(BIN)/python -m pytest tests/deploy -q
	$(BIN)/python -m research.checks.compose_services

bench: setup ## time and share of every stage over the demo reports
	$(BIN)/python -m research.benchmarks.services.stages

bench-decode: setup ## context-aware decoding against greedy, in ratios
	$(BIN)/python -m research.benchmarks.decoding.decode

bench-faults: setup ## kill -9 at random points, full disks, locked databases; then the same again (KILLS=100 SEED=1)
	$(BIN)/python -m research.benchmarks.faults --kills $(or $(KILLS),100) --seed $(or $(SEED),1)

bench-attack: setup ## hostile texts, pictures, PDFs, plugins and desk requests; kills, disasters (COUNT=10000 KINDS=picture,pdf)
	$(BIN)/python -m research.benchmarks.attack $(if $(COUNT),--count $(COUNT)) $(if $(KINDS),--kinds "$(KINDS)")

train-mini: setup ## train the embedded model (DEVICE=cpu|cuda BUDGET=seconds); goes on from its checkpoint
	$(BIN)/python -m research.training.train --out runs/training --device $(or $(DEVICE),cpu) --budget $(or $(BUDGET),3600)

.venv-qc/.ready:
	$(PYTHON) -m venv .venv-qc
	.venv-qc/bin/python -m pip install --quiet --disable-pip-version-check asam-qc-opendrive==1.0.0 asam-qc-openscenarioxml==1.0.0
	@touch $@

qc: .venv-qc/.ready ## ASAM's checkers over RUNS=runs
	.venv-qc/bin/python research/checks/asam_checkers.py $(or $(RUNS),runs)

docs: setup ## the documentation as a site in site/, links checked
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint deploy/constraints.txt -e '.[docs]'
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict

docs-serve: docs ## the same at http://127.0.0.1:8000, rebuilt while you write
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs serve --livereload

.venv-tools/.ready:
	$(PYTHON) -m venv .venv-tools
	.venv-tools/bin/python -m pip install --quiet --disable-pip-version-check pip-licenses==5.5.5 cyclonedx-bom==7.5.0
	@touch $@

lock: setup ## deploy/requirements.lock: every package of the image with version and digest
	$(BIN)/python -m research.checks.write_lock

licenses: setup .venv-tools/.ready ## licenses.csv: every installed package with version and licence
	.venv-tools/bin/pip-licenses --python $(BIN)/python --format csv --with-urls --output-file licenses.csv

sbom: setup .venv-tools/.ready ## sbom.json: every installed package, in CycloneDX's form
	.venv-tools/bin/cyclonedx-py environment $(BIN)/python --output-file sbom.json

pages: setup ## headless Chromium looks at MLflow's pages (DATABASE=runs/mlflow.db EXPERIMENT=study/alpha SHOTS=folder)
	$(BIN)/python -m research.checks.mlflow_pages $(or $(DATABASE),runs/mlflow.db) $(if $(EXPERIMENT),--experiment $(EXPERIMENT)) $(if $(SHOTS),--shots $(SHOTS))

clean: ## remove environments and caches, never results
	rm -rf $(VENV) .venv-qc .venv-tools site .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache

test-hosts: setup ## a study on two Dask workers that lose network and power (Linux, root, PostgreSQL and iproute2; else skipped)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint deploy/constraints.txt -e '.[dev,hosts]' 'moto[s3]>=5.1'
	$(BIN)/python -m tests.hosts.run

lint: setup ## ruff (rules and format), mypy, import-linter
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
