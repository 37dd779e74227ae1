# Which version this is, for the programs (SUPPLE_VERSION) and in three numbers for CMake and packages (SUPPLE_NUMBERS).
#
#   the commit has the tag v0.2.0                          0.2.0
#   seven commits after it                                 0.2.0+7.g1a2b3c4d5e6f
#   no tag yet: the contract's version, api/openapi.yaml   0.1.0-dev+g1a2b3c4d5e6f
#   no history, as in an unpacked archive                  0.1.0
#
# -DSUPPLE_VERSION=... says it where a build has no history, as that of the image. `cmake -P cmake/SuppleVersion.cmake` prints it.
get_filename_component(supple_root ${CMAKE_CURRENT_LIST_DIR} DIRECTORY)
file(STRINGS ${supple_root}/api/openapi.yaml contract REGEX "^  version: [0-9]+\\.[0-9]+\\.[0-9]+$" LIMIT_COUNT 1)
string(REGEX MATCH "[0-9.]+$" contract "${contract}")
if(NOT contract)
  message(FATAL_ERROR "api/openapi.yaml has no line '  version: MAJOR.MINOR.PATCH'.")
endif()

if(NOT SUPPLE_VERSION)
  set(SUPPLE_VERSION ${contract})
  find_package(Git QUIET)
  if(GIT_FOUND)
    execute_process(COMMAND ${GIT_EXECUTABLE} -C ${supple_root} describe --tags --always --abbrev=12 --match "v[0-9]*.[0-9]*.[0-9]*"
      OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
    if(status EQUAL 0 AND described MATCHES "^v([0-9]+\\.[0-9]+\\.[0-9]+)(-([0-9]+)-(g[0-9a-f]+))?$")
      set(SUPPLE_VERSION ${CMAKE_MATCH_1})
      if(CMAKE_MATCH_2)
        string(APPEND SUPPLE_VERSION "+${CMAKE_MATCH_3}.${CMAKE_MATCH_4}")
      endif()
    elseif(status EQUAL 0)
      string(APPEND SUPPLE_VERSION "-dev+g${described}")
    endif()
    # Configures again after a commit, so that the version keeps up.
    if(NOT CMAKE_SCRIPT_MODE_FILE AND EXISTS ${supple_root}/.git/logs/HEAD)
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${supple_root}/.git/logs/HEAD)
    endif()
  endif()
endif()
string(REGEX MATCH "^[0-9]+\\.[0-9]+\\.[0-9]+" SUPPLE_NUMBERS "${SUPPLE_VERSION}")
if(NOT SUPPLE_NUMBERS)
  message(FATAL_ERROR "SUPPLE_VERSION is '${SUPPLE_VERSION}'; it begins with three numbers, as 1.2.3 does.")
endif()
if(CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  execute_process(COMMAND ${CMAKE_COMMAND} -E echo ${SUPPLE_VERSION})
endif()
