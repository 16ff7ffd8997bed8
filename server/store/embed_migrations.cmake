# cmake -DOUTPUT=migrations.cpp -DFILES=a.sql|b.sql -P embed_migrations.cmake
# The executable carries its migrations, so that it never meets a database with someone else's SQL.
string(REPLACE "|" ";" FILES "${FILES}")
set(entries "")
foreach(file IN LISTS FILES)
  get_filename_component(name "${file}" NAME)
  string(REGEX MATCH "^[0-9]+" digits "${name}")
  string(REGEX REPLACE "^0+" "" number "${digits}")
  file(READ "${file}" sql)
  string(APPEND entries "    {${number}, \"${name}\", R\"sql(${sql})sql\"},\n")
endforeach()
file(WRITE "${OUTPUT}"
"// Generated from server/store/migrations/*.sql.
#include \"server/store/migrate.h\"

namespace server {

std::span<const Migration> migrations() {
  static constexpr Migration kMigrations[]{
${entries}  };
  return kMigrations;
}

}  // namespace server
")
