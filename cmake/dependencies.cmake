# All dependencies of Poise, one line each, with their Debian package: cmake/setup.sh reads the names from here.

# Tools: # apt: cmake ninja-build g++ pkg-config gnuplot-nox
# Tools of `make lint`: # apt lint: clang-format clang-tidy flake8
# Those of `make site`: # apt site: mkdocs mkdocs-material python3-pymdownx libjs-katex nodejs doxygen
# Those of `make fuzz`: # apt fuzz: clang libclang-rt-14-dev
# Those of `make package` and `make package-test`: # apt package: dpkg-dev file lintian debootstrap
# Those of PRESET=clang: # apt clang: clang
# Those of `make arm64`: # apt arm64: g++-aarch64-linux-gnu qemu-user

find_package(PkgConfig REQUIRED)

# The libraries (model, solvers, statics). What a static link needs is found again by poiseConfig.cmake.in.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)                                         # apt: libeigen3-dev
find_package(tomlplusplus 3.3 REQUIRED)                                             # apt: libtomlplusplus-dev
pkg_check_modules(Ipopt REQUIRED IMPORTED_TARGET ipopt)                             # apt: coinor-libipopt-dev
find_package(SuiteSparseParts REQUIRED COMPONENTS amd ldl)             # apt: libsuitesparse-dev
find_package(Boost 1.74 REQUIRED CONFIG)                                            # apt: libboost-dev
find_package(Ceres 2.1 REQUIRED)                                                    # apt: libceres-dev
find_package(NLopt 2.7 REQUIRED)                                                    # apt: libnlopt-cxx-dev libnlopt-dev
find_library(ARB_LIBRARY flint-arb REQUIRED)                                        # apt: libflint-arb-dev
find_path(RANDOM123_INCLUDE Random123/philox.h REQUIRED)                             # apt: librandom123-dev
find_package(Threads REQUIRED)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  set(POISE_VECTOR_KERNELS TRUE)
  find_library(SLEEF_LIBRARY sleef REQUIRED)                                        # apt: libsleef-dev
endif()
find_package(fmt 9 REQUIRED)                                                        # apt: libfmt-dev
find_package(pugixml 1.13 REQUIRED)                                                 # apt: libpugixml-dev

if(POISE_BUILD_PYTHON)
  # The first Python on the PATH that has NumPy: Debian's packages belong to Debian's own.
  function(poise_has_numpy result python)
    execute_process(COMMAND "${python}" -c "import numpy" RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
    if(failed)
      set(${result} FALSE PARENT_SCOPE)
    endif()
  endfunction()
  find_program(Python_EXECUTABLE NAMES python3 PATHS /usr/bin VALIDATOR poise_has_numpy)
  find_package(Python 3.11 REQUIRED COMPONENTS Interpreter Development.Module)         # apt: python3-dev python3-numpy
  set(PYBIND11_FINDPYTHON ON)
  find_package(pybind11 2.10 REQUIRED CONFIG)                                       # apt: pybind11-dev
endif()
if(POISE_BUILD_APP OR POISE_BUILD_PYTHON)
  if(POISE_WITH_MPI)
    set(MPI_CXX_SKIP_MPICXX ON)
    find_package(MPI 3.1 QUIET COMPONENTS CXX)                                      # apt: libopenmpi-dev openmpi-bin
  endif()
  find_package(CLI11 2 REQUIRED)                                                    # apt: libcli11-dev
  find_package(ZLIB 1.2 REQUIRED)                                                   # apt: zlib1g-dev
endif()
if(POISE_BUILD_APP OR POISE_BUILD_PYTHON OR POISE_BUILD_BENCHMARKS)
  find_package(nlohmann_json 3.11 REQUIRED)                                         # apt: nlohmann-json3-dev
endif()
if(POISE_BUILD_TESTS OR POISE_BUILD_BENCHMARKS)
  # Clients of the server of `poise view`.
  pkg_check_modules(HttpLib REQUIRED IMPORTED_TARGET cpp-httplib)                   # apt: libcpp-httplib-dev
endif()
if(POISE_BUILD_TESTS)
  find_package(GTest 1.12 REQUIRED)                                                 # apt: libgtest-dev
  # Of the Python module: its tests, types, notebooks, and installing it into a virtual environment.
  # apt: python3-pytest mypy python3-nbconvert python3-ipykernel python3-venv python3-setuptools python3-wheel
  # Of the packages that have their libraries inside (cmake/package/).              # apt: patchelf
  # What its results give their data to, where it is installed.                      # apt: python3-pandas python3-matplotlib
  # Looked for when tests run, which skip what it checks without it.                 # apt oracles: phcpack
  # The same: the browser that tests of pages run in.                                # apt browser: chromium chromium-driver
endif()
if(POISE_BUILD_BENCHMARKS OR POISE_BUILD_TESTS)
  find_library(MUJOCO_LIBRARY mujoco)                                               # apt baselines: libmujoco-dev
  find_path(MUJOCO_INCLUDE mujoco/mujoco.h)
endif()
if(POISE_BUILD_BENCHMARKS)
  find_package(benchmark 1.7 REQUIRED)                                              # apt: libbenchmark-dev
  find_package(SUNDIALS 6.4)                                                        # apt: libsundials-dev
  # Alternatives to Poise for comparison; large, so installed by `cmake/setup.sh baselines` only.
  find_package(Simbody 3.7 QUIET)                                                   # apt baselines: libsimbody-dev
  find_library(BOX2D_LIBRARY box2d)                                                 # apt baselines: libbox2d-dev
  find_path(BOX2D_INCLUDE box2d/box2d.h)
  function(poise_has_scipy result python)
    execute_process(COMMAND "${python}" -c "import scipy.optimize" RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
    if(failed)
      set(${result} FALSE PARENT_SCOPE)
    endif()
  endfunction()
  find_program(POISE_SCIPY_PYTHON python3 VALIDATOR poise_has_scipy)                # apt baselines: python3-scipy
  # Looked for when poise_path_ratios runs.                                         # apt baselines: auto-07p gfortran
endif()
