# One word for each thing a person does here. `make help` lists them.

VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
DEMO_SEED ?= 2

# Our arrays are small: threads of the linear algebra libraries cost more than they give, and
# one thread sums in one order, which is part of "same seed, same recording".
export OMP_NUM_THREADS ?= 1
export OPENBLAS_NUM_THREADS ?= 1
export MKL_NUM_THREADS ?= 1

.DEFAULT_GOAL := help
.PHONY: help setup demo test check fmt fmt-check lint types layers trees docs pages freeze fresh clean

help: ## List these words
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-12s %s\n", $$1, $$2}' $(firstword $(MAKEFILE_LIST))

setup: $(STAMP) ## Install everything into .venv (does nothing when it is up to date)

# --without-pip is for systems that package venv without ensurepip; the system's pip then
# installs one inside.
$(STAMP): pyproject.toml constraints.txt
	@set -e; python=; \
	for candidate in python3.11 python3 python; do \
		if $$candidate -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2>/dev/null; \
		then python=$$candidate; break; fi; \
	done; \
	if [ -z "$$python" ]; then \
		echo "setup: Python 3.11 is needed; got $$(python3 --version 2>&1);" \
			"try: install python3.11, then make setup" >&2; exit 2; \
	fi; \
	if ! $(BIN)/python -m pip --version >/dev/null 2>&1; then \
		$$python -m venv $(VENV) >/dev/null 2>&1 || { \
			$$python -m venv --clear --without-pip $(VENV); \
			$$python -m pip --python $(BIN)/python install --quiet pip; }; \
	fi
	@echo "setup: installing into $(VENV), a few minutes the first time"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check \
		--constraint constraints.txt --editable '.[campaign,dev,learn,opcua,rerun,serve]'
	@touch $(STAMP)

demo: setup ## Untie a knotted cable with the simulated YuMi, and record it
	@mkdir -p runs
	$(BIN)/cellwright run trees/missions/untangle.yaml --seed $(DEMO_SEED) \
		--record runs/demo.mcap --overwrite --html runs/demo.html
	$(BIN)/cellwright inspect runs/demo.mcap --plain
	@echo
	@echo "Open next:"
	@echo "  runs/demo.html   in a browser: arms, cable and trace, with a time slider"
	@echo "  runs/demo.mcap   with $(BIN)/cellwright inspect runs/demo.mcap, tick by tick"

fresh: ## Do what the README says in an empty clone with an empty home
	scripts/fresh_machine.sh

test: setup ## Run all tests
	$(BIN)/pytest -n auto

check: fmt-check lint types layers trees docs test ## Everything that must hold before a commit lands

fmt: setup ## Format the code and the trees
	$(BIN)/ruff format
	$(BIN)/ruff check --fix --select I
	$(BIN)/cellwright fmt trees

fmt-check: setup
	$(BIN)/ruff format --check
	$(BIN)/cellwright fmt --check trees

lint: setup ## Lint the code
	$(BIN)/ruff check

types: setup ## Check types, strictly
	$(BIN)/mypy

layers: setup ## Check who may import whom
	$(BIN)/lint-imports

trees: setup ## Check and lint the trees
	$(BIN)/cellwright check trees
	$(BIN)/cellwright lint trees

docs: setup ## Build the documentation into site/; a warning is an error
	$(BIN)/sphinx-build --quiet --fail-on-warning --keep-going -j auto docs site

pages: setup ## Write the generated files anew: pages of skills and models, schema, URDF
	$(BIN)/python -m executive.engine.schema
	$(BIN)/python -m robots.descriptions
	$(BIN)/python docs/skills_page.py > docs/skills.new
	@mv docs/skills.new docs/skills.md
	$(BIN)/python docs/models_page.py > docs/models.new
	@mv docs/models.new docs/models.md

freeze: setup ## Write the installed versions to constraints.txt
	@{ sed '/^#/!d' constraints.txt; \
		$(BIN)/python -m pip --disable-pip-version-check freeze --exclude-editable | sed 's/+cpu$$//'; \
	} > constraints.new
	@mv constraints.new constraints.txt

clean: ## Remove what was built; runs/ and .venv stay
	rm -rf site build dist .mypy_cache .ruff_cache .pytest_cache .import_linter_cache .hypothesis
	find . -name __pycache__ -type d -not -path './$(VENV)/*' -prune -exec rm -rf {} +
