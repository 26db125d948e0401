# Compiler settings that every target of the project shares.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
include(CheckPIESupported)
check_pie_supported(LANGUAGES CXX)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
# The library shows what include/kairos/ marks with KAIROS_API, and nothing else.
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)

add_library(kairos_options INTERFACE)
target_compile_options(kairos_options INTERFACE
  -Wall -Wextra -Wpedantic -Werror -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wcast-qual
  # A fused multiply-add is not antisymmetric: two triangles that share an edge would no longer agree on the instant at
  # which one hands over to the other (docs/method.md, "Watertightness").
  -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # False positives of GCC 12 in optimised standard-library code.
  target_compile_options(kairos_options INTERFACE
    -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow -Wno-maybe-uninitialized
    # A class of a source file may hold what that file's anonymous namespace declares. GCC knows which file is a source only
    # as long as it isn't included by another.
    $<$<BOOL:${CMAKE_UNITY_BUILD}>:-Wno-subobject-linkage>)
endif()
# What files may do to the process, should a parser of ours or of others be wrong after all: no overwritten return address,
# no table of functions to write to, nothing to run on the stack. Sanitizers bring stricter means of their own.
target_link_options(kairos_options INTERFACE -Wl,-z,relro,-z,now,-z,noexecstack)
if(NOT KAIROS_SANITIZE)
  target_compile_options(kairos_options INTERFACE -fstack-protector-strong
    $<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE> $<$<NOT:$<CONFIG:Debug>>:-D_FORTIFY_SOURCE=2>)  # which needs optimisation
endif()
if(KAIROS_SANITIZE)
  # Of what debuggers read, reports of sanitizers need the lines alone, and a tenth of the time to compile goes into the rest.
  target_compile_options(kairos_options INTERFACE -fsanitize=${KAIROS_SANITIZE} -fno-omit-frame-pointer
    $<$<NOT:$<CONFIG:Debug>>:-g1>)
  target_link_options(kairos_options INTERFACE -fsanitize=${KAIROS_SANITIZE})
  if(KAIROS_SANITIZE MATCHES "undefined")
    target_compile_options(kairos_options INTERFACE -fno-sanitize-recover=all)
  endif()
endif()

if(KAIROS_TIDY)
  set(CMAKE_CXX_CLANG_TIDY clang-tidy --quiet)  # reads .clang-tidy
  if(CMAKE_UNITY_BUILD)  # the files that the code is in are included by others
    list(APPEND CMAKE_CXX_CLANG_TIDY --checks=-bugprone-suspicious-include
      "--header-filter=(include/kairos|/src|/apps|/fuzz)/.*\\.(h|cpp)$")
  endif()
endif()
