#include <doctest/doctest.h>

#include "core/error.hpp"

using namespace vitrum;

TEST_CASE("an error names file, line, column, what is wrong and the mend") {
  const Error error({"a.toml", 3, 7}, "no such key 'ligth'", "write 'light'");
  CHECK(std::string(error.what()) == "a.toml:3:7: no such key 'ligth'; write 'light'");
  CHECK(std::string(Error({"a.toml", 3, 0}, "x", "y").what()) == "a.toml:3: x; y");
  CHECK(std::string(Error({}, "x", "").what()) == "x");
}
