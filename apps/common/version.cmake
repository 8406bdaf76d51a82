# Run at every build; writes OUTPUT only when it changes, so that nothing is recompiled without need.
execute_process(COMMAND git -C ${SOURCE} rev-parse --short=7 HEAD
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
set(SUREFOOT_VERSION "${VERSION}")
if(commit)
  string(APPEND SUREFOOT_VERSION "+${commit}")
endif()
set(SUREFOOT_BUILD "${BUILD}")
configure_file(${SOURCE}/apps/common/version.cc.in ${OUTPUT} @ONLY)
