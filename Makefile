# The first of these that runs here.
PYTHON ?= $(firstword $(foreach v,3.11 3.12 3.13,$(shell python$(v) -c "import sys; print(sys.executable)" 2>/dev/null)) python3.11)
VENV := .venv
BIN := $(VENV)/bin
EXTRAS := page,export,usd,mcap,metrics,osc,lsl,keys,learn,report,single,video,cluster,docs,dev
# What `.ci/run` has besides: 2.5 GB of what trains networks, and of programs that open exports.
LARGE := train,clients

NEWER := 3.12 3.13

.PHONY: setup everything demo collected test matrix check bench docs clean

setup: $(VENV)/.installed
	@$(BIN)/python -m tritrack.first_run

$(VENV)/.installed: pyproject.toml constraints.txt
	@command -v $(PYTHON) >/dev/null || { echo "tritrack needs Python 3.11 or newer: install it, or name it: make PYTHON=/path/to/python3.11"; exit 1; }
	@echo "once, some two minutes: libraries into $(VENV)"
	@$(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[$(EXTRAS)]'
	@touch $@

everything: setup $(VENV)/.everything

$(VENV)/.everything: $(VENV)/.installed
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[$(EXTRAS),$(LARGE)]'
	@touch $@

demo: setup
	$(BIN)/tritrack demo

# What pytest rewrites the tests to is kept: each process of the first run would do it again.
collected: $(VENV)/.everything
	@$(BIN)/python -m pytest --collect-only -qq >$(VENV)/collected || { cat $(VENV)/collected; exit 1; }

test: setup
	$(BIN)/python -m pytest -m "not slow" -n 3 --dist loadfile --durations=15

matrix: $(NEWER:%=matrix-%)

matrix-%:
	.ci/matrix $*

check: $(VENV)/.installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

docs: setup
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict
	@echo "open .site/index.html"

bench: setup
	$(BIN)/python benchmarks/run.py

clean:
	rm -rf .venv .venv-* .cache .site runs .pytest_cache .mypy_cache .ruff_cache
