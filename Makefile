# Two commands on a fresh machine: `make demo` and `make test`. Each sets up what it needs in .venv.
PYTHON ?= python3
PICTURE := tests/data/kodim23.png
# What `make bench` measures, and where the results go: make bench PICTURES=~/photos OUT=results
PICTURES ?= tests/data
OUT ?= bench-out

VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
STAMP := $(VENV)/.stamp

.DEFAULT_GOAL := help
.PHONY: help setup demo test bench lint format clean

help:
	@echo "make demo    encode and decode a bundled photograph and measure the difference"
	@echo "make test    run the tests"
	@echo "make bench   measure against JPEG, WebP, JPEG XL and AVIF: make bench PICTURES=DIR OUT=DIR"
	@echo "make lint    ruff and mypy;  make format  ruff's formatter;  make clean  remove what was built"

setup: $(STAMP)

# Depends on what is compiled and on what is installed: Python files are used in place.
$(STAMP): pyproject.toml constraints.txt CMakeLists.txt $(wildcard native/*/*)
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "sgicodec needs Python 3.11 or newer: make PYTHON=/path/to/python3"; exit 1; }
	@for compiler in $${CXX:-c++ g++ clang++}; do command -v $$compiler >/dev/null && exit 0; done; \
	  echo "sgicodec needs a C++ compiler: install g++ or clang++ (Debian: apt-get install g++), or name one in CXX"; \
	  exit 1
	@echo "Setting up $(VENV); the first time takes minutes, for torch is large."
	@$(PYTHON) -m venv $(VENV)
	@$(PIP) install -c constraints.txt scikit-build-core
	@# the build back end knows whether this machine's cmake and ninja will do
	@$(PIP) install -c constraints.txt nanobind $$($(BIN)/python -c \
	  'from scikit_build_core.build import get_requires_for_build_editable as missing; print(*missing())')
	@$(PIP) install -c constraints.txt --no-build-isolation -e '.[test,lint,bench]' >$(VENV)/build.log 2>&1 || \
	  { grep -m 1 'sgicodec needs' $(VENV)/build.log || tail -n 20 $(VENV)/build.log; \
	    echo "The set-up failed; all of it is told in $(VENV)/build.log"; exit 1; }
	@touch $@

demo: setup
	@mkdir -p demo-out
	$(BIN)/sgi encode $(PICTURE) demo-out/kodim23.sgi -q 50 -f
	$(BIN)/sgi info demo-out/kodim23.sgi
	$(BIN)/sgi decode demo-out/kodim23.sgi demo-out/kodim23.png -f
	$(BIN)/sgi decode demo-out/kodim23.sgi demo-out/eye-4x.png --region 96,176,160,120 --scale 4 -f
	$(BIN)/sgi compare $(PICTURE) demo-out/kodim23.png

test: setup
	$(BIN)/python -m pytest

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

format: setup
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: setup
	$(BIN)/python -m benchmarks raster
	$(BIN)/sgi bench $(PICTURES) --out $(OUT)

clean:
	rm -rf $(VENV) build demo-out bench-out fuzz-out .pytest_cache .hypothesis .mypy_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
