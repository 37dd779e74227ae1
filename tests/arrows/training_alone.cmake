# Fails unless the preset "training" configures without the packages that only meshes, simulations, the server, its client
# and the tests need, and makes the rooms of the training and no others. Run from the root of the checkout with BUILD, a
# folder for the build tree, and TORCH, where LibTorch's TorchConfig.cmake is.
file(REMOVE_RECURSE ${BUILD})

# A required package that is disabled ends the configuration.
foreach(package GTest PkgConfig httplib prometheus-cpp spdlog nlohmann_json SQLite3 OpenSSL benchmark CGAL)
  list(APPEND disabled -D CMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
execute_process(COMMAND ${CMAKE_COMMAND} --preset training -B ${BUILD} -D "Torch_DIR=${TORCH}" ${disabled}
  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "The preset does not configure:\n${output}")
endif()

# Libraries that are found by name alone, and what the link lines say.
file(STRINGS ${BUILD}/CMakeCache.txt found REGEX "^(GMSH|CHOLMOD|POLYCLIPPING)")
file(STRINGS ${BUILD}/build.ninja linked REGEX "LINK_LIBRARIES.*(gmsh|polyclipping|cholmod|httplib|prometheus|gtest)")
if(found OR linked)
  message(FATAL_ERROR "The preset looks for or links what it must not need:\n${found}\n${linked}")
endif()

file(STRINGS ${BUILD}/build.ninja lines REGEX "^build engine/[a-z_/]*libsupple_[a-z_]*\\.a:")
list(TRANSFORM lines REPLACE ".*libsupple_([a-z_]*)\\.a:.*" "\\1" OUTPUT_VARIABLE rooms)
list(SORT rooms)
set(wanted base dataset engine_version families files neural training)
if(NOT rooms STREQUAL wanted)
  message(FATAL_ERROR "The preset builds the rooms ${rooms}, not ${wanted}.")
endif()
file(STRINGS ${BUILD}/build.ninja programs REGEX "^build .*: CXX_EXECUTABLE_LINKER")
list(LENGTH programs number)
if(NOT number EQUAL 1 OR NOT programs MATCHES "engine/lab/supple-lab:")
  message(FATAL_ERROR "The preset builds other programs than supple-lab:\n${programs}")
endif()
