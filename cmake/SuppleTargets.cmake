# What every target of the project shares: language, warnings, sanitizers, and how a room is declared.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

# Headers are then read once for twenty files.
if(SUPPLE_GROUPED)
  set(CMAKE_UNITY_BUILD ON)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 20)
endif()

include(GNUInstallDirs)

find_program(SUPPLE_CCACHE ccache)
if(SUPPLE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Paths relative to the checkout: several checkouts share what was compiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
    ${SUPPLE_CCACHE})
endif()

add_library(supple_options INTERFACE)
# Nothing reads errno after a square root; without this each one carries a branch and a call.
target_compile_options(supple_options INTERFACE -fno-math-errno -fno-trapping-math)
target_compile_options(supple_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
  -Woverloaded-virtual)
# Not for users: another version of a compiler, or a build that compiles files one by one, may warn of something else.
if(SUPPLE_WARNINGS_AS_ERRORS)
  target_compile_options(supple_options INTERFACE -Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 sees overlapping copies in std::string's operator+ that are not there (GCC bug 105651).
  target_compile_options(supple_options INTERFACE -Wno-restrict)
  # Kilobytes in use before the compiler looks for what it no longer needs: twenty files at a time take that much anyway, and to look
  # less often saves it a tenth of its time.
  target_compile_options(supple_options INTERFACE --param=ggc-min-heapsize=524288)
endif()
if(SUPPLE_GROUPED)
  # Names of one file's unnamed namespace are seen by the next file.
  target_compile_options(supple_options INTERFACE -Wno-shadow)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(supple_options INTERFACE -Wno-subobject-linkage)
  endif()
endif()
if(SUPPLE_CHECK_PACE)
  # The calls of a report have names then.
  target_compile_definitions(supple_options INTERFACE SUPPLE_CHECK_PACE)
  target_link_options(supple_options INTERFACE -rdynamic)
endif()
if(SUPPLE_SANITIZE)
  target_compile_options(supple_options INTERFACE -fsanitize=${SUPPLE_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all)
  target_link_options(supple_options INTERFACE -fsanitize=${SUPPLE_SANITIZE})
endif()

# supple_room(NAME [FUZZED regex] SOURCES ... PUBLIC ... PRIVATE ...)
# Declares the library supple_NAME from the current folder. Its public headers live in include/supple/NAME and are
# visible only to the targets that link it, so that an include against the house plan does not compile.
function(supple_room name)
  cmake_parse_arguments(room "" "FUZZED" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(supple_${name} STATIC ${room_SOURCES})
  # The name that programs outside use, whether Supple is a folder of theirs or installed.
  add_library(Supple::${name} ALIAS supple_${name})
  target_include_directories(supple_${name} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}> PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_link_libraries(supple_${name} PUBLIC ${room_PUBLIC} PRIVATE ${room_PRIVATE} $<BUILD_INTERFACE:supple_options>)
  # The fuzzers look for new ways through what reads the files and requests of strangers: sources that match FUZZED. What computes
  # goes without, for its loops would become slower and nothing would be found there.
  if(SUPPLE_BUILD_FUZZ AND room_FUZZED STREQUAL ".*")
    target_compile_options(supple_${name} PRIVATE -fsanitize=fuzzer-no-link)
  elseif(SUPPLE_BUILD_FUZZ AND room_FUZZED)
    list(FILTER room_SOURCES INCLUDE REGEX "${room_FUZZED}")
    set_source_files_properties(${room_SOURCES} PROPERTIES COMPILE_OPTIONS -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# supple_compile_quickly(TARGET)
# For programs of tests, which are a large part of the build: at -O1 they are compiled in two thirds of the time. The rooms that they
# test are optimized as ever.
function(supple_compile_quickly name)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Where less is known about values, GCC sees uninitialized ones that are none.
    target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1;-Wno-maybe-uninitialized>)
  endif()
endfunction()

# supple_install_rooms(ROOM ...)
# Installs the libraries and public headers of these rooms and of no others. Each room is exported by itself, so that
# find_package(Supple COMPONENTS ...) reads only those that a component uses.
function(supple_install_rooms)
  foreach(name IN LISTS ARGN)
    get_target_property(folder supple_${name} SOURCE_DIR)
    supple_export(${name})
    install(DIRECTORY ${folder}/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library FILES_MATCHING PATTERN "*.h")
  endforeach()
endfunction()

# supple_export(NAME)
# Installs the target supple_NAME, which programs outside know as Supple::NAME.
function(supple_export name)
  set_target_properties(supple_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS supple_${name} EXPORT Supple_${name} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
  install(EXPORT Supple_${name} NAMESPACE Supple:: FILE Supple_${name}.cmake DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/Supple
    COMPONENT library)
endfunction()

# supple_component(NAME [ROOM ...])
# Declares the component NAME of the installed library: these rooms and all that they use, or the room NAME. Programs link
# Supple::NAME. Appends to SUPPLE_COMPONENTS what SuppleConfig.cmake must know: the component's targets, those that others use first,
# and the libraries of others that it needs, as targets or files.
function(supple_component name)
  if(ARGN)
    add_library(supple_${name} INTERFACE)
    add_library(Supple::${name} ALIAS supple_${name})
    list(TRANSFORM ARGN PREPEND supple_ OUTPUT_VARIABLE rooms)
    target_link_libraries(supple_${name} INTERFACE ${rooms})
    supple_export(${name})
  endif()
  set(targets "")
  set(libraries "")
  supple_collect(supple_${name})
  string(APPEND SUPPLE_COMPONENTS "\nlist(APPEND supple_components ${name})\nset(supple_${name}_targets ${targets})\n"
    "set(supple_${name}_libraries ${libraries})\n")
  set(SUPPLE_COMPONENTS "${SUPPLE_COMPONENTS}" PARENT_SCOPE)
endfunction()

# Appends a target of this project to `targets` after those that it uses, and the libraries of others to `libraries`.
function(supple_collect target)
  get_target_property(used ${target} INTERFACE_LINK_LIBRARIES)
  foreach(item IN LISTS used)
    string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" item "${item}")
    if(item MATCHES "^supple_")
      supple_collect(${item})
    elseif(NOT item MATCHES "^\\$<BUILD_INTERFACE:|NOTFOUND$")
      list(APPEND libraries ${item})
    endif()
  endforeach()
  string(REGEX REPLACE "^supple_" "" target ${target})
  list(APPEND targets ${target})
  list(REMOVE_DUPLICATES targets)
  list(REMOVE_DUPLICATES libraries)
  set(targets "${targets}" PARENT_SCOPE)
  set(libraries "${libraries}" PARENT_SCOPE)
endfunction()
