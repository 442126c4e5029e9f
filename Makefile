# Everything happens in .venv; nothing is installed outside it.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Of all that is installed a run imports a small part: what it imports is compiled then, and kept.
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile -c constraints.txt

# Files of tests side by side, in the order of tests/conftest.py; kernels are compiled into one cache
# that they share. One thread each for linear algebra: more of them spin against the other workers.
PYTEST := OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n $(or $(WORKERS),auto) --dist loadfile --no-loadscope-reorder

# Sources are read anew by every process of the tests where no machine-independent code is kept.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test thorough walks slow studies check docs format clean

demo: $(VENV)/.installed
	$(BIN)/trunnion analyze examples/pto-shaft.toml

test: $(VENV)/.installed-dev
	$(PYTEST) -m "not slow"

thorough: $(VENV)/.installed-dev
	$(PYTEST) -m thorough

walks: $(VENV)/.installed-dev
	$(PYTEST) -m slow tests/contract/test_walk_*.py

slow: $(VENV)/.installed-dev
	$(PYTEST) -m "slow and not study and not thorough"

studies: $(VENV)/.installed-dev
	$(PYTEST) -m study

check: $(VENV)/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/mypy

# The site, in docs/_build/html; nothing is fetched, and a warning is an error.
docs: $(VENV)/.installed-docs
	OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 $(BIN)/python -m sphinx -q -W --keep-going -b html docs docs/_build/html

format: $(VENV)/.installed-dev
	$(BIN)/ruff format .

clean:
	rm -rf $(VENV) build dist trunnion-out docs/_build docs/generated .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find src tests -name __pycache__ -prune -exec rm -rf {} +

# The stamps make a second call quick; a change of the dependencies installs again.
$(VENV)/.installed: pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Trunnion needs Python 3.11 or newer; name one with: make PYTHON=python3.12 $(MAKECMDGOALS)")'
	$(PYTHON) -m venv $(VENV)
	$(PIP) -e .
	@touch $@

$(VENV)/.installed-dev: $(VENV)/.installed
	$(PIP) -e ".[dev]"
	@touch $@

$(VENV)/.installed-docs: $(VENV)/.installed-dev
	$(PIP) -e ".[dev,docs]" || $(subst -c constraints.txt,,$(PIP)) -e ".[dev,docs]" # where the index lacks one of the versions
	@touch $@
