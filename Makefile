# Two commands to begin with:  make run   make test
# PYTHON names the interpreter that builds the environment (3.11 or later), PORT where `make run` serves.
PYTHON ?= python3
PORT ?= 8000
BIN := .venv/bin

.DEFAULT_GOAL := help
.PHONY: help run test hunt invariance offsets load lint types imports openapi paper docs lock bench bench-peers clean dev

help: ## what can be made
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/  make \1\t\2/' | expand -t 20

run: ## serve on 127.0.0.1:$(PORT), solve the example, write its picture
	@$(PYTHON) tools/environment.py requirements.lock
	@PORT=$(PORT) exec $(BIN)/python -u tools/run.py

dev:
	@$(PYTHON) tools/environment.py requirements-dev.lock

test: dev ## all tests, on all cores
	@$(BIN)/python -W ignore::RuntimeWarning:runpy -m mat_core.warm
	@$(BIN)/python -m pytest -n auto --dist worksteal

hunt: dev ## look for domains that are not solved: ARGS="--count 500 --fonts FOLDER"
	@$(BIN)/python -W ignore::RuntimeWarning -m tests.hunt $(ARGS)

offsets: dev ## offsets of many shapes against shapely's buffer: ARGS="--fonts FOLDER --icons FOLDER --outward"
	@$(BIN)/python -m tests.offsets $(ARGS)

invariance: dev ## look for shapes whose axis depends on their place, unit or description: ARGS="--count 50"
	@$(BIN)/python -W ignore::RuntimeWarning -m tests.hunt.invariance $(ARGS)

load: dev ## load and faults on the service, and whether it keeps its promises: ARGS="--only calm faults"
	@$(BIN)/python -m tests.load $(ARGS)

lint: dev ## style
	@$(BIN)/ruff check .

types: dev ## mypy --strict
	@$(BIN)/mypy --strict mat_core service

imports: dev ## who may import whom
	@$(BIN)/lint-imports

openapi: dev ## write openapi/openapi.json anew; ARGS=--release keeps it as what clients of this version rely on
	@$(BIN)/python tools/write_openapi.py $(ARGS)

paper: dev ## run the paper's procedure, write docs/paper.md and its pictures
	@$(BIN)/python tools/paper_report.py

bench: dev ## the benchmarks
	@$(BIN)/python -m benchmarks

bench-peers: dev ## side by side with other programs (installed under .bench), writes docs/performance.md
	@$(BIN)/python -m benchmarks.peers $(ARGS)

docs: dev ## run the pages in docs, write their pictures and printed lines anew
	@PYTHONPATH=. $(BIN)/python tools/pages.py

lock: dev ## resolve the dependencies anew (needs uv)
	@$(BIN)/python tools/lock.py

clean: ## remove what was built, the environment too
	@rm -rf .venv out dist build .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	@find . -name __pycache__ -type d -prune -exec rm -rf {} +
