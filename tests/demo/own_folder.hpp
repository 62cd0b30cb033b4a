#pragma once
// A folder for what a test writes, each time another one: runs of a test at the same time do not meet.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <doctest/doctest.h>

namespace gnomon::demo {

namespace fs = std::filesystem;

struct Folder {
    explicit Folder(const std::string& name)
    {
        std::string made = (fs::temp_directory_path() / ("gnomon_" + name + "_XXXXXX")).string();
        REQUIRE(mkdtemp(made.data()) != nullptr);
        path = made;
    }
    /// With GNOMON_KEEP_FILES in the environment it stays, and says where it is.
    ~Folder()
    {
        std::error_code ignored; // nothing of the test
        if (std::getenv("GNOMON_KEEP_FILES"))
            std::printf("kept: %s\n", path.c_str());
        else
            fs::remove_all(path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    fs::path path;
};

} // namespace gnomon::demo
