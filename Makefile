# Short commands. All work is done by CMake: see CMakePresets.json and CMakeLists.txt.
#   make run | test | python | campaign | sanitize | fuzz | arm64 | mutants | bench | benchmarks | figures | docs | site
#        lint | lint-all | format | compile-time | install PREFIX=/usr/local | package | package-tar | package-wheel
#        package-test | setup | clean
# PRESET=daily, for daily work, compiles every source alone into build-daily, so that little is compiled after a change.
# PRESET=debug builds with the address and undefined behaviour sanitizers into build-debug.
# PRESET=clang builds by clang into build-clang.
# TESTS=regex: of `make test` and `make campaign` only the suites, and random tests, whose names match.

PRESET ?= $(if $(CI),ci,release)
PREFIX ?= /usr/local
JOBS ?= $(shell nproc)
# Tests that look at pages wait for a browser half of their time.
TEST_JOBS := $(shell expr $(JOBS) + 1)
comma := ,
BUILD := build$(addprefix -,$(filter daily debug clang,$(PRESET)))

SOURCE_FOLDERS := model solvers studies statics comparison motion design identification exchange app python
sources_under = $(sort $(foreach folder,$(1),$(wildcard $(addprefix $(folder)/,*.[ch]pp */*.[ch]pp */*/*.[ch]pp))))

.PHONY: run test python campaign sanitize fuzz arm64 mutants bench benchmarks figures docs site lint lint-all lint-setup \
  format compile-time install package package-tar package-wheel package-test setup configure app all clean

run: app
	$(BUILD)/poise compare datasets/toggle_clamp.toml --svg $(BUILD)/toggle_clamp.svg

test: all
	ctest --preset $(PRESET) -j $(TEST_JOBS) $(if $(TESTS),--tests-regex '$(TESTS)')
	@awk '/: Skipped$$/ { getline why; print "skipped: " why }' $(BUILD)/Testing/Temporary/LastTest.log | sort | uniq -c

# The Python module alone: builds it into build/python and runs its tests, some of which run the command line too.
python: configure
	cmake --build --preset $(PRESET) -j $(JOBS) --target poise_python poise
	ctest --preset $(PRESET) -j $(JOBS) --tests-regex '^Python\.$(TESTS)'

# Random tests with other seeds than those of `make test`, SEEDS rounds of them; goes on where it was interrupted. Without
# TESTS those with Random or Mutations in their names; others draw from test::seed() too (tests/support/seed.hpp).
SEEDS ?= 100
campaign: all
	tests/campaign.sh $(BUILD) $(JOBS) $(SEEDS) '$(TESTS)'

# Every eighth test, or of another number, under the address and undefined behaviour sanitizers: SLICE=3/8 is the third
# of eight slices, which together are all tests.
SLICE ?= 1/8
sanitize:
	$(MAKE) all PRESET=debug
	ctest --preset debug -j $(JOBS) --tests-information $(subst /,$(comma)$(comma),$(SLICE))

# Puts one error after the other into bounds and proofs, and requires that the tests notice each (an hour);
# ONLY='box_prover.cpp: a sliver' tries those whose file and name match.
mutants: all
	cmake -D source_dir=$(CURDIR) -D build_dir=$(CURDIR)/$(BUILD) -D generator=Ninja -D compiler=$(or $(CXX),c++) \
	  -D jobs=$(JOBS) -D "only=$(ONLY)" -P tests/mutants/run.cmake

# Hands damaged inputs to the readers (libFuzzer, clang), SECONDS to each of TARGETS; needs half an hour to build.
SECONDS ?= 3600
fuzz: setup
	cmake/setup.sh fuzz
	cmake --preset fuzz
	cmake --build --preset fuzz -j $(JOBS)
	tests/fuzz/run.sh build-fuzz $(SECONDS) '$(TARGETS)'

# Tests of the solvers and of interval arithmetic on arm64: compiled for it here, run by qemu.
arm64: setup
	cmake/setup.sh arm64
	cmake/arm64_sysroot.sh build-arm64/sysroot
	cmake --preset arm64
	cmake --build --preset arm64 -j $(JOBS)
	qemu-aarch64 -L build-arm64/sysroot build-arm64/tests/poise_solvers_tests --gtest_brief=1

bench: benchmarks
	$(BUILD)/benchmarks/poise_ratios
	$(BUILD)/benchmarks/poise_scaling
	$(BUILD)/benchmarks/poise_baselines
	$(BUILD)/benchmarks/poise_integrators
	$(BUILD)/benchmarks/poise_contact_work
	$(BUILD)/benchmarks/poise_identification_ratios $(wildcard ../shared/data/multi_arm_pendulum/double.csv)
	$(BUILD)/benchmarks/poise_studies_benchmark
	$(BUILD)/benchmarks/poise_path_ratios
	$(BUILD)/benchmarks/poise_design_cost
	$(BUILD)/benchmarks/poise_many
	$(BUILD)/benchmarks/poise_page_latency
	$(BUILD)/benchmarks/poise_benchmarks --benchmark_min_time=0.1 $(ARGS)
	PYTHONPATH=$(BUILD)/python /usr/bin/python3 benchmarks/python_calls.py
	$(MAKE) figures PRESET=$(PRESET)

# Makes every picture and table of README.md and docs/ anew on this machine.
figures: all
	POISE_PICTURE=$(CURDIR)/docs/view.png $(BUILD)/tests/poise_page_tests --gtest_brief=1 --gtest_filter='ViewPage.Picture'
	$(BUILD)/poise compare datasets/toggle_clamp.toml --svg docs/toggle_clamp.svg
	$(BUILD)/poise path datasets/toggle_clamp.toml --vary load.P=0..60 --follow jump --quiet \
	  --html docs/toggle_clamp_path.html
	$(BUILD)/poise tolerance datasets/toggle_clamp.toml --tolerances datasets/toggle_clamp_tolerances.toml \
	  --of force.rubber --quiet --svg docs/clamp_force.svg
	$(BUILD)/poise compare datasets/six_bar.toml --tolerances 1e-2..1e-14 --svg docs/work_precision.svg
	$(BUILD)/poise identify datasets/lift_experiment.toml --svg docs/lift_fit.svg
	$(BUILD)/poise path datasets/von_mises_toggle.toml --vary load.P=0..60 --quiet --svg docs/toggle_path.svg
	$(BUILD)/poise equilibria datasets/von_mises_toggle.toml --quiet --svg docs/toggle_equilibria.svg
	$(BUILD)/poise find datasets/toggle_clamp.toml --vary spring.rubber.stiffness=200..800 --for "force.rubber = -700" \
	  --quiet --svg docs/clamp_find.svg
	$(BUILD)/poise hold datasets/friction/drawer.toml --vary load.P --quiet --svg docs/drawer.svg
	$(BUILD)/poise loads datasets/structures/three_hinged_portal.toml --quiet --svg docs/portal_loads.svg
	$(BUILD)/poise response datasets/duffing.toml --excite load.F --amplitude 0.2 --of x.mass.C --from 0.05 --to 0.4 \
	  --quiet --svg docs/duffing_response.svg
	$(BUILD)/poise stress --starts 10 --work 4000 --markdown docs/stress.md
	$(BUILD)/poise stress --safeguards --starts 20 --work 40000 --markdown docs/safeguards.md

# The outputs that README.md and docs/ show, made anew; the cuts "..." stay.
docs: all
	POISE_UPDATE_DOCS=1 $(BUILD)/tests/poise_docs_tests --gtest_brief=1
	POISE_UPDATE_DOCS=1 ctest --preset $(PRESET) --tests-regex '^Python.docs$$'

# The site, from README.md, docs/ and the sources, into build/site/html: index.html opens from disk. Where a browser is
# installed, every page is looked at in it.
site: all
	cmake/setup.sh site
	/usr/bin/python3 -B docs/site/build.py $(BUILD)
	POISE_SITE=$(BUILD)/site/html $(BUILD)/tests/poise_page_tests --gtest_brief=1 --gtest_filter='Site.*'

# Every source alone, without precompiled headers: clang-tidy cannot read those of GCC, and every source must include what it
# uses. `make lint` checks the sources that are affected by what has changed since `make lint-all` last checked all.
lint lint-all: lint-setup
	@clang-format --dry-run --Werror $(call sources_under,$(SOURCE_FOLDERS) tests benchmarks)
	@echo clang-format: clean
	@flake8 --max-line-length 120 --per-file-ignores 'python/poise/_commands.py:E501 tests/python/test_*:E501' \
	  setup.py python tests/python cmake/package docs/figures docs/site tests/site
	@echo flake8: clean
	cmake/tidy.sh build-lint $(JOBS) $(if $(filter lint-all,$@),all,changed)

lint-setup: setup
	cmake/setup.sh lint
	cmake --preset $(PRESET) -B build-lint -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_UNITY_BUILD=OFF

format:
	cmake/setup.sh lint
	clang-format -i $(call sources_under,$(SOURCE_FOLDERS) tests benchmarks)

install: app
	cmake --install $(BUILD) --prefix $(PREFIX)

# What can be given to others, of the build folder into build/packages: the Debian packages, and an archive of the program
# and a wheel of the Python module that have their libraries inside.
package: configure
	cmake/setup.sh package
	cmake --build --preset $(PRESET) -j $(JOBS) --target poise poise_python
	rm -rf $(BUILD)/packages
	cpack --config $(BUILD)/CPackConfig.cmake -B $(BUILD)/packages
	rm -rf $(BUILD)/packages/_CPack_Packages
	cmake/package/tar.sh $(BUILD) $(BUILD)/packages
	cmake/package/wheel.sh $(BUILD) $(BUILD)/packages
	@cd $(BUILD)/packages && du -h *

package-tar: app
	cmake/package/tar.sh $(BUILD) $(BUILD)/packages

package-wheel: configure
	cmake --build --preset $(PRESET) -j $(JOBS) --target poise_python
	cmake/package/wheel.sh $(BUILD) $(BUILD)/packages

# Installs them in fresh roots of Debian and uses them there, as root; the first time takes minutes more.
package-test: package
	cmake/package/test.sh $(BUILD)/packages $(BUILD)/package-root

setup:
	cmake/setup.sh

configure: setup
	$(if $(filter clang,$(PRESET)),cmake/setup.sh clang)
	cmake --preset $(PRESET)

app: configure
	cmake --build --preset $(PRESET) -j $(JOBS) --target poise

all: configure
	cmake --build --preset $(PRESET) -j $(JOBS)

benchmarks: configure
	cmake --build --preset $(PRESET) -j $(JOBS) --target poise poise_python benchmarks

# Seconds that each unit took to compile when it was last compiled, and their sum over those of a unit that only includes
# Eigen, which does not depend on the machine.
compile-time:
	cmake/compile_time.sh $(BUILD)

clean:
	rm -rf build build-daily build-debug build-lint build-fuzz build-clang build-arm64 build-python
