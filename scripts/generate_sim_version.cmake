# Writes a header with the hash of the core's sources, the commit and the flags of this build.
#   cmake -DCORE=<sim-core> -DOUTPUT=<header> -DFLAGS=<compiler flags> -DARCHITECTURE=<name>
#         -P generate_sim_version.cmake
# Leaves the header untouched where nothing changed.
cmake_minimum_required(VERSION 3.25)

file(GLOB_RECURSE sources RELATIVE ${CORE}
  ${CORE}/src/*.h ${CORE}/src/*.cpp ${CORE}/include/*.h)
list(SORT sources)
set(digest "")
foreach(source IN LISTS sources)
  file(SHA256 ${CORE}/${source} content)
  string(APPEND digest "${source} ${content}\n")
endforeach()
string(SHA256 digest "${digest}")
string(SUBSTRING ${digest} 0 16 digest)

find_package(Git QUIET)
set(commit "unknown")
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${CORE} describe --always --dirty --abbrev=12
    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(commit ${described})
  endif()
endif()

string(REGEX REPLACE " +" " " FLAGS "${FLAGS}")
string(STRIP "${FLAGS}" FLAGS)
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT "#pragma once

// Written by scripts/generate_sim_version.cmake.
#define LOCKWIND_SOURCE_HASH 0x@digest@U
#define LOCKWIND_BUILD_COMMIT \"@commit@\"
#define LOCKWIND_BUILD_FLAGS \"@FLAGS@\"
#define LOCKWIND_BUILD_ARCHITECTURE \"@ARCHITECTURE@\"
")
