# cmake -D CHECKOUT= -D WORK= -D OUT= -D STAMP= -D NODE= -D NPM= -D REQUIRED=ON|AUTO -P build_dashboard.cmake
# Copies what is needed into WORK, installs the packages there unless they are there already, makes the types, checks
# them, bundles into OUT. A wrong type fails the build. Packages that cannot be fetched do so only where REQUIRED is ON;
# else STAMP is not written, and the next build tries again.
set(dashboard ${WORK}/server/dashboard)

# Afresh, so that a file that was removed is gone; node_modules stays.
file(REMOVE_RECURSE ${dashboard}/src ${dashboard}/generated ${WORK}/api)
file(GLOB scripts ${CHECKOUT}/server/dashboard/*.mjs)
file(COPY ${scripts} ${CHECKOUT}/server/dashboard/package.json ${CHECKOUT}/server/dashboard/package-lock.json
          ${CHECKOUT}/server/dashboard/tsconfig.json ${CHECKOUT}/server/dashboard/.npmrc ${CHECKOUT}/server/dashboard/src
     DESTINATION ${dashboard})
file(COPY ${CHECKOUT}/api/openapi.yaml ${CHECKOUT}/api/schemas DESTINATION ${WORK}/api)
foreach(example garage cornell_box room)
  file(COPY ${CHECKOUT}/api/examples/${example} DESTINATION ${WORK}/api/examples)
endforeach()

# run(WHAT COMMAND...): sets failed and output.
macro(run what)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${dashboard} RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
endmacro()
macro(run_or_fail what)
  run("${what}" ${ARGN})
  if(failed)
    message(FATAL_ERROR "The dashboard: ${what}:\n${output}")
  endif()
endmacro()

# The packages that are there are those of this lock file?
file(SHA256 ${dashboard}/package-lock.json wanted)
set(installed "")
if(EXISTS ${dashboard}/installed.sha256)
  file(READ ${dashboard}/installed.sha256 installed)
endif()
if(NOT installed STREQUAL wanted)
  file(REMOVE ${dashboard}/installed.sha256)
  run("fetching packages" ${NPM} ci --prefer-offline --fetch-retries=1 --fetch-timeout=30000 --loglevel=error)
  if(failed)
    string(STRIP "${output}" output)
    set(trouble "npm could not fetch the dashboard's packages (is there a network?):\n${output}\n")
    if(REQUIRED STREQUAL "ON")
      message(FATAL_ERROR "${trouble}KEYLUME_DASHBOARD is ON, so the build stops here.")
    endif()
    message("${trouble}The service is built without its dashboard; the next build tries again.")
    return()
  endif()
  file(WRITE ${dashboard}/installed.sha256 ${wanted})
endif()

run_or_fail("types of api/openapi.yaml" ${NODE} make_types.mjs)
run_or_fail("types do not fit" ${NODE} node_modules/typescript/bin/tsc --noEmit -p .)
# Beside it and then renamed: a server that starts meanwhile finds the old one or the new one, whole.
run_or_fail("bundling" ${NODE} build.mjs ${OUT}.new)
file(REMOVE_RECURSE ${OUT})
file(RENAME ${OUT}.new ${OUT})
file(TOUCH ${STAMP})
