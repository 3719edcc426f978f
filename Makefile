# make demo           install into .venv and paint a photograph into demo/, and draw it in ink into demo-ink/
# make test           lint, import contracts, types and tests
# make wheel          build the sdist and the wheel into dist/, and try the wheel in an empty environment without a compiler
# make test-baseline  what computes once more, by the oldest instructions and on one thread: other processors round so
# make site           the documentation as a website in build/site, which needs no network
# make bench          speed of the kernel, speed and quality of the planner, likeness of the styles, fits of brushes, order
# make paper          the figures beside the paper's, measured again into measured/, and the tables in docs: hours
# make gallery        the pictures of docs/gallery.md, by the commands that stand there: half an hour and more
# make clean          remove whatever these made
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
# What is used is compiled when it is, and kept, whatever the caller's own Python does; all of it takes more than a minute.
unexport PYTHONDONTWRITEBYTECODE
INSTALL := $(PIP) install --no-compile --constraint constraints.txt
EDITABLE := --build-constraint constraints.txt --editable

# The oldest that PyTorch (with MKL and oneDNN), OpenBLAS, the C library and NumPy have for this kind of processor. What
# means nothing to it is passed over; NumPy warns instead, so it is asked what it has. tests/conftest.py looks whether
# all this took effect, and chooses our own kernels.
OLDEST := MAULSTICK_BASELINE=1 OMP_NUM_THREADS=1 ATEN_CPU_CAPABILITY=default MKL_CBWR=COMPATIBLE \
	ONEDNN_MAX_CPU_ISA=SSE41 OPENBLAS_CORETYPE=Nehalem GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX512F,-AVX2,-FMA
OF_NUMPY := from numpy._core._multiarray_umath import __cpu_dispatch__ as known, __cpu_features__ as here; \
	print(*(name for name in known if here[name]))

# What computes; not what only speaks to machines, starts processes, or runs by all instructions in any case.
NUMERICAL := $(addprefix tests/,brush_fit calibration colour ordering painting planning plots recording rendering \
	robot strokes style)
ELSEWHERE := $(addprefix --ignore=tests/,recording/test_natnet.py rendering/kernels/test_gpu.py \
	rendering/kernels/test_running.py robot/test_dialogues.py robot/test_ebb.py robot/test_execute.py robot/test_franka.py \
	robot/test_grbl.py robot/test_journal.py robot/test_kills.py robot/test_machines.py robot/test_ur.py robot/test_xarm.py)

.PHONY: demo test wheel site test-baseline bench paper gallery clean

demo: $(VENV)/installed
	$(BIN)/maulstick plan --demo --style loops --brush marker --strokes 1000 --size 160x160mm --out demo --overwrite
	$(BIN)/maulstick plan --demo --style elephant --hand-size 0.35 --brush fineliner --ink black --strokes 2000 --size 160x160mm \
		--weight faces=6 --out demo-ink --overwrite

test: $(VENV)/installed-dev
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/lint-imports
	$(BIN)/mypy --strict src
	$(BIN)/pytest --numprocesses 2 --dist worksteal

wheel: $(VENV)/installed-dev
	$(BIN)/python .ci/wheel.py --keep dist

site: $(VENV)/installed-dev
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict --quiet

test-baseline: $(VENV)/installed-dev
	$(OLDEST) NPY_DISABLE_CPU_FEATURES="$$($(BIN)/python -c '$(OF_NUMPY)')" \
		$(BIN)/pytest --numprocesses 2 --dist worksteal $(NUMERICAL) $(ELSEWHERE)

bench: $(VENV)/installed-dev
	$(BIN)/python benchmarks/kernel.py
	$(BIN)/python benchmarks/plan.py
	$(BIN)/python benchmarks/style.py
	$(BIN)/python benchmarks/brush.py fit
	$(BIN)/python benchmarks/robot.py --quick

paper: $(VENV)/installed-dev
	$(BIN)/python benchmarks/paper.py

gallery: $(VENV)/installed-dev
	$(BIN)/python experiments/gallery.py

clean:
	rm -rf $(VENV) build dist demo demo-ink .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .hypothesis

$(VENV)/installed: $(SOURCES)
	$(environment)
	$(INSTALL) $(EDITABLE) '.[plan]'
	@touch $@

$(VENV)/installed-dev: $(SOURCES)
	$(environment)
	$(INSTALL) $(EDITABLE) '.[camera,clip,dev,docs,franka,mocap,plan,ray,slurm,studio,ur,video,wacom,xarm]'
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
