# make          set up, then the default results
# make test     set up, then the tests
# make setup    set up alone: .venv from requirements.lock, libraries for headless OpenGL
# make bench    speed against other people's implementations
# make lint     what CI checks beside the tests
# make lock     fix versions and hashes anew (needs a network)

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
CORES ?= all

.PHONY: all setup test bench lint lock

all: setup
	$(BIN)/snakemake --cores $(CORES)

setup: $(VENV)/.complete
	@sh tools/system-packages.sh

# the stamp is the last thing that is written, so a set-up that was cut off is done again
$(VENV)/.complete: requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "miburi needs Python 3.11 or later, $(PYTHON) is $$($(PYTHON) -V 2>&1); try make PYTHON=python3.11" >&2; exit 1; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || \
		{ echo "the modules venv and ensurepip are missing; on Debian: apt-get install python3-venv" >&2; exit 1; }
	rm -rf $(VENV)
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@

test: setup
	$(BIN)/python -m pytest -n 2 --dist loadgroup

bench: setup
	@for bench in benchmarks/bench_*.py; do echo; echo "## $$bench"; $(BIN)/python $$bench || exit 1; done

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/snakefmt --check Snakefile workflow
	$(BIN)/python tools/lint_snakemake.py
	$(BIN)/python tools/config_docs.py --check

lock:
	$(PYTHON) -m venv build/lock
	build/lock/bin/python -m pip install --quiet uv
	build/lock/bin/uv pip compile requirements.in --override overrides.txt --upgrade \
		--python-version 3.11 --python-platform linux --generate-hashes \
		--no-emit-index-url --no-header --no-annotate --quiet -o requirements.lock
