# Entry points; the scripts are in tools/.

PREFIX ?= /usr/local
DESTDIR ?=

.DEFAULT_GOAL := help
.PHONY: help build wheels web screenshots docs demo icub test test-quick chaos fuzz sanitizers coverage mutants soak bench counts install uninstall packages release clean

help:
	@echo "make demo       install requirements, build, and test a simulated robot arm"
	@echo "make icub       the same with a humanoid, the iCub, behind YARP (builds YARP once, ten minutes)"
	@echo "make build      build rtf and its hosts (target/release)"
	@echo "make docs       build the user's guide (build/docs/html/index.html)"
	@echo "make web        build the page that rtf serves (included in make build)"
	@echo "make wheels     build and test the wheels for pip, x86-64 and aarch64 (half an hour)"
	@echo "make test       run all checks: Rust, SDKs, examples, lints, installation"
	@echo "make test-quick the same without tests that need middleware (ROS, YARP)"
	@echo "make chaos      kill fixtures, hosts and runners at random moments, for half an hour"
	@echo "make fuzz       give arbitrary bytes to all parsers, each for SECONDS (60)"
	@echo "make sanitizers run C++ and Lua tests with GCC's sanitizers and valgrind"
	@echo "make coverage   measure which lines the tests of the core run"
	@echo "make mutants    change the code that judges, and count which changes the tests notice"
	@echo "make soak       run 200 000 tests and 5000 runs, and check that nothing grows"
	@echo "make bench      measure speed and memory"
	@echo "make counts     record the instruction counts of the hot paths (make test compares them)"
	@echo "make install    install into PREFIX=$(PREFIX), below DESTDIR if set"
	@echo "make uninstall  remove the installed files"
	@echo "make packages   build the Debian packages into dist"
	@echo "make release    build all packages of the last commit into dist, with checksums"
	@echo "make clean      remove build results"

build:
	@tools/bootstrap.sh build
	@tools/build.sh

web:
	@tools/web.sh

wheels: build
	@wheel=$$(tools/wheel.sh x86_64) && tests/wheel/run.sh "$$wheel" && tests/wheel/minimal.sh "$$wheel"
	@wheel=$$(tools/wheel.sh aarch64) && tests/wheel/aarch64.sh "$$wheel"

# The pictures in docs/images.
screenshots:
	@tools/screenshots.sh

# The guide contains the command line of the built program.
docs: build
	@tools/docs.sh

demo:
	@tools/demo.sh

# Runs examples/04-icub.
icub:
	@tools/icub.sh

test:
	@tools/test.sh

test-quick:
	@tools/test.sh quick

chaos:
	@tools/bootstrap.sh test
	@tools/chaos.sh

SECONDS ?= 60
fuzz:
	@tools/bootstrap.sh test
	@tools/fuzz.sh --seconds $(SECONDS)

sanitizers:
	@tools/bootstrap.sh test
	@tools/sanitizers.sh

coverage:
	@tools/bootstrap.sh test
	@tools/coverage.sh

mutants:
	@tools/bootstrap.sh test
	@tools/mutants.sh

soak: build
	@tools/soak.sh

bench:
	@tools/bench.sh

counts: build
	@tools/counts.py "$${CARGO_TARGET_DIR:-target}/release/rtf-counts" --record

install:
	@PREFIX='$(PREFIX)' DESTDIR='$(DESTDIR)' tools/install.sh

uninstall:
	@PREFIX='$(PREFIX)' DESTDIR='$(DESTDIR)' tools/uninstall.sh

packages:
	@packaging/deb/build.sh dist

release:
	@packaging/release.sh

clean:
	rm -rf build dist web/dist web/node_modules web/src/generated \
	  editors/vscode/dist editors/vscode/node_modules editors/vscode/schemas editors/vscode/LICENSE
	bash -c '. tools/env.sh && cargo clean'
