# Writes PEEL's manual pages, compressed, to OUTPUT/man1, and completion for three shells to OUTPUT.
file(REMOVE_RECURSE ${OUTPUT})
file(MAKE_DIRECTORY ${OUTPUT}/man1)
execute_process(COMMAND ${PEEL} --man --list OUTPUT_VARIABLE names COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]+" names "${names}")
foreach(name ${names})
  execute_process(COMMAND ${PEEL} --man ${name} OUTPUT_FILE ${OUTPUT}/man1/${name}.1
    COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND gzip -9n ${OUTPUT}/man1/${name}.1 COMMAND_ERROR_IS_FATAL ANY)
endforeach()
foreach(shell bash zsh fish)
  execute_process(COMMAND ${PEEL} --completion ${shell} OUTPUT_FILE ${OUTPUT}/peel.${shell}
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(TOUCH ${OUTPUT}/stamp)
