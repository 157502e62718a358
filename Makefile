# Two commands on a fresh machine: `make demo` and `make test`. Each sets up what it needs in .venv.
PYTHON ?= python3
PICTURE := tests/data/kodim23.png
# What `make bench` measures, and where the results go: make bench PICTURES=~/photos OUT=results
PICTURES ?= tests/data
OUT ?= bench-out

VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
# Two levels of set-up: what a user has, with `sgi compare` and `sgi bench`; and what tests and lint need besides.
USER_STAMP := $(VENV)/.user
DEV_STAMP := $(VENV)/.dev
CXX_FILES := $(shell find native gdal tests viewer/wasm cuda -name '*.?pp') $(wildcard include/*.h programs/*.[ch] gdk-pixbuf/*.c examples/*.c*)
# What is compiled and what is installed: Python files are used in place.
INPUTS := pyproject.toml constraints.txt CMakeLists.txt $(shell find native cuda share -type f) \
  $(shell find sgicodec/bitstream -name '*.bin')

.DEFAULT_GOAL := help
.PHONY: viewer test-viewer help setup setup-dev demo test test-all first-minutes asan asan-kernels fuzz bench lint format wheel release clean

help:
	@echo "make demo       encode and decode a bundled photograph and measure the difference"
	@echo "make test       run the tests, but for the slow ones, in four minutes on two processors"
	@echo "make test-all   run all tests, with all examples; ARGS='-k nodata' chooses, for both"
	@echo "make first-minutes  what newcomers do first, each in a new environment with a wheel: times to first success"
	@echo "make viewer     compile the viewer's decoder to WebAssembly; make test-viewer: and test the viewer in Chromium"
	@echo "make fuzz       decode hostile streams for a minute: make fuzz SECONDS=3600"
	@echo "make asan       compile with AddressSanitizer and UBSan, run tests and fuzz with all instruction sets"
	@echo "make asan-kernels  the same of the GPU's kernels alone, in a minute"
	@echo "make lint       check with ruff, mypy and clang-format"
	@echo "make format     let ruff format"
	@echo "make bench      measure against JPEG, WebP, JPEG XL and AVIF: make bench PICTURES=DIR OUT=DIR"
	@echo "make setup      install into $(VENV) what demo and bench need; make setup-dev: what tests and lint need"
	@echo "make wheel      pack a wheel for this Python and test it in a new environment (Linux)"
	@echo "make release    make all that a release has in dist/, and try it: make release PYTHONS='python3.11 python3.12'"
	@echo "make clean      remove what was built"

setup: $(USER_STAMP)

setup-dev: $(DEV_STAMP)

$(USER_STAMP): $(INPUTS)
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "sgicodec needs Python 3.11 or newer: make PYTHON=/path/to/python3"; exit 1; }
	@for compiler in $${CXX:-c++ g++ clang++}; do command -v $$compiler >/dev/null && exit 0; done; \
	  echo "sgicodec needs a C++ compiler: install g++ or clang++ (Debian: apt-get install g++), or name one in CXX"; \
	  exit 1
	@echo "Setting up $(VENV); the first time takes minutes."
	@$(PYTHON) -m venv $(VENV)
	@$(PIP) install -c constraints.txt scikit-build-core
	@# the build back end knows whether this machine's cmake and ninja will do
	@$(PIP) install -c constraints.txt nanobind $$($(BIN)/python -c \
	  'from scikit_build_core.build import get_requires_for_build_editable as missing; print(*missing())')
	@$(call install,bench$(comma)serve)
	@touch $@

# Builds on the one above: what is compiled stays, the extras are added. torch is large.
$(DEV_STAMP): $(USER_STAMP)
	@echo "Adding what tests and lint need to $(VENV)."
	@$(call install,bench$(comma)cluster$(comma)lint$(comma)serve$(comma)test)
	@touch $@

comma := ,
install = $(PIP) install -c constraints.txt --no-build-isolation -e '.[$(1)]' >$(VENV)/build.log 2>&1 || \
  { grep -m 1 'sgicodec needs' $(VENV)/build.log || tail -n 20 $(VENV)/build.log; \
    echo "The set-up failed; its whole output is in $(VENV)/build.log"; exit 1; }

demo: setup
	@mkdir -p demo-out
	$(BIN)/sgi encode $(PICTURE) demo-out/kodim23.sgi -q 50 -f
	$(BIN)/sgi info demo-out/kodim23.sgi --survey
	$(BIN)/sgi decode demo-out/kodim23.sgi demo-out/kodim23.png -f
	$(BIN)/sgi decode demo-out/kodim23.sgi demo-out/eye-4x.png --region 96,176,160,120 --scale 4 -f
	$(BIN)/sgi compare $(PICTURE) demo-out/kodim23.png

# As many workers as there are processors; each takes tests from the others when its own are done.
PYTEST := $(BIN)/python -m pytest --numprocesses auto --dist worksteal

test: setup-dev
	$(PYTEST) -m 'not slow' --hypothesis-profile fast $(ARGS)

test-all: setup-dev
	$(PYTEST) --hypothesis-profile full $(ARGS)

# One after the other, so that their times are their own. What is missing for the viewer is skipped.
first-minutes: setup-dev
	rm -rf build/first-minutes
	$(PIP) wheel --no-deps -C build-dir=build/first-minutes/objects -w build/first-minutes .
	$(BIN)/python -m pytest -s tests/system/first_minutes -o tmp_path_retention_policy=failed --wheel $$(echo build/first-minutes/*.whl) $(ARGS)

# Streams that end in a new way are kept in build/fuzz, with the seeds of all runs in its log.txt.
SECONDS ?= 60
FUZZ := tests/support/fuzz.py --seconds $(SECONDS)

fuzz: setup-dev
	PYTHONPATH=tests/support $(BIN)/python $(FUZZ) $(ARGS)

# What native code does. Tests that start processes of other kinds, or bound the address space, skip themselves.
CHECKED := tests/conformance tests/unit/bitstream tests/unit/cuda tests/unit/decoder tests/unit/fit tests/unit/image \
  tests/unit/metrics/test_visual_score.py tests/unit/model tests/unit/native tests/unit/raster tests/unit/rdoq
asan: setup-dev
	$(BIN)/python tests/support/sanitized.py -m pytest -m 'not slow' --hypothesis-profile fast $(CHECKED) $(ARGS)
	$(BIN)/python tests/support/sanitized.py $(FUZZ) --memory 0 --patience 100
	PYTHONPATH=tests/support $(BIN)/python tests/support/fuzz_library.py --seconds $(SECONDS)

# The same of the GPU's kernels alone, which need no other build of the extension: a minute.
KERNELS := tests/unit/cuda/test_gpu.py tests/unit/raster/test_backend.py \
  tests/unit/fit/test_gpu_fit.py tests/unit/fit/test_feature_step.py
asan-kernels: setup-dev
	LD_PRELOAD="$$(g++ -print-file-name=libasan.so):$$(g++ -print-file-name=libstdc++.so)" CXX=g++ \
	  ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1 \
	  $(BIN)/python -m pytest -q -p no:cacheprovider -m 'not slow' --hypothesis-profile fast $(KERNELS) $(ARGS)

lint: setup-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/clang-format --dry-run -Werror $(CXX_FILES)

format: setup-dev
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(BIN)/clang-format -i $(CXX_FILES)

bench: setup
	$(BIN)/python -m benchmarks raster
	$(BIN)/sgi bench $(PICTURES) --out $(OUT)

# Apart from .venv: what a user gets, without compiler, sources or anything that was installed before.
wheel:
	@if command -v emcmake >/dev/null; then $(MAKE) viewer; else echo "No Emscripten: the viewer will have the server draw"; fi
	mkdir -p dist
	packaging/wheel.sh . dist $(PYTHON)

# Wheels for each of these, and all else that a release has.
PYTHONS ?= $(PYTHON)
release:
	packaging/release.sh $(PYTHONS)

clean:
	rm -rf $(VENV) build dist sgicodec/_native.pyi viewer/src/wasm viewer/node_modules demo-out bench-out fuzz-out .pytest_cache .hypothesis .mypy_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# The viewer's decoder: libsgi as WebAssembly, with vectors and, for browsers without them, with scalars.
WASM := viewer/src/wasm/sgi.wasm viewer/src/wasm/sgi-scalar.wasm

viewer: $(WASM)

viewer/src/wasm/sgi.wasm: SIMD := -msimd128
$(WASM): viewer/src/wasm/%.wasm: $(wildcard viewer/wasm/*) $(filter %pp,$(INPUTS))
	@command -v emcmake >/dev/null || \
	  { echo "The viewer's decoder needs Emscripten and CMake (Debian: apt-get install emscripten cmake)"; exit 1; }
	@mkdir -p $(@D) build
	emcmake cmake -S . -B build/wasm/$* -DCMAKE_BUILD_TYPE=Release -DSGI_WASM_NAME=$* \
	  -DCMAKE_CXX_FLAGS="-fwasm-exceptions $(SIMD)" >build/wasm-$*.log 2>&1
	cmake --build build/wasm/$* >>build/wasm-$*.log 2>&1 || { tail -n 20 build/wasm-$*.log; exit 1; }
	cp build/wasm/$*/viewer/wasm/$*.wasm $@

test-viewer: setup viewer
	@command -v npm >/dev/null || { echo "The viewer's tests need Node 20 with npm, and Chromium"; exit 1; }
	cd viewer && npm ci --no-audit --no-fund && npm run --silent mirador
	cd viewer && SGI_PYTHON=$(CURDIR)/$(BIN)/python node --test --test-concurrency=1 test/*.test.js
