# make demo    install into .venv and paint a photograph into demo/
# make test    lint, import contracts, types and tests
# make bench   speed of the kernel, speed and quality of the planner, likeness of the styles, fits of brushes, order
# make clean   remove whatever these made
#
# Any Python from 3.11 on will do; name one with `make PYTHON=/path/to/python`.

ifeq ($(origin PYTHON),undefined)
PYTHON := $(shell for python in python3 python3.13 python3.12 python3.11; do \
	$$python -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$python && break; done)
endif

VENV := .venv
BIN := $(VENV)/bin
SOURCES := pyproject.toml constraints.txt CMakeLists.txt $(shell find src -name '*.cpp' -o -name '*.hpp')

# pip itself is pinned first: older ones cannot pin what a package is built with.
PIP := $(BIN)/python -m pip --disable-pip-version-check
INSTALL := $(PIP) install --constraint constraints.txt
EDITABLE := --build-constraint constraints.txt --editable

.PHONY: demo test bench clean

demo: $(VENV)/installed
	$(BIN)/maulstick plan --demo --style loops --brush marker --strokes 1000 --size 160x160mm --out demo --overwrite

test: $(VENV)/installed-dev
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/lint-imports
	$(BIN)/mypy --strict src
	$(BIN)/pytest --numprocesses 2

bench: $(VENV)/installed-dev
	$(BIN)/python benchmarks/kernel.py
	$(BIN)/python benchmarks/plan.py
	$(BIN)/python benchmarks/style.py
	$(BIN)/python benchmarks/brush.py fit
	$(BIN)/python benchmarks/robot.py --quick

clean:
	rm -rf $(VENV) build demo .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .hypothesis

$(VENV)/installed: $(SOURCES)
	$(environment)
	$(INSTALL) $(EDITABLE) .
	@touch $@

$(VENV)/installed-dev: $(SOURCES)
	$(environment)
	$(INSTALL) $(EDITABLE) '.[camera,clip,dev,franka,mocap,studio,ur,video,wacom,xarm]'
	@touch $@ $(VENV)/installed

# Say in one line what is missing; then make .venv anew unless it works.
define environment
@fail() { echo "Maulstick: $$1" >&2; exit 1; }; \
"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null \
	|| fail "Python 3.11 or newer is needed$(if $(PYTHON), and $(PYTHON) is not). Name one: make PYTHON=/path/to/python"; \
"$(PYTHON)" -c 'import ensurepip, venv' 2>/dev/null \
	|| fail "$(PYTHON) cannot make environments. On Debian: apt-get install python3-venv"; \
"$(PYTHON)" -c 'import sysconfig; open(sysconfig.get_config_var("INCLUDEPY") + "/Python.h")' 2>/dev/null \
	|| fail "$(PYTHON) came without its C headers. On Debian: apt-get install python3-dev"; \
command -v $${CXX:-c++} >/dev/null || command -v g++ >/dev/null || command -v clang++ >/dev/null \
	|| fail "a C++ compiler is needed. On Debian: apt-get install g++"; \
$(BIN)/python -c 'import pip, sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null \
	|| "$(PYTHON)" -m venv --clear $(VENV)
@$(INSTALL) --quiet pip
endef
