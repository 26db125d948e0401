# Makes a page for man of what a subcommand's --help says: cmake -DHELP2MAN=... -DPROGRAM=... -DSUBCOMMAND=... -DVERSION=... -DOUT=... -P.
# help2man would call all pages after the program: the first line of the help says what each is for.
execute_process(COMMAND ${PROGRAM} ${SUBCOMMAND} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCH "^[^\n]*" purpose "${help}")
string(REGEX REPLACE "^[^ ]+: " "" purpose "${purpose}")
get_filename_component(page ${OUT} NAME_WE)
file(WRITE ${OUT}.name "[NAME]\n${page} \\- ${purpose}\n")
string(JOIN " " call ${PROGRAM} ${SUBCOMMAND})
execute_process(COMMAND ${HELP2MAN} --no-info --section 1 --include ${OUT}.name --version-string ${VERSION} --output ${OUT} ${call}
  COMMAND_ERROR_IS_FATAL ANY)
file(REMOVE ${OUT}.name)
