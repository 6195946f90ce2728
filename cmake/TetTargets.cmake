# How a target of ours is made: flags, sanitizers, ccache, and the three helpers every folder uses.
#   tet_library(name SOURCES ... DEPENDS ...)     a static library; DEPENDS are public
#   tet_executable(name SOURCES ... DEPENDS ...)  a program in build/<preset>/bin
#   tet_module(name DEPENDS ...)                  libtetstream-<name>.so there, which programs load
#   tet_on_demand(TARGET...)                      what only `everything` or its own name builds
#   tet_test(name SOURCES ... DEPENDS ... LABELS ...)  a GoogleTest binary, one ctest per TEST
#   tet_is_test(target)             what else is of tests alone: a library of theirs, a program
#   tet_mostly_wait(target...)      tests that wait more than they compute
#   tet_costs(TEST seconds ...)     tests of this folder that are to begin early
include(CheckCXXCompilerFlag)
include(GoogleTest)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
set(THREADS_PREFER_PTHREAD_FLAG ON)

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Every clone finds what another one has compiled: no path of the folder it lies in is hashed.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
    CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${CCACHE})
endif()

# All that compiles, the trials, campaigns and benches too, which are not built unless asked for.
add_custom_target(everything)

add_library(tet_flags INTERFACE)
# Shards must agree on every bit: a fused multiply-add in one of them would be another number.
target_compile_options(tet_flags INTERFACE -ffp-contract=off)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  # GCC 12 loads a spilled integer by way of an MMX register, and leaves the floating point unit in
  # a state in which the thread's next long double is NaN.
  target_compile_options(tet_flags INTERFACE -march=${TET_MARCH} -mno-mmx)
else()
  target_compile_options(tet_flags INTERFACE -Wno-psabi)  # says what compilers before GCC 10 did
endif()
target_compile_options(tet_flags INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wnon-virtual-dtor -Wold-style-cast)
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  # Tables are grown when they are compiled; clang gives up after a million steps.
  target_compile_options(tet_flags INTERFACE -fconstexpr-steps=33554432)
  # Of C++ GCC's -Wconversion lets pass what changes the sign alone, and so it is in tests.
  target_compile_options(tet_flags INTERFACE
    "$<$<BOOL:$<TARGET_PROPERTY:TET_IS_TEST>>:-Wno-sign-conversion>")
endif()
if(TET_WERROR)
  target_compile_options(tet_flags INTERFACE -Werror)
endif()
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # To the compiler what is private to a source belongs to a header then.
  target_compile_options(tet_flags INTERFACE -Wno-subobject-linkage)
endif()
if(TET_CHECKS)
  target_compile_definitions(tet_flags INTERFACE TET_CHECKS=1)
endif()
if(TET_SANITIZE)
  list(JOIN TET_SANITIZE "," sanitizers)
  target_compile_options(tet_flags INTERFACE
    -fsanitize=${sanitizers} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(tet_flags INTERFACE -fsanitize=${sanitizers})
  if("undefined" IN_LIST TET_SANITIZE)
    # A look at every pointer before it is used: AddressSanitizer sees what comes of most that is wrong
    # with one. They stay where bytes of strangers are read, which is what libFuzzer is told of.
    set(TET_POINTER_CHECKS null,alignment,object-size,vptr)
    target_compile_options(tet_flags INTERFACE -fno-sanitize=${TET_POINTER_CHECKS})
  endif()
  if("thread" IN_LIST TET_SANITIZE)
    # Debian's oneTBB is not built for TSan, which then sees races in correct programs.
    target_compile_definitions(tet_flags INTERFACE TET_STD_THREADS=1)
  endif()
endif()

function(tet_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC ${ARG_DEPENDS} PRIVATE tet_flags ${ARG_PRIVATE_DEPENDS})
  add_dependencies(everything ${name})
endfunction()

# NAME_module.cpp, which shows what NAME_module.map says. Installed beside the decoder.
function(tet_module name)
  cmake_parse_arguments(ARG "" "" "DEPENDS" ${ARGN})
  set(target tetstream_${name})
  set(map ${CMAKE_CURRENT_SOURCE_DIR}/${name}_module.map)
  add_library(${target} MODULE ${name}_module.cpp)
  target_link_libraries(${target} PRIVATE tet_flags ${ARG_DEPENDS})
  target_link_options(${target} PRIVATE
    -Wl,--version-script=${map} -Wl,--exclude-libs,ALL -Wl,--no-undefined)
  set_target_properties(${target} PROPERTIES OUTPUT_NAME tetstream-${name}
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} LINK_DEPENDS ${map})
  install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/tetstream
    COMPONENT common)
endfunction()

function(tet_executable name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE tet_flags ${ARG_DEPENDS})
  add_dependencies(everything ${name})
endfunction()

# Has gRPC, protobuf and Abseil in the program: for one that starts often and ends soon. The others share
# Debian's libraries, as does what is linked with a sanitizer.
function(tet_link_archives target)
  if(TET_ARCHIVES AND NOT TET_SANITIZE)
    set(linker ${PROJECT_SOURCE_DIR}/cmake/link_archives)
    set_target_properties(${target} PROPERTIES RULE_LAUNCH_LINK ${linker} LINK_DEPENDS ${linker})
  endif()
endfunction()

# For what no test runs: trials, campaigns, searches, and libraries that only these use.
function(tet_on_demand)
  set_target_properties(${ARGN} PROPERTIES EXCLUDE_FROM_ALL ON)
endfunction()

# OpenVDB's templates take minutes under sanitizers. What only makes files for tests, or is for the
# command line alone, goes without; our own libraries, which those tests call, do not.
add_library(tet_not_sanitized INTERFACE)
if(TET_SANITIZE)
  set(TET_NOT_SANITIZED -fno-sanitize=all)
  target_compile_options(tet_not_sanitized INTERFACE ${TET_NOT_SANITIZED})
endif()

# What reads bytes of strangers tells libFuzzer which branches it takes and what it compares, and has
# each of its pointers looked at. The mesher has neither, and takes less than half as long.
add_library(tet_fuzzed INTERFACE)
if(TET_FUZZ)
  set(TET_FUZZED -fsanitize=fuzzer-no-link)
  if(TET_POINTER_CHECKS)
    list(APPEND TET_FUZZED -fsanitize=${TET_POINTER_CHECKS})
  endif()
  target_compile_options(tet_fuzzed INTERFACE ${TET_FUZZED})
endif()

# Reading a command line takes no time; optimising what does so takes minutes, and so do sanitizers.
function(tet_reads_command_lines)
  foreach(target IN LISTS ARGN)
    target_compile_options(${target} PRIVATE -O1)
    target_link_libraries(${target} PRIVATE tet_not_sanitized)
  endforeach()
endfunction()

# All that the tests take which have the label `fast` or `thorough` and not `command`: a sanitizer's
# build is short of time, and the command line's sources take the most of it and handle no stranger's
# bytes.
add_custom_target(sanitized_tests)

# Tests spend their time in our libraries; optimising the tests themselves costs minutes.
function(tet_is_test target)
  target_compile_options(${target} PRIVATE -O1)
  set_target_properties(${target} PROPERTIES TET_IS_TEST ON)
endfunction()

# These tests wait for a service more than they compute. Where accesses are looked at, optimising them
# takes as long again as compiling them, and saves nothing.
function(tet_mostly_wait)
  if(TET_SANITIZE)
    foreach(target IN LISTS ARGN)
      target_compile_options(${target} PRIVATE -O0)
    endforeach()
  endif()
endfunction()

# ONE_PROCESS runs all tests of a program as one ctest: for programs that take longer to start than
# most of their tests take. Without it each test is a ctest of its own, and those that are listed as
# THOROUGH have that label instead of `fast` or `slow`: not among the first to run, and yet
# sanitized. SUITES are test suites of the program that are one ctest each. COST is what the
# longest test takes, in seconds.
function(tet_test name)
  cmake_parse_arguments(ARG "ONE_PROCESS" "TIMEOUT;COST"
    "SOURCES;DEPENDS;LABELS;THOROUGH;SUITES" ${ARGN})
  if(NOT ARG_COST)
    set(ARG_COST 0)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 1800)
  endif()
  if(TET_SANITIZE)
    math(EXPR ARG_TIMEOUT "3 * ${ARG_TIMEOUT}")
  endif()
  tet_executable(${name} SOURCES ${ARG_SOURCES} DEPENDS ${ARG_DEPENDS} GTest::gmock_main)
  tet_is_test(${name})
  if(ARG_ONE_PROCESS)
    add_test(NAME ${name} COMMAND ${name} --gtest_brief=1)
    set_tests_properties(${name} PROPERTIES
      LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT} COST ${ARG_COST})
  else()
    foreach(suite IN LISTS ARG_SUITES)
      add_test(NAME ${suite} COMMAND ${name} --gtest_brief=1 --gtest_filter=${suite}.*)
      set_tests_properties(${suite} PROPERTIES
        LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT} COST ${ARG_COST})
    endforeach()
    tet_discover_tests(${name} "TIMEOUT;${ARG_TIMEOUT};COST;${ARG_COST}" "${ARG_LABELS}"
      "${ARG_THOROUGH}" "${ARG_SUITES}")
  endif()
  if((ARG_LABELS MATCHES "fast|thorough" OR ARG_THOROUGH) AND NOT "command" IN_LIST ARG_LABELS)
    add_dependencies(sanitized_tests ${name})
  endif()
endfunction()

# In CMake 3.25 gtest_discover_tests keeps only the first of several labels, so they are set by an
# include file that ctest reads after the discovery.
function(tet_discover_tests name properties labels thorough suites)
  list(TRANSFORM suites APPEND ".*")
  list(JOIN suites ":" suites)
  gtest_discover_tests(${name} TEST_LIST ${name}_tests DISCOVERY_TIMEOUT 600 NO_PRETTY_VALUES
    TEST_FILTER "*-${suites}"
    PROPERTIES ${properties})
  list(TRANSFORM labels REPLACE "^(fast|slow)$" thorough OUTPUT_VARIABLE thorough_labels)
  set(labels_file ${CMAKE_CURRENT_BINARY_DIR}/${name}_labels.cmake)
  # ctest adds to the labels that a test has, so each test is met once.
  file(WRITE ${labels_file}
    "foreach(test IN ITEMS ${thorough})\n"
    "  set_tests_properties(\"\${test}\" PROPERTIES LABELS \"${thorough_labels}\")\n"
    "endforeach()\n"
    "list(REMOVE_ITEM ${name}_tests \"\" ${thorough})\n"
    "foreach(test IN LISTS ${name}_tests)\n"
    "  set_tests_properties(\"\${test}\" PROPERTIES LABELS \"${labels}\")\n"
    "endforeach()\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${labels_file})
endfunction()

# ctest begins with what it has seen to take long; on a machine that has run no test yet, with these.
# Otherwise the longest might begin when all others have ended.
function(tet_costs)
  while(ARGN)
    list(POP_FRONT ARGN test seconds)
    set_tests_properties(${test} PROPERTIES COST ${seconds})
  endwhile()
endfunction()
