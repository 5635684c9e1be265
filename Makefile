# The two commands that everything depends on: `make run` and `make test`. Both need only Python >= 3.11 with venv, and make.
STUDY  ?= quickstart
CORES  ?= all
PROFILE ?= default
PYTHON ?= python3
BIN    := .venv/bin
export PYTHONDONTWRITEBYTECODE :=
export PIP_DISABLE_PIP_VERSION_CHECK := 1

.PHONY: run check test tests outside coverage soak kernels slurm cloud referees lint docs bench lock schema clean help
.DEFAULT_GOAL := help

help:  ## list the targets
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 10

# a verification compares with independent methods, which need more than the rest
run: .venv/$(if $(shell grep -s '^verification:' "config/$(STUDY).yaml"),dev,run).stamp  ## run one study to its report: make run [STUDY=quickstart] [CORES=all]
	@$(BIN)/meecontact run "$(STUDY)" --cores "$(CORES)" --profile "$(PROFILE)"

# types take one core for a minute where nothing is cached: beside the tests
check: .venv/dev.stamp  ## linters, types, import contracts and the tests of moments; two minutes on two cores, three and a half where no types are cached
	@$(MAKE) --no-print-directory --jobs=2 lint tests LAYERS='-m "not slow and not soak"'

test: .venv/dev.stamp .venv/referees.stamp  ## linters, types, import contract and every test; six minutes on two cores that do nothing else
	@$(MAKE) --no-print-directory --jobs=2 lint tests

outside: .venv/dev.stamp .venv/referees.stamp  ## the tests that need Chromium, Node.js, ncdump or ncks
	$(BIN)/python -m pytest -n auto -m "needs and not soak and not slurm"

tests: .venv/dev.stamp  ## every test, without the linters
	$(BIN)/python -m pytest -n auto $(LAYERS)

coverage: .venv/dev.stamp .venv/referees.stamp  ## lines and branches that the tests reach, jobs of their runs included; takes twice as long
	@rm -rf build/coverage
	$(BIN)/python -m coverage run -m pytest -n auto
	$(BIN)/python -m coverage combine -q
	$(BIN)/python -m coverage report

soak: .venv/dev.stamp  ## a hundred kills, ten thousand hostile files, every check of scikit-learn, every case of a sampled product, every kernel; takes an hour on two cores
	MEECONTACT_SOAK=1 $(BIN)/python -m pytest -n auto --dist worksteal -m "soak or soakable"
	@$(MAKE) --no-print-directory kernels THREADS=1 ROOMS="$(DIGITS)" LAYERS='-m "not slurm and not cloud"'
	@$(MAKE) --no-print-directory kernels THREADS=2 ROOMS="$(DIGITS)" LAYERS='-m "not slurm and not cloud"'

# where digits matter: a few files, and for the soak whole rooms
ROOMS = tests/workflow/design/test_polish.py tests/workflow/study/test_categories.py tests/surrogate/search tests/test_examples.py
DIGITS = tests/surrogate tests/workflow/design tests/workflow/study tests/test_examples.py
THREADS = 1
kernels: .venv/dev.stamp  ## the rooms where digits matter, under three kinds of OpenBLAS kernel that this processor has
	@count=0; for kernel in Haswell SkylakeX Nehalem Sandybridge; do \
	  [ $$count -lt 3 ] || break; \
	  export OPENBLAS_CORETYPE=$$kernel OMP_NUM_THREADS=$(THREADS); \
	  if $(BIN)/python -c 'import numpy; numpy.linalg.cholesky(numpy.eye(64) @ numpy.eye(64))' 2>/dev/null; then \
	    echo "$$kernel, threads: $(THREADS)"; count=$$((count + 1)); \
	    $(BIN)/python -m pytest -n auto $(LAYERS) $(ROOMS) || exit 1; \
	  else echo "$$kernel: not run, as this processor lacks it"; fi; \
	done

slurm: .venv/dev.stamp  ## the quickstart through a Slurm on this machine, compared byte for byte with a local run
	$(BIN)/python -m pytest -m slurm tests/slurm

cloud: .venv/dev.stamp .venv/cloud.stamp  ## a small study without a shared disk: a bucket, and a folder of its own for every job
	$(BIN)/python -m pytest -m cloud tests/cloud

referees: .venv/referees.stamp  ## what public referees say of a run's netCDF files [STUDY=quickstart]
	@.venv/referees/bin/python tests/referees.py "results/$(STUDY)"

lint: .venv/dev.stamp  ## ruff, mypy --strict and the import contract
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: .venv/bench.stamp  ## measure side by side with rivals: results/benchmarks.json [BENCH="exact surrogates"]
	OMP_NUM_THREADS=1 .venv/bench/bin/python -m benchmarks $(BENCH)

lock: .venv/dev.stamp  ## pin the dependencies anew, with hashes and without download addresses
	$(BIN)/uv pip compile -q --upgrade --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
	  --custom-compile-command "make lock" --extra build --extra run pyproject.toml -o requirements/run.txt
	$(BIN)/uv pip compile -q --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
	  --custom-compile-command "make lock" --extra build --extra run --extra slurm -c requirements/run.txt pyproject.toml -o requirements/slurm.txt
	$(BIN)/uv pip compile -q --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
	  --custom-compile-command "make lock" --extra build --extra run --extra slurm --extra docs --extra dev -c requirements/run.txt pyproject.toml -o requirements/dev.txt
	$(BIN)/uv pip compile -q --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
	  --custom-compile-command "make lock" --extra build --extra run --extra cloud pyproject.toml -o requirements/cloud.txt
	$(BIN)/uv pip compile -q --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
	  --custom-compile-command "make lock" -c requirements/cloud.txt requirements/bucket.in -o requirements/bucket.txt
	$(BIN)/uv pip compile -q --upgrade --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
	  --custom-compile-command "make lock" requirements/referees.in -o requirements/referees.txt
	$(BIN)/uv pip compile -q --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
	  --custom-compile-command "make lock" --extra build --extra run -c requirements/run.txt pyproject.toml requirements/bench.in -o requirements/bench.txt

docs: .venv/dev.stamp  ## run the quickstart, draw the figures and the calculator, and build the site into build/docs
	$(BIN)/meecontact run quickstart
	@echo "drawing the figures of gallery and tutorials, and the calculator (half a minute)"
	@$(BIN)/python -m docs
	@echo "building the site (20 s)"
	@$(BIN)/python -m mkdocs build --strict --quiet --site-dir build/docs
	@echo "documentation: build/docs/index.html"

schema: .venv/run.stamp  ## write the JSON schema and the documented default of a study from the model
	$(BIN)/python -m workflow.study.schema

# a Python without venv or pip leaves half an environment: the next `make` mends it, since the stamp is missing
.venv/python.stamp:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "Python >= 3.11 is needed; set PYTHON=/path/to/one"; exit 2; }
	@$(PYTHON) -m venv .venv || { echo "$(PYTHON) cannot make an environment (Debian: python3-venv), or this path cannot hold one; set PYTHON=/path/to/another"; exit 2; }
	@$(BIN)/python -c 'import pip' || { echo "the environment has no pip (Debian: python3-venv); set PYTHON=/path/to/another"; exit 2; }
	@touch $@

# the run's own, and the rivals of its surrogates
.venv/bench.stamp: requirements/bench.txt pyproject.toml | .venv/python.stamp
	@echo "installing the rivals ($<) into .venv/bench"
	@$(PYTHON) -m venv .venv/bench
	@.venv/bench/bin/python -m pip install -q --require-hashes -r $<
	@.venv/bench/bin/python -m pip install -q --no-deps --no-build-isolation -e .
	@touch $@

# their needs and ours differ: an environment of their own
.venv/referees.stamp: requirements/referees.txt | .venv/python.stamp
	@echo "installing the referees ($<) into .venv/referees"
	@$(PYTHON) -m venv .venv/referees
	@.venv/referees/bin/python -m pip install -q --require-hashes -r $<
	@touch $@

# what runs without a shared disk, and a bucket on this machine
.venv/cloud.stamp: requirements/cloud.txt requirements/bucket.txt pyproject.toml | .venv/python.stamp
	@echo "installing the storage and its plugins ($<) into .venv/cloud"
	@$(PYTHON) -m venv .venv/cloud
	@.venv/cloud/bin/python -m pip install -q --require-hashes -r $< -r requirements/bucket.txt
	@.venv/cloud/bin/python -m pip install -q --no-deps --no-build-isolation -e .
	@touch $@

# one installation at a time into one environment, also under `make -j`
.venv/dev.stamp: | .venv/run.stamp

.venv/%.stamp: requirements/%.txt pyproject.toml | .venv/python.stamp
	@echo "installing the pinned dependencies ($<) into .venv"
	@$(BIN)/python -m pip install -q --require-hashes -r $<
	@$(BIN)/python -m pip install -q --no-deps --no-build-isolation -e .
	@touch $@

clean:  ## remove what runs have made (results, logs), not .venv
	rm -rf results logs .snakemake
