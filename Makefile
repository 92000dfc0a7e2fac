# All that a person or a machine does with this tree. `make help` lists it.
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help
.NOTPARALLEL:
.PHONY: help demo studio test test-long oldest bench bench-quick pictures install clean fmt-check lint
.PHONY: test-rust test-web test-looks test-tiles test-studio test-python
.PHONY: wheel docs-site fuzz need-fuzz tested tilesets test-viewers bench-studio
.PHONY: studio-page need-rust need-wasm need-node need-node-20 need-chromium need-python

CARGO ?= cargo
# What speeds up the second build fills gigabytes in the first; CARGO_INCREMENTAL=1 brings it back.
export CARGO_INCREMENTAL ?= 0
TARGET := $(or $(CARGO_TARGET_DIR),target)
CHORDAL := $(TARGET)/release/chordal
# The command as test-rust has built it, with its assertions. What users get is tested as the wheel: to link the whole of the
# library for release takes minutes, and the wheel carries the same command.
TESTED := $(TARGET)/debug/chordal
VENV := $(TARGET)/python/venv
# The library as a module, and the command as the workbench runs it. What is small and fast takes long to build, so tests
# build what is not.
MODULE_PROFILE ?= page
MODULE_TARGET ?= wasm32-unknown-unknown
WEB_PROFILE ?= web
WASM = $(TARGET)/$(MODULE_TARGET)/$(MODULE_PROFILE)/chordal_wasm.wasm
WASI_TARGET := wasm32-wasip1-threads
WASI = $(TARGET)/$(WASI_TARGET)/$(WEB_PROFILE)/chordal.wasm
# Scripts and expressions nest deeper than the 1 MiB that a module has unless it says otherwise. A memory that threads share has
# a limit: all that a module can address, of which its host may give less (studio/src/core/command.ts).
export CARGO_TARGET_WASM32_WASIP1_THREADS_RUSTFLAGS ?= -C link-arg=-zstack-size=16777216 \
	-C link-arg=--max-memory=4294967296
CHROMIUM ?= /usr/bin/chromium
VIEW := 1920x1080 fov=45 dist=4

help: ## this list
	@echo "make demo and make test are all there is to set up; each says what is missing."
	@echo
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: need-rust ## build chordal and run the main job on the teapot; results in out/
	$(CARGO) build --release --locked -p chordal-cli
	mkdir -p out
	$(CHORDAL) mesh examples/teapot.bpt --px 1 --view "$(VIEW)" -o out/teapot.glb --force --json > out/teapot.json
	$(CHORDAL) mesh examples/teapot.bpt --tol 0.001 -o out/teapot-tol.obj --force --json > out/teapot-tol.json
	$(CHORDAL) inspect out/teapot.glb
	$(CHORDAL) render out/teapot.glb -o out/teapot.png --force
	@echo
	@echo "out/teapot.glb       the teapot, off by at most 1 pixel from any side at $(VIEW)"
	@echo "out/teapot.json      its report: the bound, and how it is known"
	@echo "out/teapot.png       a picture of it"
	@echo "out/teapot-tol.obj   the teapot, off by at most 0.001; its report is out/teapot-tol.json"
	@echo
	@echo "Run chordal as $(CHORDAL), or 'make install' and then as chordal. Try: $(CHORDAL) --help"

# The page comes first, so that it is built into the command.
studio: studio-page ## build the page of 'chordal studio', and the command with it
	$(CARGO) build --release --locked -p chordal-cli
	@echo
	@echo "Run $(CHORDAL) studio and open the link that it prints."
	@echo "studio/dist/page holds the same page as plain files, for any host; with ?embed=1 for a frame in another page."

# What the widget and the exhibits ask is compiled once, and linked into as many modules as pages ask for; the workbench runs
# the command.
MODULE = --profile $(MODULE_PROFILE) --locked --no-default-features -p chordal-wasm $(MODULE_TOO) --target $(MODULE_TARGET)
PAGE_MODULE = rustc $(MODULE) --features exhibits --crate-type staticlib
PAGE_LIBRARY = $(dir $(WASM))libchordal_wasm.a
studio-page: need-rust need-wasm need-node need-node-20 studio/node_modules
	$(CARGO) $(PAGE_MODULE)
	node studio/scripts/link.mjs $(PAGE_LIBRARY)
	$(CARGO) build --profile $(WEB_PROFILE) --locked -p chordal-cli --no-default-features --features chordal-cli/threads \
		--target $(WASI_TARGET)
	cmp -s $(WASI) studio/wasm/command.wasm || cp $(WASI) studio/wasm/command.wasm
	cd studio && npm run --silent build && node scripts/notebook.mjs

# The studio's page is built before the command is, and so is in it wherever the tests use it.
test: export WEB_PROFILE := web-test
test: export MODULE_PROFILE := web-test
test: export CHORDAL_PAGE_QUALITY := 5
# Beside the command the modules share all that it is made of, built once. For its target they have imports, which their
# hosts in tests refuse; those that are shipped have none, and test-long judges them.
test: export MODULE_TARGET := $(WASI_TARGET)
test: export MODULE_TOO := -p chordal-cli --features chordal-cli/threads
# To compile the library beside the command is to have a module of it and no archive to link from: one module has every name.
test: export PAGE_MODULE = build $(MODULE) --features chordal-wasm/exhibits
test: export PAGE_LIBRARY = $(WASM)
test: fmt-check lint studio-page test-rust test-studio test-web test-looks test-tiles test-python ## everything that CI runs
	@echo "All tests passed."

fmt-check: need-rust
	$(CARGO) fmt --all --check

lint: need-rust need-python
	$(CARGO) clippy --workspace --all-targets --locked -- -D warnings
	$(CARGO) clippy -p chordal-wasm --no-default-features --features exhibits --locked -- -D warnings

# Everything with the oldest compiler that Cargo.toml promises. Only what compiles: lints differ between versions.
OLDEST = $(shell sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
oldest: need-rust ## compile with the oldest Rust that is supported
	rustup toolchain install $(OLDEST) --profile minimal
	$(CARGO) +$(OLDEST) check --workspace --locked --target-dir $(TARGET)/oldest

# The tests of the workspace, doctests included.
test-rust: need-rust need-python
	$(CARGO) test --workspace --locked --no-fail-fast
	@[ -d "$${CHORDAL_DATA:-../shared/data}" ] \
		|| echo "SKIPPED: the tests on foreign files, because there is no folder $${CHORDAL_DATA:-../shared/data}."

# The command and the example for test-tiles with the features of test-rust, which leaves nothing to do.
tested: need-rust
	$(CARGO) build --workspace --locked --bin chordal --example tileset_of_levels

# The same bytes in WASM as natively, and no complaint of Khronos' validator about any GLB that we write.
test-web: tested need-wasm need-node tests/web/node_modules
	$(CARGO) build $(MODULE) --features chordal-wasm/files,chordal-wasm/exhibits
	mkdir -p $(TARGET)/web
	$(TESTED) mesh examples/teapot.bpt --tol 0.001 -o $(TARGET)/web/tol.glb --force -q
	$(TESTED) mesh examples/teapot.bpt --px 1 --view "$(VIEW)" -o $(TARGET)/web/px.glb --force -q
	$(TESTED) mesh examples/teapot.bpt --triangles 1000 -o $(TARGET)/web/triangles.glb --force -q
	for isa in plain avx2 avx512; do \
		CHORDAL_ISA=$$isa $(TESTED) mesh examples/teapot.bpt --tol 0.001 -o $(TARGET)/web/isa.glb --force -q; \
		cmp $(TARGET)/web/tol.glb $(TARGET)/web/isa.glb; \
	done
	node tests/web/wasm.mjs $(WASM) $(TARGET)/web/tol.glb examples/teapot.bpt
	$(TESTED) mesh examples/drawing.svg --tol 0.001 -o $(TARGET)/web/drawing.json --force -q
	node tests/web/wasm.mjs $(WASM) $(TARGET)/web/drawing.json examples/drawing.svg
	$(TESTED) mesh tests/web/washer.vm --tol 0.005 -o $(TARGET)/web/washer.glb --force -q
	node tests/web/wasm.mjs $(WASM) $(TARGET)/web/washer.glb tests/web/washer.vm 0.005
	$(TESTED) mesh tests/web/painted.gltf --tol 2% -o $(TARGET)/web/painted.glb --force -q
	$(TESTED) lod tests/web/painted.gltf --px 1 -o $(TARGET)/web/painted_levels.glb --force -q
	$(TESTED) mend tests/web/painted.gltf --drop-unused -o $(TARGET)/web/painted_mended.glb --force -q
	for verb in "mesh --tol 2%" "lod --px 1" "mend --drop-unused" "mesh --tol 2% --compress meshopt" \
		"mesh --tol 2% --quantize" "convert --quantize --compress meshopt"; do \
		$(TESTED) $$verb tests/web/painted.gltf -o $(TARGET)/web/painted.gltf --separate --force -q && \
		node tests/web/validate.mjs $(TARGET)/web/painted.gltf || exit 1; \
	done
	$(TESTED) lod tests/web/painted.gltf --px 1 --compress meshopt -o $(TARGET)/web/painted_packed.glb --force -q
	$(TESTED) lod tests/web/painted.gltf --tol 0.5% --tile-triangles 60 -o $(TARGET)/web/painted_tiles/ --force -q
	$(TESTED) lod tests/web/painted.gltf --tol 0.5% --tile-triangles 60 --quantize -o $(TARGET)/web/painted_small_tiles/ --force -q
	for tiles in painted_tiles painted_small_tiles; do node tests/web/tileset.mjs $(TARGET)/web/$$tiles || exit 1; done
	$(TESTED) lod tests/web/painted.gltf --px 1 --quantize -o $(TARGET)/web/painted_small.glb --force -q
	node tests/web/validate.mjs $(TARGET)/web/*.glb $(TARGET)/web/painted_tiles/*.glb $(TARGET)/web/painted_small_tiles/*.glb
	node tests/web/meshopt.mjs crates/chordal-io/tests/data/meshopt_streams.json
	node tests/web/draco.mjs crates/chordal-io/tests/data/draco_streams.json

# An asset before and after each verb in three.js, and one without its materials, which has to be seen.
LOOKS := $(TARGET)/web/looks
test-looks: tested need-node need-chromium tests/web/node_modules
	mkdir -p $(LOOKS)
	$(TESTED) mesh tests/web/painted.gltf --tol 0.3% -o $(LOOKS)/meshed.glb --force -q
	$(TESTED) lod tests/web/painted.gltf --px 1 -o $(LOOKS)/levels.glb --force -q
	$(TESTED) mend tests/web/painted.gltf --drop-unused -o $(LOOKS)/mended.gltf --separate --force -q
	$(TESTED) convert tests/web/painted.gltf $(LOOKS)/compressed.glb --compress meshopt --force -q
	$(TESTED) convert tests/web/painted.gltf $(LOOKS)/quantized.glb --quantize --force -q
	$(TESTED) convert tests/web/painted.gltf $(LOOKS)/converted.obj --force -q
	$(TESTED) convert $(LOOKS)/converted.obj $(LOOKS)/converted.glb --force -q
	CHROMIUM=$(CHROMIUM) node tests/web/looks.mjs tests/web/painted.gltf \
		$(LOOKS)/meshed.glb $(LOOKS)/levels.glb $(LOOKS)/mended.gltf $(LOOKS)/converted.glb $(LOOKS)/compressed.glb \
		$(LOOKS)/quantized.glb
	$(TESTED) convert tests/web/painted.gltf $(LOOKS)/bare.ply --force -q
	$(TESTED) convert $(LOOKS)/bare.ply $(LOOKS)/bare.glb --force -q
	CHROMIUM=$(CHROMIUM) node tests/web/looks.mjs --other tests/web/painted.gltf $(LOOKS)/bare.glb

# Patches, a cage and a mesh that is cut in space as tilesets, and one that is cut so that levels do not match, which the
# judges of viewers have to see.
TILESETS := $(TARGET)/web/tilesets
tilesets: tested need-node need-chromium tests/web/node_modules
	rm -rf $(TILESETS) && mkdir -p $(TILESETS)
	$(TESTED) lod examples/teapot.bpt --px 1 --nearest 12 -o $(TILESETS)/teapot/ -q
	$(TESTED) lod examples/cube.obj --px 1 -o $(TILESETS)/cube/ -q
	$(TESTED) mesh examples/cube.obj --tol 0.0005 -o $(TILESETS)/cube.ply -q
	$(TESTED) lod $(TILESETS)/cube.ply --tol 0.0005 --tile-triangles 500 -o $(TILESETS)/parts/ -q
	for tol in 0.1 0.03 0.01 0.001; do \
		$(TESTED) mesh examples/cube.obj --surface catmull-clark --tol $$tol -o $(TILESETS)/cube-$$tol.glb -q; \
	done
	levels=$(abspath $(TARGET))/debug/examples/tileset_of_levels && cd $(TILESETS) && \
		$$levels --split cut cube-{0.1,0.03,0.01,0.001}.glb

# Tilesets by the text of the specification, their GLBs by Khronos' validator, and both in a viewer.
test-tiles: tilesets
	node tests/web/tileset.mjs $(TILESETS)/{teapot,cube,parts,cut}
	node tests/web/validate.mjs $(TILESETS)/*/*.glb
	CHROMIUM=$(CHROMIUM) node tests/web/tiles.mjs $(TILESETS)/teapot
	CHROMIUM=$(CHROMIUM) node tests/web/tiles.mjs --closed $(TILESETS)/cube $(TILESETS)/parts
	CHROMIUM=$(CHROMIUM) node tests/web/tiles.mjs --cracks $(TILESETS)/cut

# The same in a second viewer, with a field and a large mesh too, and what a third program makes of the tree. Some 200 MB of packages.
test-viewers: tilesets tests/viewers/node_modules
	$(TESTED) lod examples/block.star --tol 0.1% -o $(TILESETS)/block/ -q
	$(TESTED) mesh examples/teapot.bpt --tol 0.0002 -o $(TILESETS)/teapot.ply -q
	$(TESTED) lod $(TILESETS)/teapot.ply --tol 0.0005 --tile-triangles 5000 -o $(TILESETS)/large/ -q
	node tests/viewers/tools.mjs $(TILESETS)/{teapot,cube,parts,cut,block,large}
	CHROMIUM=$(CHROMIUM) node tests/web/tiles.mjs --closed $(TILESETS)/block
	CHROMIUM=$(CHROMIUM) node tests/web/tiles.mjs $(TILESETS)/large
	CHROMIUM=$(CHROMIUM) node tests/viewers/cesium.mjs $(TILESETS)/teapot $(TILESETS)/large
	CHROMIUM=$(CHROMIUM) node tests/viewers/cesium.mjs --closed $(TILESETS)/cube $(TILESETS)/parts $(TILESETS)/block
	CHROMIUM=$(CHROMIUM) node tests/viewers/cesium.mjs --cracks $(TILESETS)/cut

# The packages of a lock file, once for each lock file.
%/node_modules: %/package-lock.json
	cd $* && npm ci --no-audit --no-fund --loglevel=error $(if $(filter tests/viewers,$*),--ignore-scripts)
	touch $@

# Types, texts and state; then the page as readers meet it, in a real browser and behind the real server.
test-studio: studio-page tested need-chromium
	cd studio && npm run --silent check && CHORDAL=$(abspath $(TESTED)) npm run --silent test
	cd studio && $(LONG) CHROMIUM=$(CHROMIUM) CHORDAL=$(abspath $(TESTED)) npm run --silent test:page

# The wheel is built and installed as `pip install .` does it, and then judged from outside: by its tests, by the examples in its
# documentation, and by mypy and pyright; mypy also compares the stubs with what is there. ruff reads all Python of the tree. The
# wheel shares what test-rust has compiled; test-long judges the one for release.
WHEEL := --profile dev --features as-tested
# The notebooks as its tests have run them, with what they have shown, for docs-site.
NOTEBOOKS := $(TARGET)/python/notebooks
test-python: tested need-python need-node
	@ldconfig -p | grep libusb-1.0 > /dev/null || { apt-get update -qq && apt-get install -qq -y libusb-1.0-0 > /dev/null; } \
		|| echo "Open3D needs libusb-1.0 (on Debian: apt install libusb-1.0-0): its tests fail without it."
	@cat tests/python/requirements.txt tests/python/requirements-readers.txt | cmp -s - $(VENV)/requirements.txt || { rm -rf $(VENV) \
		&& python3 -m venv $(VENV) && $(VENV)/bin/python -m pip install -q -r tests/python/requirements.txt \
		&& $(VENV)/bin/python -m pip install -q --no-deps -r tests/python/requirements-readers.txt \
		&& cat tests/python/requirements.txt tests/python/requirements-readers.txt > $(VENV)/requirements.txt; }
	rm -rf $(TARGET)/python/wheel
	PATH="$(abspath $(VENV))/bin:$$PATH" $(VENV)/bin/python -m pip wheel -q --no-deps --no-build-isolation \
		--config-settings=build-args="$(WHEEL)" -w $(TARGET)/python/wheel .
	$(VENV)/bin/python -m pip install -q --no-deps --force-reinstall $(TARGET)/python/wheel/*.whl
	$(VENV)/bin/python -m ruff check --no-cache --quiet .
	CHORDAL=$(abspath $(TESTED)) CHORDAL_NOTEBOOKS=$(abspath $(NOTEBOOKS)) $(VENV)/bin/python -m pytest -q -n auto
	export MYPY_CACHE_DIR=$(TARGET)/python/mypy && $(VENV)/bin/python -m mypy tests/python \
		&& $(VENV)/bin/python -m mypy -p chordal && $(VENV)/bin/python -m mypy.stubtest --mypy-config-file pyproject.toml \
		--allowlist tests/python/stubtest.txt chordal

# What is given away: the wheel of this system and the source distribution, in dist/ of the target folder. cibuildwheel does the
# same for other systems, with the page and the viewer that are built here. A wheel has at most 20 MB.
WHEELS := $(TARGET)/python/dist
wheel: export CARGO_PROFILE_RELEASE_LTO := fat
wheel: export CARGO_PROFILE_RELEASE_CODEGEN_UNITS := 1
wheel: studio-page need-python ## the Python package as it is given away: a wheel for this system, and its source
	rm -rf $(WHEELS) $(TARGET)/python/smoke
	python3 -m venv $(TARGET)/python/smoke && $(TARGET)/python/smoke/bin/python -m pip install -q -c tests/python/requirements.txt numpy maturin
	PATH="$(abspath $(TARGET))/python/smoke/bin:$$PATH" maturin sdist -o $(WHEELS)
	PATH="$(abspath $(TARGET))/python/smoke/bin:$$PATH" $(TARGET)/python/smoke/bin/python -m pip wheel -q --no-deps \
		--no-build-isolation -w $(WHEELS) $(WHEELS)/*.tar.gz
	$(TARGET)/python/smoke/bin/python -m pip install -q --no-deps $(WHEELS)/*.whl
	$(TARGET)/python/smoke/bin/python tests/python/smoke.py
	@ls -l $(WHEELS)
	@[ $$(wc -c < $$(ls $(WHEELS)/*.whl)) -le 20000000 ] || { echo "The wheel has more than 20 MB." >&2; exit 1; }

# What `make test` leaves to this, so that it takes three quarters of an hour from cold and not hours: nineteen of twenty
# random cases of every sweep that asks chordal-testkit's `cases`, what its `is_long` guards, and all but nine of the random
# scripts of fields. The modules of the page and of test-web are those that are shipped, too, and axe looks at every page in
# each theme of each language. PROPTEST_CASES is for the sweeps at proptest's own number.
test-long: WHEEL := --profile release
test-long: LONG := CHORDAL_LONG=1
test-long: need-rust need-fuzz oldest test-viewers test-web test-studio test-python docs-site ## the tests with many more random cases, and a second viewer of tilesets, fuzzing; minutes to days
	CHORDAL_LONG=1 PROPTEST_CASES=100000 $(CARGO) test --workspace --locked --release
	CHORDAL_LONG=1 CHORDAL=$(abspath $(CHORDAL)) $(VENV)/bin/python -m pytest -q tests/python/test_field_referee.py
	$(VENV)/bin/python -m pip install -q -r tests/python/requirements-long.txt
	$(VENV)/bin/python -m pytest -q tests/python/test_interop.py tests/python/test_images.py tests/python/test_cluster.py tests/python/test_batch_cluster.py tests/python/test_devices.py tests/python/test_sources.py
	mkdir -p $(TARGET)/large && $(VENV)/bin/python tests/python/large_volume.py $(TARGET)/large && rm -rf $(TARGET)/large
	$(MAKE) fuzz

# What a release takes for each reader: two hours of one core.
FUZZ_SECONDS ?= 7200
fuzz: need-fuzz need-python ## every reader fed with random bytes for FUZZ_SECONDS each
	python3 fuzz/run.py --seconds $(FUZZ_SECONDS)

# The package is read and not imported, so nothing is compiled for it. Tutorials show what their cells show where test-python has
# installed the package, which runs those that have changed. A link that leads nowhere ends it.
DOCS_VENV := $(TARGET)/docs/venv
docs-site: need-python ## the pages of docs/ with the reference of the Python package, as a site
	@cmp -s docs/site/requirements.txt $(DOCS_VENV)/requirements.txt || { rm -rf $(DOCS_VENV) \
		&& python3 -m venv $(DOCS_VENV) && $(DOCS_VENV)/bin/python -m pip install -q -r docs/site/requirements.txt \
		&& cp docs/site/requirements.txt $(DOCS_VENV)/; }
	@! $(VENV)/bin/python -c "import chordal, nbclient" 2> /dev/null || $(VENV)/bin/python docs/site/execute.py $(NOTEBOOKS)
	CHORDAL_NOTEBOOKS=$(abspath $(NOTEBOOKS)) NO_MKDOCS_2_WARNING=1 $(DOCS_VENV)/bin/python -m mkdocs build --strict --quiet --site-dir $(abspath $(TARGET))/docs-site
	@echo "$(TARGET)/docs-site/index.html is the site."

bench: need-rust need-python ## side by side with other programs; writes bench/RESULTS.md
	$(MAKE) -C bench

bench-quick: need-rust need-python ## the lines of the targets beside their best peers, in ten minutes; STRICT=--strict fails where one is missed
	$(MAKE) -C bench quick

bench-studio: studio-page need-chromium ## how soon the studio's pages appear and follow a hand, held to their limits; ten minutes of a quiet machine
	cd studio && CHROMIUM=$(CHROMIUM) npm run --silent bench

pictures: need-rust ## take the pictures of the docs again
	$(CARGO) build --release --locked -p chordal-cli
	mkdir -p docs/pictures
	echo '(sphere(1) | torus(1.3, 0.2)) - cylinder(0.45, 4)' > $(TARGET)/two-shores.star
	$(CHORDAL) mesh $(TARGET)/two-shores.star --tol 0.01 -o $(TARGET)/two-shores.ply --force -q
	for of in "two-shores.star shaded field" "two-shores.ply wire mesh"; do set -- $$of; \
		$(CHORDAL) render $(TARGET)/$$1 --show $$2 --view "480x360 fov=30 eye=1,-5,3.5 target=0,0,-0.1" \
			-o docs/pictures/two-shores-$$3.png --force -q; \
	done
	python3 tests/parts/gallery.py --command $(CHORDAL)

install: need-rust ## put chordal where cargo puts programs
	$(CARGO) install --path crates/chordal-cli --locked

clean: ## remove what was built
	rm -rf out $(TARGET) tests/web/node_modules tests/viewers/node_modules studio/node_modules studio/wasm studio/dist/page studio/dist/page.br

# at-least FOUND WANTED: whether version FOUND is WANTED or newer.
at-least = [ "$$(printf '%s\n' $(2) "$(1)" | sort -V | head -n 1)" = $(2) ]

need-rust:
	@command -v $(CARGO) > /dev/null \
		|| { echo "Chordal needs Rust 1.92 or newer: install rustup from https://rustup.rs and open a new shell." >&2; exit 1; }
	@version=$$($(CARGO) --version | cut -d ' ' -f 2); $(call at-least,$$version,1.92) \
		|| { echo "Chordal needs Rust 1.92 or newer, not $$version: install rustup from https://rustup.rs, which fetches it." >&2; exit 1; }
	@command -v cc > /dev/null \
		|| { echo "Rust needs a C linker: install gcc (on Debian: apt install gcc libc6-dev)." >&2; exit 1; }

need-fuzz: need-rust
	@$(CARGO) +nightly --version > /dev/null 2>&1 \
		|| { echo "Fuzzing needs a nightly compiler: run 'rustup toolchain install nightly --profile minimal'." >&2; exit 1; }
	@$(CARGO) +nightly fuzz --version > /dev/null 2>&1 \
		|| { echo "Fuzzing needs cargo-fuzz: run 'cargo install cargo-fuzz'." >&2; exit 1; }

need-wasm: need-rust
	@for target in wasm32-unknown-unknown $(WASI_TARGET); do \
		[ -d "$$(rustc --print sysroot)/lib/rustlib/$$target" ] \
			|| { command -v rustup > /dev/null && rustup target add $$target; } \
			|| { echo "The web tests need Rust's target $$target: install rustup and run 'rustup target add $$target'." >&2; exit 1; }; \
	done

need-node:
	@{ command -v node && command -v npm; } > /dev/null \
		|| { echo "The web tests need Node 18 or newer with npm: install them from https://nodejs.org (on Debian: apt install nodejs npm)." >&2; exit 1; }
	@version=$$(node --version | tr -d v); $(call at-least,$$version,18) \
		|| { echo "The web tests need Node 18 or newer, not $$version: install it from https://nodejs.org." >&2; exit 1; }

# The page's tools ask for more than the other tests do.
need-node-20: need-node
	@version=$$(node --version | tr -d v); \
		case $$version in 20.*) least=20.19;; *) least=22.13;; esac; $(call at-least,$$version,$$least) \
		|| { echo "The studio needs Node 20.19 or later in its line, 22.13, or newer, not $$version: install it from https://nodejs.org." >&2; exit 1; }

need-chromium:
	@[ -x $(CHROMIUM) ] \
		|| { [ "$$(id -u)" = 0 ] && command -v apt-get && apt-get update && apt-get install -y --no-install-recommends chromium; } > /dev/null 2>&1 \
		|| { echo "The tests in a browser need Chromium: install it (on Debian: apt install chromium), or name it with CHROMIUM=PATH." >&2; exit 1; }

need-python:
	@command -v python3 > /dev/null \
		|| { echo "Chordal's Python package and its benches need Python 3.10 or newer: install it (on Debian: apt install python3 python3-venv)." >&2; exit 1; }
	@version=$$(python3 -c 'import platform; print(platform.python_version())'); $(call at-least,$$version,3.10) \
		|| { echo "Chordal's Python package and its benches need Python 3.10 or newer, not $$version: install it from https://www.python.org." >&2; exit 1; }
	@python3 -c 'import ensurepip, venv' 2> /dev/null \
		|| { echo "Python's module venv is missing: install it (on Debian: apt install python3-venv)." >&2; exit 1; }
