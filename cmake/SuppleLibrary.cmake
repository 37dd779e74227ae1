# The engine as an installed library: `cmake --install build/release --component library`, then find_package(Supple). Without
# the rooms that train networks and make data sets: those are programs' (supple-lab).
include(CMakePackageConfigHelpers)

supple_install_rooms(base meshing outlines families tiling files dataset neural numerics surface embedded voronoi microscale weave
  design)
# Libraries that Debian has no CMake package for, as the rooms found them.
foreach(name hdf5 gmsh cholmod)
  supple_export(${name})
endforeach()

# What a program can ask for by itself. voronoi, outlines and dataset are rooms, whose names these components have.
supple_component(geodesics surface)
supple_component(networks embedded)
supple_component(voronoi)
supple_component(tilings tiling microscale)
supple_component(designs design neural tiling microscale)
supple_component(weaves weave)
supple_component(outlines)
supple_component(dataset)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/Supple)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/SuppleConfig.cmake.in ${PROJECT_BINARY_DIR}/SuppleConfig.cmake
  INSTALL_DESTINATION ${package})
# Before version 1 a program is made for one minor version.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/SuppleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/SuppleConfig.cmake ${PROJECT_BINARY_DIR}/SuppleConfigVersion.cmake DESTINATION ${package}
  COMPONENT library)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/engine/examples/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT library)
