# Writes the commit of ROOT into the source file OUT, with "+" behind it if files differ from it. Leaves the file alone
# when it says so already.
execute_process(COMMAND git -C ${ROOT} describe --always --abbrev=12 --exclude=* --dirty=+
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
set(text "#include \"core/version.hpp\"\n\nnamespace vitrum {\n\nconst char* commit() { return \"${commit}\"; }\n\n}  // namespace vitrum\n")
if(EXISTS ${OUT})
  file(READ ${OUT} before)
endif()
if(NOT "${before}" STREQUAL "${text}")
  file(WRITE ${OUT} "${text}")
endif()
