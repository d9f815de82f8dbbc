# Writes HEADER, which names the Git commit of SOURCE. An unchanged header keeps its time, so nothing is rebuilt. Sources
# outside of a checkout have no commit.
cmake_minimum_required(VERSION 3.25)
set(commit "")
find_program(GIT git)
if(GIT)
  execute_process(COMMAND ${GIT} -C "${SOURCE}" describe --always --dirty=+ --exclude=* --abbrev=7
    OUTPUT_VARIABLE commit ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
file(CONFIGURE OUTPUT "${HEADER}" CONTENT [[#define REBAKE_COMMIT "@commit@"
]] @ONLY)
