# The Debian packages that `make package` writes of the build folder: a component of install() each.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_CONTACT "The Poise developers <maintainers@users.noreply.h-seed-82e026d3.example>")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# Each package has a summary of its own.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PRE_BUILD_SCRIPTS "${CMAKE_CURRENT_LIST_DIR}/finish_debian.cmake")
set(CPACK_POISE_SOURCES "${PROJECT_SOURCE_DIR}")

# poise_package(COMPONENT PACKAGE SECTION "summary" "description" [FIELD value]...)
# FIELD is one of CPACK_DEBIAN_PACKAGE_FIELD: DEPENDS, RECOMMENDS, SHLIBDEPS ...
function(poise_package component package section summary description)
  set(fields NAME "${package}" SECTION "${section}" ${ARGN})
  string(TOUPPER "${component}" prefix)
  while(fields)
    list(POP_FRONT fields field value)
    set(CPACK_DEBIAN_${prefix}_PACKAGE_${field} "${value}" PARENT_SCOPE)
  endwhile()
  set(CPACK_DEBIAN_${prefix}_DESCRIPTION "${summary}\n${description}" PARENT_SCOPE)
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} "${component}" PARENT_SCOPE)
  set(CPACK_POISE_PACKAGES ${CPACK_POISE_PACKAGES} "${package}" PARENT_SCOPE)
endfunction()

set(CPACK_COMPONENTS_ALL)
set(about "Poise computes equilibria, joint forces and motions of mechanisms of pins,
slides, bars, springs, dampers, friction, loads and stops, and identifies
masses, stiffnesses and damping from measured motions. Every equilibrium is
proved in ball arithmetic.")
poise_package(program poise science "equilibria and motions of planar mechanisms"
  "${about}\n.\nThis package contains the program, its documentation and example scenes."
  SHLIBDEPS ON SUGGESTS "gnuplot-nox, poise-mpi, python3-poise")
if(TARGET poise_mpi)
  poise_package(mpi poise-mpi science "planar mechanisms - studies on many machines"
    "${about}\n.\nThis package lets poise montecarlo run under mpirun."
    SHLIBDEPS ON DEPENDS "poise (= ${PROJECT_VERSION}), openmpi-bin")
endif()
poise_package(dev libpoise-dev libdevel "planar mechanisms - C++ library"
  "${about}\n.\nThis package contains the static libraries, the headers, and\nthe files for CMake and pkg-config."
  # What poiseConfig.cmake and poise.pc name.
  DEPENDS "coinor-libipopt-dev, libceres-dev, libeigen3-dev, libflint-arb-dev, libflint-dev, libfmt-dev, libgmp-dev, \
libnlopt-cxx-dev, libnlopt-dev, libpugixml-dev, libsleef-dev, libsuitesparse-dev, libtomlplusplus-dev, pkg-config")
if(TARGET poise_python)
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  poise_package(python_debian python3-poise python "planar mechanisms - Python module"
    "${about}\n.\nThis package contains the Python module, whose results are NumPy\narrays, and pictures in a notebook."
    SHLIBDEPS ON
    DEPENDS "python3 (>= 3.${Python_VERSION_MINOR}~), python3 (<< 3.${next}), python3-numpy (>= 1:1.22)"
    SUGGESTS "gnuplot-nox, poise, python3-matplotlib, python3-pandas")
  # A list, which the fields of poise_package() cannot be.
  set(CPACK_DEBIAN_PYTHON_DEBIAN_PACKAGE_CONTROL_EXTRA
    "${CMAKE_CURRENT_LIST_DIR}/postinst;${CMAKE_CURRENT_LIST_DIR}/prerm")
endif()
include(CPack)
