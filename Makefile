# `make demo`, `make web`, `make web-examples`, `make web-bench`, `make test`, `make fuzz`, `make bench`, `make figures`
# and `make package`. All install what is missing on Debian 12 (root or sudo).

BUILD_JOBS ?= $(shell nproc)

.PHONY: demo test fuzz web web-examples web-bench bench figures package release dev setup clean

demo: out/tabletop.png
	@echo "Look at out/tabletop.png"

test: dev web
	@tools/setup chromium
	tools/run_tests build/dev

# The files that it finds are in build/fuzz/findings. SECONDS=3600: an hour for each target.
SECONDS ?= 600
fuzz: setup
	@tools/setup fuzz
	@test -f build/fuzz/build.ninja || cmake --preset fuzz
	cmake --build --preset fuzz -j $(BUILD_JOBS)
	fuzz/run build/fuzz $(SECONDS)

# The page of `phat web`, and the package for three.js.
web: web/dist/sizes.json

web/dist/sizes.json: web/node_modules/.package-lock.json web/build.js $(wildcard web/src/* web/viewer/* shaders/* shaders/lib/*)
	cd web && node build.js

web/node_modules/.package-lock.json: web/package-lock.json
	@tools/setup node
	cd web && npm ci

# Two rooms to look at from any web server.
web-examples: release web
	web/examples/make build/release/phat out/web-examples

# The pages' times and errors beside three.js alone: build/web-bench.json and a table. On an idle machine.
web-bench: web-examples
	@tools/setup chromium
	node web/bench/bench.js out/web-examples > build/web-bench.json

bench: setup
	@test -f build/release/build.ninja || cmake --preset release
	cmake --build build/release --target phat_bench -j $(BUILD_JOBS)
	build/release/bench/phat_bench --benchmark_out=build/bench.json --benchmark_out_format=json
	@echo "The figures are in build/bench.json; bench/README.md explains them"

# QUICK=1: few pixels and samples, a few minutes.
figures: release
	tools/setup figures
	cmake --build build/release --target phat_peers phat_live -j $(BUILD_JOBS)
	tools/figures.py $(if $(QUICK),--quick)

# Debian packages, the Blender add-on, the package for npm, and their checksums, in out/packages/.
package: web
	tools/setup package
	$(MAKE) release
	packaging/make_packages build/release out/packages

out/tabletop.png: out/tabletop.phat.glb
	build/release/phat render out/tabletop.phat.glb -o $@

out/tabletop.phat.glb: scenes/tabletop.glb | release
	@mkdir -p out
	build/release/phat bake scenes/tabletop.glb -o $@

release: setup
	@test -f build/release/build.ninja || cmake --preset release
	cmake --build build/release --target phat -j $(BUILD_JOBS)

dev: setup
	@test -f build/dev/build.ninja || cmake --preset dev
	cmake --build build/dev -j $(BUILD_JOBS)

setup:
	@tools/setup

clean:
	rm -rf build out web/dist web/LICENSE web/node_modules
