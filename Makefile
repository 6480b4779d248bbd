# Needs git, make and Python 3.11 or later; everything else is installed into .venv, by exact version and hash.
#   make setup   install            make check   format, lint, types
#   make demo    the main job       make test    the tests
#   make coverage                   the tests, and how much of each package they run (a fifth slower)
#   make lock    write requirements.lock again; remove the file first to move to the newest versions
#   make clean   remove .venv, caches and builds (never runs/)

PYTHON ?= $(shell for p in python3 python3.14 python3.13 python3.12 python3.11; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$p && break; done)
VENV := .venv
BIN := $(VENV)/bin
PACKAGES := models babbling imitation experiments
# Least share of each package's lines, in %, that the tests run: what states behaviour is run, all of it; what is below is
# figures and recordings, and what runs in processes of its own, which is not counted.
COVERED := models:92 babbling:96 imitation:96 experiments:82

export MUJOCO_GL := disabled
export PIP_DISABLE_PIP_VERSION_CHECK := 1
# Whatever the environment says: 3000 modules compiled anew are five seconds of every process.
export PYTHONDONTWRITEBYTECODE :=

.DELETE_ON_ERROR:
.PHONY: setup demo test coverage check format lock clean

setup: $(VENV)/.ready

# Started afresh whenever it is not complete, so that an interrupted setup leaves nothing half installed.
$(VENV)/.locked: requirements.lock
	@test -n "$(PYTHON)" || { echo "make: Python 3.11 or later is needed and is not on the path; name one: make setup PYTHON=/path/to/python3" >&2; exit 2; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || { echo "make: $(PYTHON) is not Python 3.11 or later; name one that is: make setup PYTHON=/path/to/python3" >&2; exit 2; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { echo "make: $(PYTHON) cannot make environments; install its venv part (on Debian and Ubuntu: apt install python3-venv)" >&2; exit 2; }
	@echo "Installing into $(VENV) (minutes the first time: libraries of 500 MB) ..."
	@$(PYTHON) -m venv --clear $(VENV)
	@$(BIN)/python -m pip install --quiet --require-hashes --no-deps --only-binary :all: --no-compile -r requirements.lock
	@touch $@

$(VENV)/.ready: $(VENV)/.locked pyproject.toml
	@$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --no-index -e .
	@$(BIN)/python -c 'from experiments.registry import EXPERIMENTS; [one.load() for one in EXPERIMENTS.values()]'
	@touch $@
	@echo "Ready: $(BIN)/imitate --help"

demo: setup
	$(BIN)/imitate gesture
	@echo "Look at it: $(BIN)/rerun runs/gesture/recording.rrd"

TESTS := $(BIN)/python -m pytest -n auto --maxprocesses 4 --dist loadfile --no-loadscope-reorder

test: setup
	$(TESTS)

coverage: setup
	$(TESTS) --cov --cov-report=
	@for one in $(COVERED); do \
		printf '%-12s %% of lines run (at least %s): ' "$${one%:*}" "$${one#*:}"; \
		$(BIN)/coverage report --include="$${one%:*}/*" --format=total --fail-under="$${one#*:}" || exit 2; done

check: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy --strict $(PACKAGES)

format: setup
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

# uv resolves for every Python and platform at once; versions that still fit stay as they are.
lock:
	@test -n "$(PYTHON)" || { echo "make: Python 3.11 or later is needed; name one: make lock PYTHON=/path/to/python3" >&2; exit 2; }
	@mkdir -p build
	@$(PYTHON) -m venv --clear build/lock
	@build/lock/bin/python -m pip install --quiet uv
	@cp requirements.lock build/requirements.lock 2>/dev/null || rm -f build/requirements.lock
	@build/lock/bin/uv pip compile pyproject.toml --extra dev --universal --python-version 3.11 \
		--fork-strategy fewest --generate-hashes --no-annotate --no-header --quiet -o build/requirements.lock
	@{ echo "# Written by 'make lock' from pyproject.toml: runtime and dev, every version with the hashes of all its files,"; \
	   echo "# for Python 3.11 and later. Install with pip's --require-hashes --no-deps. Not edited by hand."; \
	   cat build/requirements.lock; } > build/requirements.new
	@mv build/requirements.new requirements.lock
	@grep -c == requirements.lock | sed 's/$$/ packages locked/'

clean:
	rm -rf $(VENV) build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis .coverage
	find $(PACKAGES) tests -name __pycache__ -type d -prune -exec rm -rf {} +
