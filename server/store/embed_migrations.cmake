# cmake -DOUT=migrations.cc -DFOLDER=schema/migrations -P embed_migrations.cmake
#
# Writes the numbered .sql files as the C++ source of Migrations().
file(GLOB files ${FOLDER}/*.sql)
list(SORT files)
set(entries "")
set(expected 1)
foreach(file IN LISTS files)
  get_filename_component(name ${file} NAME)
  if(NOT name MATCHES "^([0-9][0-9][0-9][0-9])_[a-z0-9_]+\\.sql$")
    message(FATAL_ERROR "${name}: a migration is named 0001_what_it_does.sql")
  endif()
  math(EXPR number "1${CMAKE_MATCH_1} - 10000")
  if(NOT number EQUAL expected)
    message(FATAL_ERROR "${name}: expected number ${expected}")
  endif()
  math(EXPR expected "${expected} + 1")
  file(READ ${file} sql)
  string(APPEND entries "      {${number}, R\"sql(${sql})sql\"},\n")
endforeach()
file(
  WRITE ${OUT}
  "#include \"server/store/migrator.h\"

namespace graspdb {

const std::vector<Migration>& Migrations() {
  static const std::vector<Migration> migrations{
${entries}  };
  return migrations;
}

}  // namespace graspdb
")
