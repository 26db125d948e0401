# Installs the build tree into a prefix of its own, builds consumer.cpp against it with find_package, and runs it.
# Variables: BUILD_DIR, SOURCE_DIR (of the project), VERSION, GENERATOR, COMPILER.

set(work ${BUILD_DIR}/install_test)
set(prefix ${work}/prefix)
file(REMOVE_RECURSE ${work})

function(run)
  cmake_parse_arguments(RUN "" "OUTPUT" "COMMAND" ${ARGN})
  execute_process(COMMAND ${RUN_COMMAND} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN RUN_COMMAND " " command)
    message(FATAL_ERROR "failed (${status}): ${command}\n${output}")
  endif()
  if(RUN_OUTPUT AND NOT output MATCHES "${RUN_OUTPUT}")
    message(FATAL_ERROR "expected output matching '${RUN_OUTPUT}', got:\n${output}")
  endif()
endfunction()

run(COMMAND ${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix})
# A prefix can be moved: nothing installed may remember where it was.
file(RENAME ${prefix} ${work}/moved)
run(COMMAND ${CMAKE_COMMAND} -S ${SOURCE_DIR}/tests/install -B ${work}/consumer -G ${GENERATOR}
  -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_PREFIX_PATH=${work}/moved)
run(COMMAND ${CMAKE_COMMAND} --build ${work}/consumer)
# At height 0 the triangle is one wide and moves eight: an eighth of the time, around the middle.
run(COMMAND ${work}/consumer/consumer OUTPUT "^triangle 0 from 0.4375 to 0.5625 at distance 2.00\n$")
# The program finds its library where it was moved to, and says what it was built with.
run(COMMAND ${work}/moved/bin/kairos --version OUTPUT "kairos ${VERSION}\nbuilt with .*, Release, embree 3\\.[0-9].*\nkernels on this machine: scalar")
# The same by pkg-config.
file(GLOB_RECURSE pc ${work}/moved/lib*/kairos.pc)
cmake_path(GET pc PARENT_PATH pc)
run(COMMAND sh -c "${COMPILER} -std=c++20 ${SOURCE_DIR}/tests/install/consumer.cpp -o ${work}/by_pc \
  $(PKG_CONFIG_PATH=${pc} pkg-config --cflags --libs kairos) -Wl,-rpath,$(PKG_CONFIG_PATH=${pc} pkg-config --variable=libdir kairos)")
run(COMMAND ${work}/by_pc OUTPUT "^triangle 0 from 0.4375 to 0.5625 at distance 2.00\n$")
# bash completes subcommands, options and values.
run(COMMAND bash -c "source ${work}/moved/share/bash-completion/completions/kairos
  complete -p kairos >/dev/null
  try() { COMP_WORDS=(\"$@\") COMP_CWORD=$(($# - 1)) && _kairos && echo \"\${COMPREPLY[*]}\"
  }
  try kairos re && try kairos render --tc && try kairos render --filter b"
  OUTPUT "^render\n--tc-rays\nbox blackman-harris\n$")
