# The two commands: `make run` and `make test`. Needs Python 3.11 or newer with venv, and make; everything else it installs.
PYTHON ?= python3
VENV ?= .venv
BIN = $(VENV)/bin
INSTALLED = build/installed
RUN_TETS ?= 120k
OUT ?= out
# what `make gate` compares with: where this branch left it
BASE ?= $(shell git rev-parse --quiet --verify origin/main >/dev/null && echo origin/main || echo HEAD~1)
GATE = --model nozzle --tets 30k --backend v3y,v4 --scenario alfa,flow
FORMAT ?= table
FUZZ ?= results journal history plugin obj off ply vtu polygons-npz objects-npz objects-csv
FUZZ_SECONDS ?= 300

.PHONY: run test docs dist test-dist test-versions test-all lint types bench-native bench-peers bench-cgal bench-polygon-peers gate gate-selftest measuring schema fuzz results reference screenshots thesis clean help

help:            ## list the targets
	@grep -E '^[a-z-]+: .*##|^[a-z-]+: *##' $(MAKEFILE_LIST) | sed 's/:.*##/\t/' | expand -t 16

run: $(BIN)/tetrabench  ## generate the nozzle and run the main job on it; prints a table, puts charts and a page into out/
	@mkdir -p $(OUT)
	$(BIN)/tetrabench run --model nozzle --tets $(RUN_TETS) --quick -o $(OUT)/results.json --charts $(OUT)
	$(BIN)/tetrabench report $(OUT)/results.json -o $(OUT)/report.html

test: $(VENV)/developing  ## the fast suite
	$(BIN)/python -m pytest -n auto --dist loadgroup

test-all: test  ## the suite with all property tests, with bounds checks, and with the JIT off
	TETRABENCH_TESTS=thorough $(BIN)/python -m pytest -n auto --dist loadgroup tests/tetra/test_stateful.py tests/polygon tests/collision tests/halfface/test_stateful.py tests/halfface/test_sets.py tests/io
	NUMBA_BOUNDSCHECK=1 $(BIN)/python -m pytest -n auto --dist loadgroup tests/tetra tests/polygon tests/collision tests/halfface tests/io tests/mesh tests/scenarios
	NUMBA_DISABLE_JIT=1 TETRABENCH_TESTS=slow-motion $(BIN)/python -m pytest -n auto tests/tetra tests/polygon tests/collision tests/halfface tests/io tests/mesh tests/scenarios

lint: $(VENV)/developing  ## style, and the direction of imports
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .

types: $(VENV)/developing  ## types and the direction of imports, on the package as it installs
	rm -rf $(INSTALLED) build/lib build/bdist*
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --target $(INSTALLED) .
	cd $(INSTALLED) && PYTHONPATH=. ../../$(BIN)/lint-imports --config ../../pyproject.toml
	cd $(INSTALLED) && ../../$(BIN)/mypy --config-file ../../pyproject.toml -p tetrabench

docs: $(VENV)/developing  ## the documentation as a site, in out/site; a warning is an error
	rm -rf $(OUT)/site
	$(BIN)/sphinx-build -b html -E -W --keep-going -n -q -d build/doctrees -c docs . $(OUT)/site

dist: $(VENV)/developing  ## the sdist, and the wheel of that sdist, into dist/
	rm -rf dist
	$(BIN)/python -m build --outdir dist .
	$(BIN)/python -m twine check --strict dist/*

test-dist: dist  ## the wheel alone in an empty environment, on each Python that there is (some minutes each)
	$(BIN)/python -m tests.packaging.empty_environments dist/*.whl

test-versions: dist  ## a part of the suite with the lower bounds of all dependencies, and with their newest (some minutes each)
	$(BIN)/python -m tests.packaging.versions dist/*.tar.gz

gate: $(BIN)/tetrabench  ## is the working tree slower than BASE (origin/main, else HEAD~1)? some minutes
	@mkdir -p $(OUT)
	@$(BIN)/tetrabench gate --base "$$(git merge-base HEAD $(BASE) || echo $(BASE))" $(GATE) --format $(FORMAT) -o $(OUT)/gate.json

gate-selftest: $(BIN)/tetrabench  ## the gate on trial: identical code passes, an injected slowdown is caught (some minutes)
	$(BIN)/python tests/bench/gate_selftest.py

bench-native: $(VENV)/developing  ## our kernels beside C on the same arrays (needs gcc)
	$(BIN)/python tests/native/bench_native.py

bench-peers: $(VENV)/peers  ## our bulk operations beside packages from PyPI (a quarter of an hour; gmsh needs some system libraries)
	@mkdir -p $(OUT)
	$(BIN)/python tests/peers/bench_peers.py -o $(OUT)/peers.json

bench-polygon-peers: $(VENV)/peers  ## our formats of polygon meshes beside C, CGAL, OpenMesh and xugrid (a quarter of an hour; needs gcc, g++, libcgal-dev, libopenmesh-dev)
	@mkdir -p $(OUT)
	$(BIN)/python -m tests.polygon_peers --turns xugrid=7 -o $(OUT)/polygon-peers.json

bench-cgal: $(VENV)/developing  ## our half-face kernel beside CGAL and plain C++ (ten minutes; needs g++, libcgal-dev)
	@mkdir -p $(OUT)
	$(BIN)/python -m tests.cgal --turns cgal-call=7 --picture $(OUT)/one-to-all.svg -o $(OUT)/cgal.json

measuring: $(VENV)/measuring  ## is the harness to be believed? beside pyperf, pytest-benchmark, hyperfine (hours; needs hyperfine)
	$(BIN)/python -m tests.measuring

schema: $(BIN)/tetrabench  ## the published schema of results files, made anew from their records
	$(BIN)/python -m tetrabench.bench.schema > docs/results-1.schema.json

fuzz: $(VENV)/fuzzing  ## what is read, on trial: each reader some minutes by coverage, then a million mutated decks (hours)
	for target in $(FUZZ); do $(BIN)/python -m tests.fuzz $$target --seconds $(FUZZ_SECONDS) --corpus $(OUT)/fuzz || exit 1; done
	NUMBA_BOUNDSCHECK=1 $(BIN)/python -m tests.io.fuzz_nastran

results: $(BIN)/tetrabench  ## repeat the committed reference run and what README.md shows of it
	$(BIN)/python results/regenerate.py nozzle-120k-quick

reference: $(BIN)/tetrabench  ## repeat the committed reference runs of the default scenarios (two hours), and the page of findings
	$(BIN)/python results/regenerate.py reference-nozzle reference-intake numbering-nozzle

screenshots: $(VENV)/developing  ## make docs/pictures anew from the committed runs (needs Chromium)
	$(BIN)/python docs/screenshots.py

thesis: $(BIN)/tetrabench  ## repeat the committed runs of the source's experiment (an hour) and what results/README.md shows
	$(BIN)/python results/regenerate.py thesis-nozzle thesis-nozzle-shuffled thesis-intake thesis-intake-shuffled

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "tetrabench needs Python 3.11 or newer; this is $$($(PYTHON) --version). Say: make PYTHON=python3.12 run" >&2; exit 2; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || { \
	  echo "Python's venv is missing. On Debian and Ubuntu: apt install python3-venv; then run make again." >&2; exit 2; }
	@echo 'making an environment in $(VENV)'
	@$(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install -qq --upgrade pip setuptools wheel

$(BIN)/tetrabench: $(VENV)/bin/python pyproject.toml
	@echo 'installing tetrabench and what it needs'
	@$(BIN)/python -m pip install -qq --no-build-isolation -e '.[report]'
	@touch $@

$(VENV)/developing: $(VENV)/bin/python pyproject.toml
	@echo 'installing tetrabench, what it needs, and what its tests need'
	@$(BIN)/python -m pip install -qq --no-build-isolation -e '.[dev]'
	@touch $(BIN)/tetrabench $@

$(VENV)/peers: $(VENV)/developing pyproject.toml
	@echo 'installing the packages that tetrabench is compared with'
	@$(BIN)/python -m pip install -qq --no-build-isolation -e '.[peers]'
	@touch $(BIN)/tetrabench $(VENV)/developing $@

$(VENV)/fuzzing: $(VENV)/developing
	@echo 'installing what fuzzes by coverage'
	@$(BIN)/python -m pip install -qq 'atheris>=3.0'
	@touch $@

$(VENV)/measuring: $(VENV)/developing pyproject.toml
	@echo 'installing the tools that tetrabench is compared with'
	@$(BIN)/python -m pip install -qq --no-build-isolation -e '.[measuring]'
	@touch $(BIN)/tetrabench $(VENV)/developing $@

clean:           ## remove the environment and everything built
	rm -rf $(VENV) build dist out *.egg-info
