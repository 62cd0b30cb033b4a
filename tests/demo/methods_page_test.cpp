// docs/methods.md against the command that wrote it.
#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "cli_fixture.hpp"

namespace gnomon::demo {

TEST_CASE("docs/methods.md is what `gnomon methods --markdown` prints")
{
    const Ran ran = gnomonProgram("methods --markdown");
    REQUIRE(ran.exitCode == 0);
    const std::vector<std::string> page = lines(GNOMON_METHODS_PAGE);
    REQUIRE_FALSE(page.empty());
    std::istringstream output(ran.output);
    std::vector<std::string> printed;
    for (std::string line; std::getline(output, line);) {
        CHECK_MESSAGE(std::find(page.begin(), page.end(), line) != page.end(), "not in docs/methods.md: ", line);
        printed.push_back(line);
    }
#if GNOMON_HAS_ALL_METHODS
    CHECK_MESSAGE(printed == page, "bring it up to date: gnomon methods --markdown > docs/methods.md");
#endif
}

} // namespace gnomon::demo
