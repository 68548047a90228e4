# Needs python3 (3.11 or newer), pip and make; everything else goes into .venv.
PYTHON ?= python3
BIN := .venv/bin
ROS := .venv-ros
PIP := $(BIN)/python -m pip --disable-pip-version-check -qq

.PHONY: demo replay test test-ros2 compiled lint types docs bench clean

demo: .venv/run.done       ## explore a flat nobody has told the robot about
	@$(BIN)/explore-bt run missions/01_apartment.yaml

replay: .venv/run.done     ## any moment of the newest run, in a browser
	@$(BIN)/explore-bt replay --open

# what fails in real time on a machine with other work is tried once more by itself
test: .venv/dev.done compiled  ## every test, lint and type check included
	@$(ROS)/bin/python -m pytest -n 2 -m "not slow" tests/ros2 \
	  || $(ROS)/bin/python -m pytest --last-failed -m "not slow" tests/ros2
	@$(BIN)/python -m pytest -n 2 --ignore tests/ros2

test-ros2: compiled        ## all of those against a real ROS 2, the flat explored over topics too
	@$(ROS)/bin/python -m pytest -n 2 tests/ros2

# a robot in real time cannot wait for its kernels to compile: a simulated one compiles them first
compiled: $(ROS)/dev.done
	@rm -rf .compiled && $(ROS)/bin/explore-bt run 01_apartment --headless --out .compiled >/dev/null

lint: .venv/dev.done       ## style
	@$(BIN)/ruff check . && $(BIN)/ruff format --check . && $(BIN)/lint-imports --no-cache

types: .venv/dev.done      ## types
	@$(BIN)/mypy

docs: .venv/dev.done       ## the tests that keep the documentation true
	@$(BIN)/python -m pytest -q tests/docs tests/cli/test_docs.py

bench: .venv/dev.done      ## the tables of docs/benchmarks.md (the whole takes about half an hour)
	@$(BIN)/python benchmarks/sim2d.py && $(BIN)/python benchmarks/apartment.py && $(BIN)/python benchmarks/floorplans.py && $(BIN)/python benchmarks/slam.py

clean:                     ## forget the environment and what was built
	rm -rf .venv $(ROS) dist build

# Debian's python3 comes without ensurepip: pip then installs itself from outside.
.venv/bin/python $(ROS)/bin/python: %/bin/python:
	@$(PYTHON) -m venv $* 2>/dev/null || { rm -rf $*; $(PYTHON) -m venv --without-pip $* \
	  && $(PYTHON) -m pip --python $*/bin/python install -qq pip; }

.venv/run.done: pyproject.toml | .venv/bin/python
	@echo "installing explore-bt and its libraries into .venv: about a minute"
	@$(PIP) install --editable . && touch $@

.venv/dev.done: pyproject.toml | .venv/bin/python
	@echo "installing explore-bt, its libraries and its tools into .venv: about a minute"
	@$(PIP) install --editable '.[dev]' && touch $@ .venv/run.done

$(ROS)/dev.done: pyproject.toml | $(ROS)/bin/python
	@echo "installing explore-bt and ROS 2 into $(ROS): about a minute"
	@$(ROS)/bin/python -m pip --disable-pip-version-check -qq install --editable '.[mujoco,ros2,ros2-dev]' && touch $@
