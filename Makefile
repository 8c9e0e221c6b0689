# Every target brings what it needs; `make help` lists them.
PYTHON ?= python3
BIN := .venv/bin
OUT := out
COMPILE := $(BIN)/uv pip compile --quiet --upgrade --generate-hashes --python-version 3.11 --custom-compile-command 'make lock'

.DEFAULT_GOAL := help
.PHONY: help setup stats figures docs browser test bench bench-record bench-http bench-checks lint container container-test lock clean

help:  ## list the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:[^#]*## /\t/' | expand -t 16

setup: .venv/ready  ## bring the Debian packages and make .venv with the command samplerscope

.venv/ready: requirements-dev.lock pyproject.toml lavapipe/install.sh
	lavapipe/install.sh
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes --requirement requirements-dev.lock
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --editable .
	@touch $@

stats: setup  ## the main job: six techniques of EON over 64 angles; table here, figure and data in out/
	$(BIN)/samplerscope figure eon-11 -o $(OUT)/eon-11.png -o $(OUT)/eon-11.svg -o $(OUT)/eon-11.json

figures: setup  ## every figure of the papers, as PNG, SVG, Vega-Lite and JSON in out/
	$(BIN)/samplerscope figure eon-table-1 -o $(OUT)/eon-table-1.txt -o $(OUT)/eon-table-1.json
	for name in eon-3 eon-6 eon-7 eon-11 eon-13 eon-convergence kurt-2 kurt-3 kurt-sampling; do \
	    $(BIN)/samplerscope figure $$name -o $(OUT)/$$name.png -o $(OUT)/$$name.svg \
	        -o $(OUT)/$$name.vl.json -o $(OUT)/$$name.json || exit; \
	done

docs: setup  ## write docs/models.md from the heads of the shader files and from the reference
	$(BIN)/python -m service.models_page docs/models.md

browser:  ## bring Debian's Chromium, which the tests of the page drive
	tests/page/install-chromium.sh

test: setup browser  ## prove it right, on the real driver
	$(BIN)/pytest --numprocesses 2 --dist loadfile

bench: setup  ## speed and calibration beside NumPy, Numba, Dr.Jit and C++, brought on demand; minutes
	$(BIN)/python tests/benchmarks/run.py

bench-record: setup  ## measure the ratios to the peers and make them the recorded ones; on a quiet machine
	$(BIN)/python tests/benchmarks/run.py --ratios-only --rounds 15 --record

lint: setup  ## style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

bench-http: setup  ## load on the HTTP service, and thousands of generated requests; minutes
	$(BIN)/python -m tests.benchmarks.http_load
	SAMPLERSCOPE_TEST_CASES=300 $(BIN)/pytest -s --timeout 1800 tests/service/api/test_openapi.py

bench-checks: setup  ## the battery on every pair of the catalogue, and its false alarms in a thousand runs; an hour
	$(BIN)/python -m tests.benchmarks.catalogue_checks
	$(BIN)/python -m tests.benchmarks.false_alarms

container:  ## build the image, with docker or else with buildah
	.ci/container

container-test: setup container  ## drive the image from outside, hardened as in production
	$(BIN)/pytest tests/container -s

lock: setup  ## resolve the dependencies anew: requirements.lock to run, requirements-dev.lock to test
	$(BIN)/pip install --quiet 'uv>=0.8,<1'
	$(COMPILE) --output-file requirements.lock pyproject.toml
	$(COMPILE) --extra dev --constraint requirements.lock --output-file requirements-dev.lock pyproject.toml

clean:  ## remove .venv and out/
	rm -rf .venv $(OUT)
