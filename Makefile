# The front door. What each goal does is in tools/.

PREFIX ?= /usr/local
DESTDIR ?=

.DEFAULT_GOAL := help
.PHONY: help build demo test bench install uninstall clean

help:
	@echo "make demo       install what is missing, build, and test a simulated robot arm"
	@echo "make build      build rtf and its hosts (target/release)"
	@echo "make test       every check there is: Rust, SDKs, examples, lints, installation"
	@echo "make bench      measure speed and memory"
	@echo "make install    install into PREFIX=$(PREFIX); DESTDIR is put before it"
	@echo "make uninstall  remove what make install has put there"
	@echo "make clean      remove what was built"

build:
	@tools/bootstrap.sh build
	@tools/build.sh

demo:
	@tools/demo.sh

test:
	@tools/test.sh

bench:
	@tools/bench.sh

install:
	@PREFIX='$(PREFIX)' DESTDIR='$(DESTDIR)' tools/install.sh

uninstall:
	@PREFIX='$(PREFIX)' DESTDIR='$(DESTDIR)' tools/uninstall.sh

clean:
	rm -rf build
	cargo clean
