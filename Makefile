# `make demo` and `make test` are all that a fresh machine needs; both set up .venv first.
PYTHON ?= python3.11
VENV := .venv
BIN := $(VENV)/bin
BASE := $(VENV)/.base
STAMP := $(VENV)/.installed
PIP := $(BIN)/python -m pip --quiet --disable-pip-version-check
LIBRARIES := build/libraries

# Byte code is kept, whatever the user's shell says: without it each of the thousands of processes that tests start
# would compile numpy's and numba's sources anew, which is half of its time.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: browser shells demo docs test test-slow lint bench setup wheel clean

setup: $(STAMP)

# what a user gets; byte code is written when a module is used
$(BASE): pyproject.toml setup.py constraints.txt
	@command -v $(PYTHON) >/dev/null || { echo "Python 3.11 is needed: set PYTHON=/path/to/python3.11" >&2; exit 1; }
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(PIP) install --no-compile -c constraints.txt -e .
	touch $(BASE)

$(STAMP): $(BASE)
	$(PIP) install -c constraints.txt -e '.[test]'
	touch $(STAMP)

# the first run compiles the kernels that it needs
demo: $(BASE)
	$(BIN)/gcodesim run programs/bracket.nc --cell cells/bracket.yaml --out out/demo

# for x86-64 Linux, with compiled kernels; needs a C compiler
wheel: setup
	$(BIN)/python scripts/make_libraries.py $(LIBRARIES)
	GCODESIM_LIBRARIES=$(LIBRARIES) $(PIP) wheel --no-deps --no-build-isolation -w dist .

lint: setup
	$(BIN)/ruff check gcodesim tests benchmarks scripts programs
	$(BIN)/mypy -n 2
	$(BIN)/lint-imports --no-cache

test: lint browser shells
	$(BIN)/gcodesim warm-up
	$(BIN)/gcodesim test programs -j 2
	$(BIN)/python -m pytest -n 2 --dist loadfile

# pybullet_industrial, with which ours is compared, asks for a numpy below 2 and works with a newer one.
test-slow: setup browser
	$(PIP) install -c constraints.txt -e '.[test,test-slow]'
	$(PIP) install --no-deps pybullet_industrial==1.0.4
	$(BIN)/python -m pytest -n 2 -m slow -rs

# Tests of pages open them in a real browser. It is installed where that is allowed: on Debian, as root, with a network.
# Elsewhere those tests are reported by name as not run.
browser:
	@scripts/install_debian.sh chromium || echo "chromium is not installed and could not be: tests of pages will not run" >&2

# Tests of completion ask real shells.
shells:
	@scripts/install_debian.sh bash zsh fish || echo "zsh or fish could not be installed: tests of completion there will not run" >&2

# The site of the documentation, in build/site; a broken link or a page without a place in the navigation fails.
docs: setup
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build
	@echo "open build/site/index.html; to search in it: $(BIN)/python -m http.server --directory build/site"

# `make bench OLD=../before` also runs the same commands in another checkout, by turns.
bench: setup
	$(BIN)/python -m benchmarks
	$(if $(OLD),$(BIN)/python -m benchmarks.against $(OLD))

clean:
	rm -rf $(VENV) out build *.egg-info
