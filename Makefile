# `make paper` and `make test` set everything up by themselves: a virtual environment and the
# locked dependencies of requirements/.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
OUT ?= paper
# -qq: errors alone; what is installed stands in the locks.
INSTALL := @$(BIN)/python -m pip install -qq --progress-bar off --disable-pip-version-check

.PHONY: paper test lint notebooks manual benchmark lock clean
.DELETE_ON_ERROR:

paper: $(VENV)/.core
	$(BIN)/dualarm-pin paper --out $(OUT)

# On all processors; the tests of a module stay together, since they share its fixtures. Those
# marked slow run where CI=true, as .ci/run sets it: `make test CI=true` runs all of them.
CHOSEN := $(if $(filter 1 true,$(CI)),,-m "not slow")
test: $(VENV)/.dev
	$(BIN)/python -m pytest -n auto --dist loadscope $(CHOSEN)

lint: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

notebooks: $(VENV)/.dev
	$(BIN)/python -m pytest --nbmake notebooks/*.ipynb

# Pages that open from disk: build/manual/index.html. A warning is an error.
manual: $(VENV)/.docs
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet -d build/doctrees docs/manual build/manual

benchmark: $(VENV)/.dev
	$(INSTALL) --require-hashes -r requirements/all.txt
	$(BIN)/python benchmarks/solvers.py

$(BIN)/python:
	@$(PYTHON) -m venv $(VENV)

# The package itself is installed editable; a changed lock or pyproject.toml installs again.
$(VENV)/.core: requirements/core.txt pyproject.toml | $(BIN)/python
	@echo "installing packages into $(VENV), once: some minutes"
	$(INSTALL) --require-hashes -r requirements/core.txt
	$(INSTALL) --no-deps --no-build-isolation --editable .
	@touch $@

$(VENV)/.dev: requirements/dev.txt $(VENV)/.core
	$(INSTALL) --require-hashes -r requirements/dev.txt
	@touch $@

$(VENV)/.docs: requirements/docs.txt $(VENV)/.core
	$(INSTALL) --require-hashes -r requirements/docs.txt
	@touch $@

# Write the locks anew (needs uv): every platform, Python 3.11 and later, with hashes.
LOCK := $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-header -c requirements/limits.in pyproject.toml requirements/build.in
lock: | $(BIN)/python
	$(INSTALL) uv
	$(LOCK) -o requirements/core.txt
	$(LOCK) --extra dev -c requirements/core.txt -o requirements/dev.txt
	$(LOCK) --extra docs -c requirements/dev.txt -o requirements/docs.txt
	$(LOCK) --all-extras -c requirements/dev.txt -c requirements/docs.txt -o requirements/all.txt

clean:
	rm -rf $(VENV) paper build dist
