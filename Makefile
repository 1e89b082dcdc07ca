# make          set up, then the default results
# make test     set up, then the tests
# make setup    set up alone: .venv from requirements.lock, libraries for headless OpenGL, venv
# make bench    speed against other people's implementations
# make lint     what CI checks beside the tests
# make page     build the pages' script and style from web/ (needs Node)
# make lock     fix versions and hashes anew (needs a network)
# make clean    remove .venv and caches; results and recordings stay
#
# make CORES=4 PYTHON=/usr/local/bin/python3.12 ... for other than all cores and the first Python found

NEW_ENOUGH := import sys; sys.exit(sys.version_info < (3, 11))
PYTHON ?= $(shell for p in python3.11 python3 python3.12 python3.13; do \
	$$p -c '$(NEW_ENOUGH)' 2>/dev/null && echo $$p && break; done)
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --quiet --disable-pip-version-check
# on all cores, which pip does not; and at all, because where PYTHONDONTWRITEBYTECODE is set, no job would keep it;
# some packages hold files for other Pythons, which cannot be compiled and are not needed
BYTECODE = { $(BIN)/python -m compileall -q -j 0 -x '/tests?/' $(VENV)/lib src >/dev/null || true; }
CORES ?= all
BENCHMARKS ?= $(wildcard benchmarks/bench_*.py)

.PHONY: all setup system test bench lint page lock clean

all: setup
	$(BIN)/snakemake --cores $(CORES)

setup: system $(VENV)/.complete

system:
	@[ -n "$(PYTHON)" ] || { echo "miburi needs Python 3.11 or later and found none;" \
		"name one: make PYTHON=/path/to/python3.11" >&2; exit 1; }
	@$(PYTHON) -c '$(NEW_ENOUGH)' || { echo "miburi needs Python 3.11 or later," \
		"$(PYTHON) is not: make PYTHON=/path/to/python3.11" >&2; exit 1; }
	@PYTHON=$(PYTHON) sh tools/system-packages.sh

# The copy of the lock is the last thing that is written: a set-up that was cut off begins again from nothing.
# A changed lock is installed over what is there; a lock that is only newer costs nothing. pip uses one core: two of
# them install half of the lock each, and build what has to be built apart from what the other is installing.
$(VENV)/.lock: requirements.lock | system
	@if [ ! -e $@ ]; then rm -rf $(VENV) && $(PYTHON) -m venv $(VENV); fi
	@if cmp -s $< $@; then touch $@; else \
		echo "installing requirements.lock into $(VENV): a minute or two"; rm -f $@*; \
		awk '/^[a-z]/ {n++} {print >> ("$@.half" n % 2)}' $< && \
		printf '%s\n' $@.half0 $@.half1 | \
			xargs -P 2 -I{} $(PIP) install --no-deps --no-compile --use-pep517 --require-hashes -r {} && \
		rm $@.half? && $(BYTECODE) && cp $< $@.part && mv $@.part $@; fi

$(VENV)/.complete: $(VENV)/.lock pyproject.toml
	@$(PIP) install --no-deps --no-build-isolation --editable .
	@touch $@

test: setup
	$(BIN)/python -m pytest -n 2 --dist loadgroup --no-loadscope-reorder

bench: setup
	@for bench in $(BENCHMARKS); do echo; echo "## $$bench"; $(BIN)/python $$bench || exit 1; done

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/snakefmt --check Snakefile workflow
	$(BIN)/python tools/lint_snakemake.py
	$(BIN)/python tools/config_docs.py --check

web/node_modules/.complete: web/package.json web/package-lock.json
	cd web && npm ci --silent && touch node_modules/.complete

page: web/node_modules/.complete
	cd web && npm run --silent check && npm run --silent test && npm run --silent build

# nothing in the lock may need a compiler; one package has no wheel, but is Python alone
lock: | system
	$(PYTHON) -m venv build/lock
	build/lock/bin/python -m pip install --quiet --disable-pip-version-check uv
	build/lock/bin/uv pip compile requirements.in --override overrides.txt --upgrade \
		--python-version 3.11 --python-platform linux --generate-hashes \
		--only-binary :all: --no-binary connection-pool \
		--no-emit-index-url --no-header --no-annotate --quiet -o requirements.lock

clean:
	rm -rf $(VENV) build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	@echo "results/, data/raw/ and .snakemake/ are left as they are"
