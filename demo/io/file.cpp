#include "demo/io/file.hpp"

#include <fstream>
#include <sstream>

namespace gnomon::demo {

Outcome<std::string> readText(const std::filesystem::path& file)
{
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    std::error_code ignored; // a folder opens like a file and reads as empty
    if (!std::filesystem::is_directory(file, ignored)) text << stream.rdbuf();
    if (!stream || std::filesystem::is_directory(file, ignored))
        return Outcome<std::string>::failure(file.string() + ": cannot be read");
    return text.str();
}

Status writeFile(const std::filesystem::path& file, std::string_view bytes)
{
    std::ofstream out(file, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close(); // what is still buffered may fail, too
    return out ? Status(Done{}) : Status::failure(file.string() + ": cannot be written");
}

} // namespace gnomon::demo
