# Writes OUTPUT, if that changes it: the commit that SOURCE is a checkout of, with -dirty behind it
# where files differ; "" where it is none.
set(commit "")
find_program(git git)
if(git AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${git} -C ${SOURCE} rev-parse HEAD OUTPUT_VARIABLE commit
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND ${git} --no-optional-locks -C ${SOURCE} status --porcelain
    --untracked-files=no OUTPUT_VARIABLE changed ERROR_QUIET)
  if(commit AND NOT changed STREQUAL "")
    string(APPEND commit "-dirty")
  endif()
endif()
set(text "#define SOURCE_COMMIT \"${commit}\"\n")
set(before "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} before)
endif()
if(NOT text STREQUAL before)
  file(WRITE ${OUTPUT} "${text}")
endif()
