# Finds cpp-httplib's single header and defines the target `httplib`.
#
# Looked up in this order: KEYLUME_HTTPLIB_DIR (cache or environment), build/third_party/cpp-httplib (where
# server/get_httplib puts it), the system. The first header found that is new enough is taken; older ones are named
# in the message of refusal. Header only, one translation unit of ours, no OpenSSL, zlib or brotli: a distribution's
# shared library is built with other macros and would not fit.
set(HTTPLIB_MINIMUM 0.41)

set(Httplib_refused "")
set(Httplib_INCLUDE_DIR "")
foreach(folder IN ITEMS "${KEYLUME_HTTPLIB_DIR}" "$ENV{KEYLUME_HTTPLIB_DIR}"
                        "${CMAKE_SOURCE_DIR}/build/third_party/cpp-httplib" /usr/local/include /usr/include)
  if(folder STREQUAL "" OR NOT EXISTS "${folder}/httplib.h")
    continue()
  endif()
  file(STRINGS "${folder}/httplib.h" version_line REGEX "^#define CPPHTTPLIB_VERSION \"")
  string(REGEX MATCH "[0-9]+(\\.[0-9]+)*" Httplib_VERSION "${version_line}")
  if(Httplib_VERSION AND Httplib_VERSION VERSION_GREATER_EQUAL HTTPLIB_MINIMUM)
    set(Httplib_INCLUDE_DIR "${folder}")
    break()
  endif()
  string(APPEND Httplib_refused "  ${folder}/httplib.h is version '${Httplib_VERSION}': too old.\n")
endforeach()

if(Httplib_INCLUDE_DIR AND NOT TARGET httplib)
  add_library(httplib INTERFACE)
  # Always by -isystem, and before the system's own: an older httplib.h may lie in /usr/include.
  target_include_directories(httplib SYSTEM INTERFACE
    "$<$<NOT:$<STREQUAL:${Httplib_INCLUDE_DIR},/usr/include>>:${Httplib_INCLUDE_DIR}>")
  find_package(Threads REQUIRED)
  target_link_libraries(httplib INTERFACE Threads::Threads)
  message(STATUS "cpp-httplib ${Httplib_VERSION} in ${Httplib_INCLUDE_DIR}")
elseif(NOT Httplib_INCLUDE_DIR AND Httplib_FIND_REQUIRED)
  message(FATAL_ERROR
    "The service needs cpp-httplib ${HTTPLIB_MINIMUM} or newer.\n"
    "${Httplib_refused}"
    "Versions before accept bodies and headers without limit, so they are refused. What to do, one of:\n"
    "  * on Debian or Ubuntu: run server/get_httplib (takes the header from a newer suite's source package;\n"
    "    nothing on the system changes), then configure again; server/run and tests/run do this by themselves\n"
    "  * -DKEYLUME_HTTPLIB_DIR=FOLDER, a folder that holds a newer httplib.h\n"
    "  * -DKEYLUME_SERVER=OFF to build the engine and the worker alone\n")
endif()
set(Httplib_FOUND FALSE)
if(Httplib_INCLUDE_DIR)
  set(Httplib_FOUND TRUE)
endif()
