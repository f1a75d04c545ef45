# The front door. What each goal does is in tools/.

PREFIX ?= /usr/local
DESTDIR ?=

.DEFAULT_GOAL := help
.PHONY: help build web screenshots demo icub test test-quick chaos bench counts install uninstall clean

help:
	@echo "make demo       install what is missing, build, and test a simulated robot arm"
	@echo "make icub       the same with a humanoid, the iCub, behind YARP (builds YARP, ten minutes, once)"
	@echo "make build      build rtf and its hosts (target/release)"
	@echo "make web        build the page that rtf shows in a browser (make build does, too)"
	@echo "make test       every check there is: Rust, SDKs, examples, lints, installation"
	@echo "make test-quick the same without what needs middleware (ROS, YARP): it says what it leaves out"
	@echo "make chaos      kill fixtures, hosts and runners at random moments, for half an hour"
	@echo "make bench      measure speed and memory"
	@echo "make counts     record how many instructions the hot paths take (make test compares them)"
	@echo "make install    install into PREFIX=$(PREFIX); DESTDIR is put before it"
	@echo "make uninstall  remove what make install has put there"
	@echo "make clean      remove what was built"

build:
	@tools/bootstrap.sh build
	@tools/build.sh

web:
	@tools/web.sh

# The pictures in docs/images.
screenshots:
	@tools/screenshots.sh

demo:
	@tools/demo.sh

# The iCub in simulation: examples/04-icub.
icub:
	@tools/icub.sh

test:
	@tools/test.sh

test-quick:
	@tools/test.sh quick

chaos:
	@tools/bootstrap.sh test
	@tools/chaos.sh

bench:
	@tools/bench.sh

counts: build
	@tools/counts.py "$${CARGO_TARGET_DIR:-target}/release/rtf-counts" --record

install:
	@PREFIX='$(PREFIX)' DESTDIR='$(DESTDIR)' tools/install.sh

uninstall:
	@PREFIX='$(PREFIX)' DESTDIR='$(DESTDIR)' tools/uninstall.sh

clean:
	rm -rf build web/dist web/node_modules web/src/generated
	bash -c '. tools/env.sh && cargo clean'
