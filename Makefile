# Two commands for everybody; everything else is a CMake preset (CMakePresets.json) or a script (scripts/).
.DEFAULT_GOAL := help
.PHONY: help demo test install wheel package site benchmarks format clean
export OPENBLAS_NUM_THREADS := 1

help:
	@echo "make demo     install what is missing, build, simulate shipped models, write their reports into demo/"
	@echo "make test     install what is missing, build, run every test (release and sanitizers)"
	@echo "make install  build and install to PREFIX (default /usr/local)"
	@echo "make wheel    build the Python package into build/wheel"
	@echo "make package  build a tarball, a .deb, a wheel and the source for pip into build/package"
	@echo "make site     build the documentation into build/site, running all that it shows"
	@echo "make benchmarks  repeat every public figure; ONLY=\"creep fesd\" for some (python3 benchmarks/all.py --list)"
	@echo "make format   clang-format every source"
	@echo "make clean    remove build/ and demo/"

demo:
	@scripts/demo.sh

test:
	@scripts/test.sh

PREFIX ?= /usr/local
install:
	@scripts/install.sh
	cmake --preset release
	cmake --build --preset demo
	cmake --build build/release --target saltus_libraries
	cmake --install build/release --prefix "$(PREFIX)"

# The libraries of the release build, made once for the tool, the tests and the wheel.
wheel:
	@scripts/install.sh python
	cmake --preset release --log-level=NOTICE
	cmake --build build/release --target saltus_python
	scripts/wheel.sh build/release build/wheel

package:
	@scripts/package.sh

site:
	@scripts/site.sh

# Peers from PyPI and Debian are optional: one that is missing is a row that says so.
ONLY ?=
MPCC ?= examples/mpcc
benchmarks:
	@scripts/install.sh python
	@scripts/install_benchmarks.sh
	cmake --preset release --log-level=NOTICE
	cmake --build build/release --target saltus saltus_python
	@python3 benchmarks/all.py $(ONLY) --mpcc $(MPCC)

format:
	@scripts/format.sh

clean:
	rm -rf build demo
